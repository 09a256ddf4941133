#include "creep_curve_reader.h"

#include <fstream>
#include <sstream>

#include "frictional_contact_sim/simulation/scenario_error.h"
#include "yaml_reader.h"

namespace frictional_contact_sim
{
namespace
{
double positive(const YamlReader& map, const char* key)
{
  const YamlReader child = map.child(key);
  const double value = child.number();
  if (!(value > 0.0))
    child.fail("found '" + child.text() + "', expected a number > 0");
  return value;
}

std::vector<double> numbers(const YamlReader& list)
{
  list.expectSequence("numbers");
  std::vector<double> values;
  for (size_t i = 0; i < list.node().size(); ++i)
    values.push_back(list.item(i).number());
  if (values.size() < 2)
    list.fail("found " + std::to_string(values.size()) + " entries, expected at least 2");
  if (values.front() != 0.0)
    list.item(0).fail("found '" + list.item(0).text() + "', expected 0 as the first entry");
  return values;
}

void checkCreepage(const YamlReader& list, const std::vector<double>& creepage)
{
  for (size_t i = 1; i < creepage.size(); ++i)
    if (!(creepage[i] > creepage[i - 1]))
      list.item(i).fail("found '" + list.item(i).text() + "', expected more than the entry before, '" +
                        list.item(i - 1).text() + "'");
}

void checkTraction(const YamlReader& list, const std::vector<double>& traction)
{
  for (size_t i = 1; i < traction.size(); ++i)
    if (!(traction[i] >= traction[i - 1]))
      list.item(i).fail("found '" + list.item(i).text() + "', expected at least the entry before, '" +
                        list.item(i - 1).text() + "'");
  if (traction.back() != 1.0)
    list.item(traction.size() - 1)
        .fail("found '" + list.item(traction.size() - 1).text() + "', expected 1 as the last entry");
}

std::shared_ptr<const CreepTable> readCurve(const YamlReader& document)
{
  document.expectMap({"creep_curve"});
  const YamlReader map = document.child("creep_curve");
  // Modulus, Poisson's ratio and radius tell where the curve is from; the law does not use them.
  map.expectMap({"friction", "reference_load", "creepage", "traction", "young_modulus", "poisson_ratio", "radius"});
  auto curve = std::make_shared<CreepTable>();
  curve->friction = positive(map, "friction");
  curve->reference_load = positive(map, "reference_load");
  curve->creepage = numbers(map.child("creepage"));
  checkCreepage(map.child("creepage"), curve->creepage);
  curve->traction = numbers(map.child("traction"));
  checkTraction(map.child("traction"), curve->traction);
  if (curve->traction.size() != curve->creepage.size())
    map.child("traction")
        .fail("found " + std::to_string(curve->traction.size()) + " entries, expected as many as creepage, " +
              std::to_string(curve->creepage.size()));
  // From the first 1 on the curve is Coulomb's law: the tangent on the way back is the segment before.
  while (curve->traction[curve->traction.size() - 2] == 1.0)
  {
    curve->traction.pop_back();
    curve->creepage.pop_back();
  }
  return curve;
}
}  // namespace

std::shared_ptr<const CreepTable> readCreepCurve(const std::string& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file)
    throw ScenarioError(path + ": cannot be read, expected a creep curve (YAML map creep_curve)");
  try
  {
    return readCurve(YamlReader(YAML::Load(text.str()), path, ""));
  }
  catch (const YAML::Exception& error)
  {
    throw ScenarioError(path + ":" + std::to_string(error.mark.line + 1) + ": not valid YAML: " + error.msg);
  }
}

}  // namespace frictional_contact_sim
