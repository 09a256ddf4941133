#include "frictional_contact_sim/simulation/scenario_loader.h"

#include <regex>
#include <set>

#include "frictional_contact_sim/config/yaml_config.h"
#include "elastic_keys.h"
#include "frictional_contact_sim/simulation/scenario_keys.h"
#include "loop_keys.h"

namespace frictional_contact_sim
{
namespace
{
std::string readName(const ConfigNode& node)
{
  const std::string name = node.text();
  if (!std::regex_match(name, std::regex("[A-Za-z][A-Za-z0-9_]*")))
    node.failExpecting("letters, digits and _, a letter first");
  return name;
}

BodySpec readBody(const ConfigNode& node)
{
  BodySpec body;
  body.source = node.place();
  const ConfigKey name = required(key("name", [&](const ConfigNode& value) { body.name = readName(value); }));
  if (node.has("elastic"))
  {
    node.readMap(ConfigKeys{name} + elasticBodyKeys(body));
    return body;
  }
  node.readMap(ConfigKeys{name,
                          required(key("urdf", [&](const ConfigNode& urdf) { body.urdf_path = resolveFile(urdf); })),
                          linkMaterialsKey("materials", body)} +
               bodyKeys(body));
  return body;
}

void readBodies(const ConfigNode& node, Scenario& scenario)
{
  std::set<std::string> names;
  for (const ConfigNode& body : node.items("bodies"))
  {
    scenario.bodies.push_back(readBody(body));
    if (!names.insert(scenario.bodies.back().name).second)
      body.at("name").fail("found '" + scenario.bodies.back().name + "' twice, expected different names");
  }
}

/** Keys of the format for what is not built yet. */
ConfigKeys futureKeys()
{
  return {key(
      "quasi_static",
      [](const ConfigNode& node)
      {
        if (node.boolean())
          node.fail("quasi-static problems are not built yet, expected false");
      })};
}

Scenario readScenario(const ConfigNode& document)
{
  Scenario scenario;
  scenario.name = document.stem();
  document.readMap(numericKeys(scenario) + surroundingKeys(scenario) + futureKeys() +
                   ConfigKeys{key("duration", scenario.duration, notNegative()),
                              key("bodies", [&](const ConfigNode& node) { readBodies(node, scenario); }),
                              key("loops", [&](const ConfigNode& node) { readLoops(node, scenario); })});
  if (!document.has("bodies"))
    document.fail("has no bodies, expected a list of them under the key 'bodies'");
  const std::vector<ConfigNode> bodies = document.at("bodies").items("bodies");
  for (size_t i = 0; i < bodies.size(); ++i)
    checkMaterials(bodies[i], "materials", scenario.bodies[i], scenario.materials);
  return scenario;
}
}  // namespace

Scenario loadScenario(const std::string& yaml, const std::string& source)
{
  return readScenario(parseYaml(yaml, source));
}

Scenario loadScenarioFile(const std::string& path)
{
  return readScenario(loadYaml(path, "a scenario file"));
}

Scenario loadScenarioFile(const std::string& path, const std::string& key, double value)
{
  return readScenario(loadYaml(path, "a scenario file").changed(key, value));
}

}  // namespace frictional_contact_sim
