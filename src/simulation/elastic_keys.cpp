#include "elastic_keys.h"

#include <algorithm>

#include "frictional_contact_sim/deformable/elastic_spec.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MOST_CELLS = 1000000;  ///< along one side

/** One number or a list of them. */
std::vector<int> readCells(const ConfigNode& node)
{
  std::vector<int> cells;
  if (!node.isList())
    cells.push_back(node.integer(1, MOST_CELLS));
  else
    for (const ConfigNode& item : node.items("cells"))
      cells.push_back(item.integer(1, MOST_CELLS));
  return cells;
}

void checkSource(const ConfigNode& node, const ElasticSpec& spec)
{
  const bool is_built_in = node.has("box") || node.has("bar");
  const bool is_matrices = node.has("mass") || node.has("stiffness") || node.has("nodes");
  if (static_cast<int>(node.has("box")) + node.has("bar") + node.has("mesh") + is_matrices != 1)
    node.fail("expected exactly one of box, bar, mesh, and mass with stiffness and nodes");
  if (node.has("box") && spec.box.size() != 2 && spec.box.size() != 3)
    node.at("box").failExpecting("two sizes (x, z) or three [m]");
  if (is_built_in && !node.has("cells"))
    node.at("cells").failExpecting("the number of cells along each side");
  if (!is_built_in && node.has("cells"))
    node.at("cells").failExpecting("none beside a file");
  const size_t sides = node.has("bar") ? 1 : spec.box.size();
  if (is_built_in && spec.cells.size() != sides)
    node.at("cells").failExpecting(std::to_string(sides) + (sides == 1 ? " number" : " numbers") + ", one a size");
  for (const char* const part : {"mass", "stiffness", "nodes"})
    if (is_matrices && !node.has(part))
      node.at(part).failExpecting("a file: mass, stiffness and nodes belong together");
  for (const char* const property : {"young_modulus", "poisson_ratio", "density"})
    if (is_matrices && node.has(property))
      node.at(property).failExpecting("none beside matrices, which hold it");
    else if (!is_matrices && !node.has(property) && (property != std::string("poisson_ratio") || !node.has("bar")))
      node.at(property).failExpecting("a number: the material has no default");
}

ElasticSpec readElastic(const ConfigNode& node)
{
  ElasticSpec spec;
  ElasticMaterial& material = spec.material;
  const auto file = [](const char* name, std::string& path)
  { return key(name, [&path](const ConfigNode& value) { path = resolveFile(value); }); };
  node.readMap({key("box", [&](const ConfigNode& value) { spec.box = value.numbers(positive()); }),
                key("bar", spec.bar, positive()),
                key("cells", [&](const ConfigNode& value) { spec.cells = readCells(value); }),
                file("mesh", spec.mesh), file("mass", spec.mass), file("stiffness", spec.stiffness),
                file("nodes", spec.nodes), key("young_modulus", material.young_modulus, positive()),
                key("poisson_ratio", material.poisson_ratio, between(0.0, 0.4999)),
                key("density", material.density, positive()),
                key("plane", material.plane,
                    Choices<PlaneModel>{{"strain", PlaneModel::STRAIN}, {"stress", PlaneModel::STRESS}}),
                key("thickness", material.thickness, positive()), key("area", material.area, positive()),
                key("damping", spec.damping, notNegative()),
                key("fixed", [&](const ConfigNode& value) { spec.fixed = value.texts(); })});
  checkSource(node, spec);
  return spec;
}
}  // namespace

ConfigKeys elasticBodyKeys(BodySpec& body)
{
  static const std::vector<std::string> SHARED = {"pose", "velocity", "wrenches", "motion", "material"};
  ConfigKeys keys = {required(key("elastic",
                                  [&body](const ConfigNode& node)
                                  { body.elastic = std::make_shared<ElasticSpec>(readElastic(node)); }))};
  for (const ConfigKey& one : bodyKeys(body))
    if (std::find(SHARED.begin(), SHARED.end(), one.name) != SHARED.end())
      keys.push_back(one);
  return keys;
}

}  // namespace frictional_contact_sim
