#include "elastic_keys.h"

#include <algorithm>

#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/deformable/elastic_spec.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MOST_CELLS = 100000;  ///< of a body: a gigabyte or two while its matrices are assembled
constexpr int MOST_COLUMNS = 2000000;  ///< of the Jacobians of a rod's sections, three numbers twice each: 0.3 GB

/** Those of all bodies that this one has too. */
ConfigKeys sharedKeys(BodySpec& body, const std::vector<std::string>& names)
{
  ConfigKeys keys;
  for (const ConfigKey& one : bodyKeys(body))
    if (std::find(names.begin(), names.end(), one.name) != names.end())
      keys.push_back(one);
  return keys;
}

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
  double cells = 1.0;
  for (const int along : spec.cells)
    cells *= along;
  if (cells > MOST_CELLS)
    node.at("cells").fail("found " + numberText(cells) + " cells in all, expected at most " +
                          std::to_string(MOST_CELLS));
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
  {
    return key(
        name, [&path](const ConfigNode& value) { path = resolveFile(value); });
  };
  node.readMap(
      {key("box", [&](const ConfigNode& value) { spec.box = value.numbers(positive()); }),
       key("bar", spec.bar, positive()), key("cells", [&](const ConfigNode& value) { spec.cells = readCells(value); }),
       file("mesh", spec.mesh), file("mass", spec.mass), file("stiffness", spec.stiffness), file("nodes", spec.nodes),
       key("young_modulus", material.young_modulus, positive()),
       key("poisson_ratio", material.poisson_ratio, between(0.0, 0.4999)), key("density", material.density, positive()),
       key("plane", material.plane,
           Choices<PlaneModel>{{"strain", PlaneModel::STRAIN}, {"stress", PlaneModel::STRESS}}),
       key("thickness", material.thickness, positive()), key("area", material.area, positive()),
       key("damping", spec.damping, notNegative()),
       key("fixed", [&](const ConfigNode& value) { spec.fixed = value.texts(); })});
  checkSource(node, spec);
  return spec;
}
/** [twist, curvature 1, curvature 2], or a list of these. */
std::vector<double> readCurvatures(const ConfigNode& node, int pieces)
{
  const std::vector<ConfigNode> items = node.items("[twist, curvature 1, curvature 2]");
  if (items.empty() || !items.front().isList())
  {
    const Eigen::Vector3d all = node.vector<3>();
    return {all[0], all[1], all[2]};
  }
  std::vector<double> values;
  for (const ConfigNode& item : items)
    for (const double value : item.vector<3>())
      values.push_back(value);
  if (static_cast<int>(items.size()) != pieces)
    node.failExpecting("three numbers, or three for each of " + std::to_string(pieces) + " pieces");
  return values;
}

/** A number, or a list of one a piece. */
std::vector<double> readYoungModulus(const ConfigNode& node, int pieces)
{
  if (!node.isList())
    return {node.number(positive())};
  std::vector<double> values = node.numbers(positive());
  if (static_cast<int>(values.size()) != pieces)
    node.failExpecting("a number, or one for each of " + std::to_string(pieces) + " pieces");
  return values;
}

RodSpec readRod(const ConfigNode& node)
{
  RodSpec rod;
  constexpr int MOST_PIECES = 1000;
  node.readMap({required(key("length", rod.length, positive())), required(key("radius", rod.radius, positive())),
                key("pieces", rod.pieces, 1, MOST_PIECES), key("sections", rod.sections, 1, MOST_PIECES),
                required(key("density", rod.density, positive())),
                required(key("young_modulus", [&](const ConfigNode& value)
                             { rod.young_modulus = readYoungModulus(value, rod.pieces); })),
                key("poisson_ratio", rod.poisson_ratio, between(0.0, 0.5)), key("damping", rod.damping, notNegative()),
                key("natural", [&](const ConfigNode& value) { rod.natural = readCurvatures(value, rod.pieces); }),
                key("start", [&](const ConfigNode& value) { rod.start = readCurvatures(value, rod.pieces); })});
  if (!(rod.length / (rod.pieces * rod.sections) > 0.0))
    node.at("length").failExpecting("sections of some length");
  if (const double columns = static_cast<double>(rod.pieces) * rod.pieces * rod.sections; columns > MOST_COLUMNS)
    node.at("pieces").fail("found " + std::to_string(rod.pieces) + " pieces of " + std::to_string(rod.sections) +
                           " sections, expected pieces^2 sections of at most " + std::to_string(MOST_COLUMNS));
  return rod;
}
}  // namespace

ConfigKeys rodBodyKeys(BodySpec& body)
{
  ConfigKeys keys = {required(key("rod",
                                  [&body](const ConfigNode& node)
                                  {
                                    ElasticSpec spec;
                                    spec.rod = readRod(node);
                                    body.elastic = std::make_shared<ElasticSpec>(spec);
                                  }))};
  return keys + sharedKeys(body, {"pose", "wrenches", "motion", "material"});
}

ConfigKeys elasticBodyKeys(BodySpec& body)
{
  ConfigKeys keys = {required(key("elastic", [&body](const ConfigNode& node)
                                  { body.elastic = std::make_shared<ElasticSpec>(readElastic(node)); }))};
  return keys + sharedKeys(body, {"pose", "velocity", "wrenches", "motion", "material"});
}

}  // namespace frictional_contact_sim
