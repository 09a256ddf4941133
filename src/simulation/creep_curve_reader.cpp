#include "creep_curve_reader.h"

#include "frictional_contact_sim/config/yaml_config.h"

namespace frictional_contact_sim
{
namespace
{
/** A list from 0 on. @param entry what each one is compared with the one before */
std::vector<double> numbersFromZero(const ConfigNode& list)
{
  const std::vector<double> values = list.numbers();
  const std::vector<ConfigNode> items = list.items("numbers");
  if (values.size() < 2)
    list.fail("found " + std::to_string(values.size()) + " entries, expected at least 2");
  if (values.front() != 0.0)
    items[0].failExpecting("0 as the first entry");
  return values;
}

std::vector<double> readCreepage(const ConfigNode& list)
{
  const std::vector<double> creepage = numbersFromZero(list);
  const std::vector<ConfigNode> items = list.items("numbers");
  for (size_t i = 1; i < creepage.size(); ++i)
    if (!(creepage[i] > creepage[i - 1]))
      items[i].failExpecting("more than the entry before, " + items[i - 1].found());
  return creepage;
}

std::vector<double> readTraction(const ConfigNode& list)
{
  const std::vector<double> traction = numbersFromZero(list);
  const std::vector<ConfigNode> items = list.items("numbers");
  for (size_t i = 1; i < traction.size(); ++i)
    if (!(traction[i] >= traction[i - 1]))
      items[i].failExpecting("at least the entry before, " + items[i - 1].found());
  if (traction.back() != 1.0)
    items.back().failExpecting("1 as the last entry");
  return traction;
}

void readCurve(const ConfigNode& map, CreepTable& curve)
{
  // Modulus, Poisson's ratio and radius tell where the curve is from; the law does not use them.
  const auto ignored = [](const ConfigNode&) {};
  map.readMap({required(key("friction", curve.friction, positive())),
               required(key("reference_load", curve.reference_load, positive())),
               required(key("creepage", [&](const ConfigNode& list) { curve.creepage = readCreepage(list); })),
               required(key("traction", [&](const ConfigNode& list) { curve.traction = readTraction(list); })),
               key("young_modulus", ignored), key("poisson_ratio", ignored), key("radius", ignored)});
  if (curve.traction.size() != curve.creepage.size())
    map.at("traction")
        .fail("found " + std::to_string(curve.traction.size()) + " entries, expected as many as creepage, " +
              std::to_string(curve.creepage.size()));
  // From the first 1 on the curve is Coulomb's law: the tangent on the way back is the segment before.
  while (curve.traction[curve.traction.size() - 2] == 1.0)
  {
    curve.traction.pop_back();
    curve.creepage.pop_back();
  }
}
}  // namespace

std::shared_ptr<const CreepTable> readCreepCurve(const std::string& path)
{
  auto curve = std::make_shared<CreepTable>();
  loadYaml(path, "a creep curve")
      .readMap({required(key("creep_curve", [&](const ConfigNode& map) { readCurve(map, *curve); }))});
  return curve;
}

}  // namespace frictional_contact_sim
