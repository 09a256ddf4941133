// What may be set while a simulation runs, from the next step on: checked as a whole, then taken. Settings are no part
// of the state: a reset keeps them; a state file has them beside the state.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/solver/registry.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
void require(const NumberRange& range, const std::string& field, double value)
{
  if (!range.holds(value))
    throw std::invalid_argument(field + ": found " + numberText(value) + ", expected " + range.expected());
}

bool isUsed(const SurfaceGroup& group, const std::vector<SurfaceSide>& sides)
{
  return std::any_of(
      sides.begin(), sides.end(), [&group](const SurfaceSide& side) { return group.holds(side); });
}

std::vector<std::string> surfaceNames(const WorldModel& world, const MaterialTable& materials)
{
  std::vector<std::string> names;
  for (const auto& [name, material] : materials.materials)
    names.push_back(name);
  for (const SurfaceSide& side : world.sides)
  {
    names.push_back(side.material);
    names.push_back(side.body);
    names.push_back(side.body + "/" + side.link);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/** A body goes before a material of the same name, the ground before both. */
SurfaceGroup findSurfaces(const std::string& field, const std::string& name, const WorldModel& world,
                          const MaterialTable& materials)
{
  const auto is_body = [&](const std::string& body)
  {
    return std::any_of(world.bodies.begin(), world.bodies.end(),
                       [&body](const BodyModel& model) { return model.name == body; });
  };
  SurfaceGroup group;
  const size_t slash = name.find('/');
  if (name != "ground" && is_body(name))
    group.body = name;
  else if (slash != std::string::npos && is_body(name.substr(0, slash)))
    group = {"", name.substr(0, slash), name.substr(slash + 1)};
  else if (!name.empty())
    group.material = name;
  const bool known =
      !name.empty() && name.back() != '/' && (isUsed(group, world.sides) || materials.materials.count(name) > 0);
  if (!known)
    throw std::invalid_argument(field + ": found '" + inOneLine(name) + "', " +
                                didYouMean(name, surfaceNames(world, materials)) +
                                "expected a material, a body, body/link of a link that collides, or ground");
  return group;
}
}  // namespace

void Simulator::Impl::moveLedgerZero(double potential)
{
  if (state.energy.potential != potential)
    state.energy_start += state.energy.potential - potential;
}

PairTable Simulator::Impl::pairsOf(const MaterialTable& materials) const
{
  PairTable table(materials, world->sides);
  if (!table.keepsCreepCurves())
    throw std::invalid_argument("friction: a pair has the creep law, expected the friction of its curve");
  return table;
}

void Simulator::Impl::setMaterials(const MaterialTable& materials)
{
  PairTable table = pairsOf(materials);
  scenario.materials = materials;
  pairs = std::move(table);
}

void Simulator::setTimeStep(double dt)
{
  if (!(dt > 0.0) || !std::isfinite(dt))
    throw std::invalid_argument("time_step is " + std::to_string(dt) +
                                ", expected a positive finite number of seconds");
  SimulationState& state = impl_->state;
  for (StepClock* clock : {&state.clock, &state.scenario_clock})
    clock->restart(clock->time(state.dt));
  state.dt = dt;
  impl_->changed.time_step = dt;
  impl_->scenario.time_step = dt;
  impl_->context = makeContext(impl_->scenario);
}

void Simulator::setGravity(const Eigen::Vector3d& gravity)
{
  for (const char axis : {'x', 'y', 'z'})
    require(anyNumber(), std::string("gravity ") + axis, gravity[axis - 'x']);
  const double potential = impl_->state.energy.potential;
  impl_->changed.gravity = gravity;
  impl_->scenario.gravity = gravity;
  impl_->context = makeContext(impl_->scenario);
  impl_->bookEnergies();
  impl_->moveLedgerZero(potential);
}

void Simulator::setStopping(const StoppingOptions& stopping)
{
  impl_->solver.setStopping(stopping);
  impl_->changed.tolerance = stopping.tolerance;
  impl_->changed.max_iterations = stopping.max_iterations;
  impl_->scenario.stopping = stopping;
  impl_->context = makeContext(impl_->scenario);
}

void Simulator::setFriction(const std::string& a, const std::string& b, double friction,
                            std::optional<double> restitution)
{
  require(notNegative(), "friction", friction);
  if (restitution)
    require(between(0.0, 1.0), "restitution", *restitution);
  MaterialTable materials = impl_->scenario.materials;
  const PairRule rule{findSurfaces("a", a, *impl_->world, materials), findSurfaces("b", b, *impl_->world, materials),
                      friction, restitution};
  std::vector<PairRule>& rules = materials.rules;
  const auto same_pair = [&rule](const PairRule& other)
  { return (rule.a == other.a && rule.b == other.b) || (rule.a == other.b && rule.b == other.a); };
  const auto old = std::find_if(rules.begin(), rules.end(), same_pair);
  PairRule merged = rule;
  if (old != rules.end())
  {
    if (!restitution)
      merged.restitution = old->restitution;
    rules.erase(old);
  }
  rules.push_back(merged);
  impl_->setMaterials(materials);
}

void Simulator::setDefaultFriction(double friction)
{
  require(notNegative(), "default_friction", friction);
  MaterialTable materials = impl_->scenario.materials;
  materials.fallback.friction = friction;
  impl_->setMaterials(materials);
  impl_->changed.default_friction = friction;
}

void Simulator::setSolver(const std::string& name)
{
  setSolver(createSolver(name));
  impl_->changed.solver = name;
}

void Simulator::setSolver(std::unique_ptr<Solver> solver)
{
  impl_->changed.solver.reset();
  impl_->scenario.solver = solver->name();
  impl_->scenario.solver_options.clear();  // those it has are its own affair
  impl_->solver.setMethod(std::move(solver));
}

RunSettings Simulator::settings() const
{
  RunSettings settings = impl_->changed;
  settings.friction = impl_->scenario.materials.rules;
  return settings;
}

/** Refuses before it takes anything. */
void Simulator::Impl::checkSettings(const RunSettings& settings) const
{
  if (settings.time_step)
    require(timeStepRange(), "time_step", *settings.time_step);
  if (settings.gravity)
    for (const double component : *settings.gravity)
      require(anyNumber(), "gravity", component);
  if (settings.solver)
    findSolver(*settings.solver);
  changedStopping(settings).validate();
  if (settings.default_friction)
    require(notNegative(), "default_friction", *settings.default_friction);
  for (const PairRule& rule : settings.friction)
  {
    require(notNegative(), "friction", rule.friction);
    if (rule.restitution)
      require(between(0.0, 1.0), "restitution", *rule.restitution);
  }
  if (settings.default_friction || !settings.friction.empty())
    pairsOf(changedMaterials(settings));
}

StoppingOptions Simulator::Impl::changedStopping(const RunSettings& settings) const
{
  StoppingOptions stopping = scenario.stopping;
  stopping.tolerance = settings.tolerance.value_or(stopping.tolerance);
  stopping.max_iterations = settings.max_iterations.value_or(stopping.max_iterations);
  return stopping;
}

MaterialTable Simulator::Impl::changedMaterials(const RunSettings& settings) const
{
  MaterialTable materials = scenario.materials;
  materials.fallback.friction = settings.default_friction.value_or(materials.fallback.friction);
  if (!settings.friction.empty())
    materials.rules = settings.friction;
  return materials;
}

void Simulator::takeSettings(const RunSettings& settings)
{
  if (settings.time_step)
    setTimeStep(*settings.time_step);
  if (settings.gravity)
    setGravity(*settings.gravity);
  if (settings.solver)
    setSolver(*settings.solver);
  if (settings.tolerance || settings.max_iterations)
    setStopping(impl_->changedStopping(settings));
  if (settings.default_friction || !settings.friction.empty())
    impl_->setMaterials(impl_->changedMaterials(settings));
  if (settings.default_friction)
    impl_->changed.default_friction = settings.default_friction;
}

}  // namespace frictional_contact_sim
