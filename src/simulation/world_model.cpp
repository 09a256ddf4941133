#include "frictional_contact_sim/simulation/world_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "body_loading.h"
#include "elastic_overlap.h"
#include "loops.h"
#include "start_check.h"

namespace frictional_contact_sim
{
namespace
{
/** A material that is given to the link itself says its friction too; else the URDF's goes before the body's. */
SurfaceSide bodySide(const WorldModel& world, const ShapeInfo& shape)
{
  const BodySpec& spec = world.scenario.bodies[shape.body];
  const auto own = spec.link_materials.find(shape.link_name);
  if (own != spec.link_materials.end())
    return {own->second, -1.0, spec.name, shape.link_name};
  return {spec.material, world.bodies[shape.body].tree.shapes[shape.index].friction, spec.name, shape.link_name};
}

std::vector<SurfaceSide> surfaceSides(const WorldModel& world)
{
  std::vector<SurfaceSide> sides;
  for (int handle = 0; handle < world.collision.shapeCount(); ++handle)
  {
    const ShapeInfo& shape = world.collision.shape(handle);
    if (shape.body < 0)
      sides.push_back({"ground", world.scenario.ground->friction.value_or(-1.0)});
    else
      sides.push_back(bodySide(world, shape));
  }
  return sides;
}

void setPairs(WorldModel& world)
{
  world.sides = surfaceSides(world);
  world.pairs = PairTable(world.scenario.materials, world.sides);
}

void checkScenario(const Scenario& scenario)
{
  if (!(scenario.time_step > 0.0) || !std::isfinite(scenario.time_step))
    throw std::invalid_argument("time_step is " + std::to_string(scenario.time_step) +
                                ", expected a positive finite number of seconds");
  if (!scenario.gravity.allFinite())
    throw std::invalid_argument("gravity has a component that is not finite");
  scenario.stopping.validate();
}

/** What steps from rest to rest, and one equilibrium, can be asked of. */
void checkRegime(const WorldModel& world)
{
  if (world.scenario.regime == Regime::DYNAMIC)
    return;
  const bool is_static = world.scenario.regime == Regime::STATIC;
  const bool has_solid = std::any_of(world.bodies.begin(), world.bodies.end(),
                                     [](const BodyModel& body) { return body.solid != nullptr; });
  for (size_t b = 0; b < world.bodies.size(); ++b)
  {
    const BodyModel& body = world.bodies[b];
    if (!world.start[b].v.isZero(0.0))
      throw std::invalid_argument("body '" + body.name +
                                  "' has a velocity at the start, expected none in a scenario that is " +
                                  (is_static ? "static" : "quasi_static") + ": nothing has inertia there");
    std::string reason;
    if (is_static && body.solid)
      reason = body.solid->staticsRefusal();
    else if (is_static && has_solid && body.nv > 0)
      reason = "moves freely beside an elastic body, expected bodies with supports alone";
    if (!reason.empty())
      throw std::invalid_argument("body '" + body.name + "' " + reason +
                                  " in a scenario that is static: quasi_static: true takes it");
  }
}

void addDraft(const BodySpec& spec, WorldModel& world)
{
  world.bodies.push_back(loadBody(spec, world.warnings));
  world.bodies.back().setRegime(world.scenario.regime);
  world.start.emplace_back(world.bodies.back());
  setInitialState(spec, {world.bodies.back(), world.start.back()}, world.warnings);
}

/** @param body of the pairs that are looked at; -1: all */
void disableOverlaps(WorldModel& world, int body = -1)
{
  for (const std::string& pair : world.collision.disableOverlaps(body))
    world.warnings.push_back("links overlap at the start and will not collide: " + pair);
}

/** @throws std::invalid_argument where contacts do not reach */
void warnOfElasticOverlaps(WorldModel& world)
{
  for (const ElasticOverlap& overlap : findElasticOverlaps(world, world.start))
  {
    if (!overlap.is_let_out)
      throw std::invalid_argument(overlap.line + ", expected less than a cell: contacts know nothing deeper");
    world.warnings.push_back(overlap.line + ": it is let out slowly");
  }
}

void judgeInertia(WorldModel& world, size_t body)
{
  for (const std::string& line : findImplausibleInertia(world, static_cast<int>(body)))
    world.warnings.push_back("body '" + world.bodies[body].name + "': " + line);
}

/** The same world under another scenario, nothing loaded anew. */
std::shared_ptr<WorldModel> copyWorld(const WorldModel& world, const Scenario& scenario)
{
  auto copy = std::make_shared<WorldModel>(world);
  copy->scenario = scenario;
  copy->warnings.clear();
  return copy;
}
}  // namespace

std::shared_ptr<const WorldModel> loadWorldModel(const Scenario& scenario)
{
  checkScenario(scenario);
  const auto begin = std::chrono::steady_clock::now();
  auto world = std::make_shared<WorldModel>();
  world->scenario = scenario;
  world->collision.setBroadPhase(scenario.broad_phase);
  for (const BodySpec& spec : scenario.bodies)
    addDraft(spec, *world);
  for (const BodyModel& body : world->bodies)
    addLoopsOfBody(static_cast<int>(&body - world->bodies.data()), *world);
  addLoopsOfScenario(*world);
  closeLoops(*world);
  for (size_t b = 0; b < world->bodies.size(); ++b)
    placeBody(scenario.bodies[b], {world->bodies[b], world->start[b]}, *world);
  for (const Closure& loop : world->loops)
    separate(loop, *world);
  checkLoops(*world);
  if (scenario.ground)
  {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().z() = scenario.ground->height;
    world->collision.addStatic(HalfSpace{}, pose, "ground");
  }
  disableOverlaps(*world);
  for (size_t b = 0; b < world->bodies.size(); ++b)
    judgeInertia(*world, b);
  warnOfElasticOverlaps(*world);
  for (const std::string& line : findOverlaps(*world, world->collision))
    world->warnings.push_back(line + ": it is let out slowly");
  checkRegime(*world);
  setPairs(*world);
  world->loading_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return world;
}

std::shared_ptr<const WorldModel> withBody(const WorldModel& world, const Scenario& scenario, const BodySpec& spec)
{
  const auto begin = std::chrono::steady_clock::now();
  const std::shared_ptr<WorldModel> next = copyWorld(world, scenario);
  next->scenario.bodies.push_back(spec);
  addDraft(spec, *next);
  const size_t body = next->bodies.size() - 1;
  const size_t old_loops = next->loops.size();
  addLoopsOfBody(static_cast<int>(body), *next);
  closeLoops(*next, old_loops);
  placeBody(spec, {next->bodies[body], next->start[body]}, *next);
  for (size_t i = old_loops; i < next->loops.size(); ++i)
    separate(next->loops[i], *next);
  next->collision.putStaticLast();
  disableOverlaps(*next, static_cast<int>(body));
  judgeInertia(*next, body);
  checkRegime(*next);
  setPairs(*next);
  next->loading_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return next;
}

std::shared_ptr<const WorldModel> withoutBody(const WorldModel& world, const Scenario& scenario, int body)
{
  const std::shared_ptr<WorldModel> next = copyWorld(world, scenario);
  next->scenario.bodies.erase(next->scenario.bodies.begin() + body);
  next->bodies.erase(next->bodies.begin() + body);
  next->start.erase(next->start.begin() + body);
  next->collision.removeBody(body);
  removeLoopsOfBody(body, *next);
  setPairs(*next);
  return next;
}

}  // namespace frictional_contact_sim
