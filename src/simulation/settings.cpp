// What may be set while a simulation runs, from the next step on: checked as a whole, then taken. Settings are no part
// of the state: a reset keeps them, a loaded state goes on under them.
#include <algorithm>
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

void Simulator::Impl::setMaterials(const MaterialTable& materials)
{
  PairTable table(materials, world->sides);
  if (!table.keepsCreepCurves())
    throw std::invalid_argument("friction: a pair has the creep law, expected the friction of its curve");
  scenario.materials = materials;
  pairs = std::move(table);
}

void Simulator::setGravity(const Eigen::Vector3d& gravity)
{
  for (const char axis : {'x', 'y', 'z'})
    require(anyNumber(), std::string("gravity ") + axis, gravity[axis - 'x']);
  const double potential = impl_->state.energy.potential;
  impl_->scenario.gravity = gravity;
  impl_->context = makeContext(impl_->scenario);
  impl_->bookEnergies();
  impl_->moveLedgerZero(potential);
}

void Simulator::setStopping(const StoppingOptions& stopping)
{
  impl_->solver.setStopping(stopping);
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
}

}  // namespace frictional_contact_sim
