#include "frictional_contact_sim/simulation/scenario_loader.h"

#include <regex>
#include <set>

#include "elastic_keys.h"
#include "frictional_contact_sim/config/yaml_config.h"
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
  if (node.has("elastic") || node.has("rod"))
  {
    node.readMap(ConfigKeys{name} + (node.has("rod") ? rodBodyKeys(body) : elasticBodyKeys(body)));
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

/** What a step is; see dynamics/regime.h. */
ConfigKeys regimeKeys(Scenario& scenario)
{
  const auto choose = [&scenario](Regime regime)
  {
    return [&scenario, regime](const ConfigNode& node)
    {
      if (!node.boolean())
        return;
      if (scenario.regime != Regime::DYNAMIC)
        node.fail("found true beside quasi_static: true, expected one of them");
      scenario.regime = regime;
    };
  };
  return {key("quasi_static", choose(Regime::QUASI_STATIC)), key("static", choose(Regime::STATIC))};
}

Scenario readScenario(const ConfigNode& document)
{
  Scenario scenario;
  scenario.name = document.stem();
  document.readMap(numericKeys(scenario) + surroundingKeys(scenario) + regimeKeys(scenario) +
                   ConfigKeys{key("duration", scenario.duration, notNegative()),
                              key("bodies", [&](const ConfigNode& node) { readBodies(node, scenario); }),
                              key("loops", [&](const ConfigNode& node) { readLoops(node, scenario); })});
  if (scenario.regime == Regime::STATIC)
    scenario.duration = scenario.time_step;  // one equilibrium
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
