#include "frictional_contact_sim/dynamics/pair_table.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace frictional_contact_sim
{
PairTable::PairTable(const MaterialTable& materials, const std::vector<SurfaceSide>& sides)
{
  std::map<std::pair<std::string, double>, int> classes;
  std::vector<SurfaceSide> members;
  for (const SurfaceSide& side : sides)
  {
    const auto [entry, inserted] = classes.emplace(std::make_pair(side.material, side.friction), classes.size());
    if (inserted)
      members.push_back(side);
    class_of_.push_back(entry->second);
  }
  classes_ = static_cast<int>(members.size());
  for (const SurfaceSide& a : members)
    for (const SurfaceSide& b : members)
      table_.push_back(pairMaterial(materials, a, b));
}

bool PairTable::hasCreep() const
{
  return std::any_of(
      table_.begin(), table_.end(), [](const Material& material) { return material.creep != nullptr; });
}

}  // namespace frictional_contact_sim
