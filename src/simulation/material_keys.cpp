#include "material_keys.h"

#include <algorithm>

#include "creep_curve_reader.h"
#include "frictional_contact_sim/config/nearest_name.h"

namespace frictional_contact_sim
{
namespace
{
enum class PairLaw
{
  COULOMB,
  CREEP
};

ConfigKeys surfaceKeys(Material& material)
{
  return {frictionKey("friction", material.friction), restitutionKey("restitution", material.restitution),
          restitutionKey("tangential_restitution", material.tangential_restitution)};
}

/** A misspelt friction is another simulation: refused, whatever the document does with unknown keys. */
Material readMaterial(const ConfigNode& node, const Material& fallback)
{
  Material material = fallback;
  node.readMap(surfaceKeys(material), UnknownKeys::REFUSED);
  return material;
}

/** law: creep takes its friction from the curve, whose shape depends on it. */
void setCreep(const ConfigNode& pair, Material& material)
{
  if (!pair.has("curve"))
    pair.fail("law creep: found no curve, expected curve: FILE");
  material.creep = readCreepCurve(resolveFile(pair.at("curve")));
  if (pair.has("friction") && material.friction != material.creep->friction)
    pair.at("friction").failExpecting("the curve's friction " + numberText(material.creep->friction) + " or no entry");
  material.friction = material.creep->friction;
}

void readPair(const ConfigNode& pair, MaterialTable& table)
{
  Material material = table.fallback;
  std::pair<std::string, std::string> between;
  PairLaw law = PairLaw::COULOMB;
  const auto read_curve_later = [](const ConfigNode&) {};
  pair.readMap(ConfigKeys{required(key("between", [&](const ConfigNode& node) { between = node.pairOfTexts(); })),
                          key("law", law, Choices<PairLaw>{{"coulomb", PairLaw::COULOMB}, {"creep", PairLaw::CREEP}}),
                          key("curve", read_curve_later)} +
                   surfaceKeys(material),
               UnknownKeys::REFUSED);
  if (law == PairLaw::CREEP)
    setCreep(pair, material);
  else if (pair.has("curve"))
    pair.at("curve").failExpecting("none without law: creep");
  table.pairs[std::minmax(between.first, between.second)] = material;
}

std::vector<std::string> knownMaterials(const MaterialTable& table)
{
  std::vector<std::string> known = {"default"};
  for (const auto& entry : table.materials)
    known.push_back(entry.first);
  for (const auto& entry : table.pairs)
    known.insert(known.end(), {entry.first.first, entry.first.second});
  return known;
}
}  // namespace

ConfigKey frictionKey(const std::string& name, double& friction)
{
  return key(name, friction, notNegative());
}

ConfigKey restitutionKey(const std::string& name, double& restitution)
{
  return key(name, restitution, between(0.0, 1.0));
}

/** The default is read first: the others take from it what they do not say. */
void readMaterials(const ConfigNode& node, MaterialTable& table)
{
  const auto entries = node.entries();
  if (node.has("default"))
    table.fallback = readMaterial(node.at("default"), table.fallback);
  for (const auto& [name, material] : entries)
    if (name != "default" && name != "pairs")
      table.materials[name] = readMaterial(material, table.fallback);
  if (node.has("pairs"))
    for (const ConfigNode& pair : node.at("pairs").items("pairs {between: [a, b], friction: mu, restitution: e}"))
      readPair(pair, table);
}

void checkMaterials(const ConfigNode& body, const std::string& links, const BodySpec& spec,
                    const MaterialTable& materials)
{
  const std::vector<std::string> known = knownMaterials(materials);
  const auto check = [&](const ConfigNode& place, const std::string& name)
  {
    if (std::find(known.begin(), known.end(), name) == known.end())
      place.fail("found '" + name + "', " + didYouMean(name, known) +
                 "expected a name from materials: " + joinNames(known));
  };
  check(body.at("material"), spec.material);
  for (const auto& [link, name] : spec.link_materials)
    check(body.at(links).at(link), name);
}

}  // namespace frictional_contact_sim
