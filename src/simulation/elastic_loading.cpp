#include "elastic_loading.h"

#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/deformable/elastic_spec.h"
#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double DROP_HEIGHT = 0.001;  ///< lowest node above the ground where no pose is given [m]

[[noreturn]] void fail(const BodySpec& spec, const std::string& message)
{
  throw std::invalid_argument("body '" + spec.name + "': " + message);
}

void setWrenches(const BodySpec& spec, const Draft& body)
{
  for (ExternalWrench wrench : spec.wrenches)
  {
    if (wrench.link != spec.name)
      fail(spec, "wrenches names the link '" + wrench.link + "', expected the body's own name");
    if (const std::string reason = wrenchRefusal(body.model, wrench); !reason.empty())
      fail(spec, "wrenches: " + reason);
    wrench.frame = 0;
    body.state.wrenches.push_back(wrench);
  }
}

/** A clamped rod: its shape at the start, and how its root is moved. */
void setRodState(const BodySpec& spec, const Draft& body)
{
  body.state.q = static_cast<const SuperHelix&>(*body.model.solid).startPosition();
  if (!spec.motion)
    return;
  if (!spec.motion->turns.empty() || !spec.motion->velocity.angular.isZero())
    fail(spec, "motion of a rod is a translation: its root does not turn");
  startMotion(*spec.motion, body);
}
}  // namespace

BodyModel loadElastic(const BodySpec& spec)
{
  if (const std::optional<RodSpec>& rod = spec.elastic->rod)
    return BodyModel(sectionTree(spec.name, *rod), std::make_shared<SuperHelix>(*rod));
  try
  {
    const std::shared_ptr<const ElasticSolid> solid = buildElastic(spec.name, *spec.elastic);
    return BodyModel(nodeTree(spec.name, solid->parts().nodes, solid->parts().surface), solid);
  }
  catch (const ModelError& error)
  {
    throw ModelError((spec.source.empty() ? "" : spec.source + ": ") + "elastic body '" + spec.name +
                     "': " + error.what());
  }
}

void setElasticState(const BodySpec& spec, const Draft& body)
{
  body.state.base_pose = spec.pose.value_or(Eigen::Isometry3d::Identity());
  setWrenches(spec, body);
  if (spec.elastic->rod)
  {
    setRodState(spec, body);
    return;
  }
  const ElasticSolid& solid = static_cast<const ElasticSolid&>(*body.model.solid);
  const Eigen::Matrix3d back = body.state.base_pose.linear().transpose();
  const bool is_moving = !spec.linear_velocity.isZero() || !spec.angular_velocity.isZero();
  if (is_moving && solid.isSupported())
    fail(spec, "velocity is for a body without supports; one with 'fixed' nodes takes 'motion'");
  body.state.v = solid.rigidVelocity(back * spec.linear_velocity, back * spec.angular_velocity);
  if (!spec.motion)
    return;
  if (!solid.isSupported())
    fail(spec, "motion is that of supports, but no node is 'fixed'");
  if (spec.motion->isProgram() || !spec.motion->velocity.angular.isZero())
    fail(spec, "motion of an elastic body is a constant linear velocity: its frame neither turns nor accelerates");
  startMotion(*spec.motion, body);
}

void placeElastic(const BodySpec& spec, const Draft& body, WorldModel& world)
{
  const int handle = world.collision.addBody(body.model.tree);
  world.collision.disableSelfCollision(handle);
  Body moved(body.model, body.state);
  updateEnd(moved);
  world.collision.setPoses(handle, moved.end);
  const double lowest = world.collision.lowestPoint(handle);
  const double ground = world.scenario.ground ? world.scenario.ground->height : 0.0;
  if (!spec.pose && !body.model.solid->isSupported() && std::isfinite(lowest))
  {
    body.state.base_pose.translation().z() += ground + DROP_HEIGHT - lowest;
    updateEnd(moved);
    world.collision.setPoses(handle, moved.end);
  }
  else if (world.scenario.ground && lowest < ground - 1e-9)
    fail(spec, "is " + std::to_string(ground - lowest) + " m below the ground at the start, expected no overlap");
}

}  // namespace frictional_contact_sim
