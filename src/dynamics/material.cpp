#include "frictional_contact_sim/dynamics/material.h"

#include <algorithm>

namespace frictional_contact_sim
{
const Material& MaterialTable::find(const std::string& name) const
{
  const auto entry = materials.find(name);
  return entry == materials.end() ? fallback : entry->second;
}

bool SurfaceGroup::holds(const SurfaceSide& side) const
{
  return (material.empty() || material == side.material) && (body.empty() || body == side.body) &&
         (link.empty() || link == side.link);
}

bool PairRule::holds(const SurfaceSide& side_a, const SurfaceSide& side_b) const
{
  return (a.holds(side_a) && b.holds(side_b)) || (a.holds(side_b) && b.holds(side_a));
}

namespace
{
Material givenMaterial(const MaterialTable& table, const SurfaceSide& a, const SurfaceSide& b)
{
  const auto entry = table.pairs.find(std::minmax(a.material, b.material));
  if (entry != table.pairs.end())
    return entry->second;
  const Material& material_a = table.find(a.material);
  const Material& material_b = table.find(b.material);
  return {std::min(a.friction < 0.0 ? material_a.friction : a.friction,
                   b.friction < 0.0 ? material_b.friction : b.friction),
          std::min(material_a.restitution, material_b.restitution), nullptr,
          std::min(material_a.tangential_restitution, material_b.tangential_restitution)};
}
}  // namespace

Material pairMaterial(const MaterialTable& table, const SurfaceSide& a, const SurfaceSide& b)
{
  Material material = givenMaterial(table, a, b);
  for (const PairRule& rule : table.rules)
    if (rule.holds(a, b))
    {
      material.friction = rule.friction;
      material.restitution = rule.restitution.value_or(material.restitution);
    }
  return material;
}

}  // namespace frictional_contact_sim
