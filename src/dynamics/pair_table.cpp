#include "frictional_contact_sim/dynamics/pair_table.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

namespace frictional_contact_sim
{
PairTable::PairTable(const MaterialTable& materials, const std::vector<SurfaceSide>& sides)
{
  std::map<std::tuple<std::string, double, std::vector<bool>>, int> classes;
  std::vector<SurfaceSide> members;
  for (const SurfaceSide& side : sides)
  {
    std::vector<bool> groups;
    for (const PairRule& rule : materials.rules)
      groups.insert(groups.end(), {rule.a.holds(side), rule.b.holds(side)});
    const auto [entry, inserted] =
        classes.emplace(std::make_tuple(side.material, side.friction, groups), classes.size());
    if (inserted)
      members.push_back(side);
    class_of_.push_back(entry->second);
  }
  classes_ = static_cast<int>(members.size());
  for (const SurfaceSide& a : members)
    for (const SurfaceSide& b : members)
      table_.push_back(pairMaterial(materials, a, b));
}

bool PairTable::keepsCreepCurves() const
{
  return std::all_of(
      table_.begin(), table_.end(),
      [](const Material& material)
      { return material.creep == nullptr || material.creep->friction == material.friction; });
}

bool PairTable::hasCreep() const
{
  return std::any_of(
      table_.begin(), table_.end(), [](const Material& material) { return material.creep != nullptr; });
}

}  // namespace frictional_contact_sim
