#include "frictional_contact_sim/dynamics/material.h"

#include <algorithm>

namespace frictional_contact_sim
{
const Material& MaterialTable::find(const std::string& name) const
{
  const auto entry = materials.find(name);
  return entry == materials.end() ? fallback : entry->second;
}

Material pairMaterial(const MaterialTable& table, const SurfaceSide& a, const SurfaceSide& b)
{
  const auto entry = table.pairs.find(std::minmax(a.material, b.material));
  if (entry != table.pairs.end())
    return entry->second;
  const Material& material_a = table.find(a.material);
  const Material& material_b = table.find(b.material);
  return {std::min(a.friction < 0.0 ? material_a.friction : a.friction,
                   b.friction < 0.0 ? material_b.friction : b.friction),
          std::min(material_a.restitution, material_b.restitution)};
}

}  // namespace frictional_contact_sim
