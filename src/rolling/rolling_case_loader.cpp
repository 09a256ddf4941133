// YAML to RollingCase; every mistake is one line: file:line, key, found, expected.
#include <cmath>

#include "frictional_contact_sim/config/yaml_config.h"
#include "frictional_contact_sim/rolling/rolling_case.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MAX_NODES = 2000;

/** A scalar or a list, as a list of nodes. */
std::vector<ConfigNode> listed(const ConfigNode& node)
{
  if (node.isScalar())
    return {node};
  if (!node.isList() || node.items("values").empty())
    node.failExpecting("a value or a list of values");
  return node.items("values");
}

ConfigKey poissonKey(double& ratio)
{
  return key("poisson_ratio", ratio, inside(-1.0, 0.5));
}

void readUpper(const ConfigNode& node, RollingCase& study)
{
  node.readMap({required(key("young_modulus", study.upper.young_modulus, positive())),
                required(poissonKey(study.upper.poisson_ratio))});
}

double lowerModulus(const ConfigNode& node)
{
  return node.isScalar() && node.literal() == "rigid" ? RollingCase::RIGID : node.number(positive(), " or rigid");
}

void readLower(const ConfigNode& node, RollingCase& study)
{
  if (node.isScalar())
  {
    node.choice(Choices<bool>{{"rigid", true}});
    return;
  }
  study.lower_moduli.clear();
  node.readMap({required(key("young_modulus",
                             [&](const ConfigNode& moduli)
                             {
                               for (const ConfigNode& one : listed(moduli))
                                 study.lower_moduli.push_back(lowerModulus(one));
                             })),
                poissonKey(study.lower_poisson_ratio)});
}

ConfigKey kindsKey(const std::string& name, ElementKind kind, Contour& contour)
{
  const auto read = [kind, &contour](const ConfigNode& range)
  {
    const char* expected =
        kind == ElementKind::CONTACT ? "[first, last] element; there are no contact nodes" : "[first, last] element";
    if (!range.isList() || range.items("elements").size() != 2)
      range.failExpecting(expected);
    const std::vector<ConfigNode> ends = range.items("elements");
    const int last = static_cast<int>(contour.size()) - 1;
    const int first = ends[0].integer(0, last);
    for (int i = first; i <= ends[1].integer(first, last); ++i)
      contour.kinds[static_cast<size_t>(i)] = kind;
  };
  return required(key(name, read));
}

Contour readPoints(const ConfigNode& node)
{
  if (!node.isList() || node.items("points").size() < 3)
    node.failExpecting("a list of at least three points [x, y]");
  const std::vector<ConfigNode> points = node.items("points");
  Eigen::Matrix2Xd matrix(2, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i)
    matrix.col(static_cast<Eigen::Index>(i)) = points[i].vector<2>();
  return makePolygon(matrix);
}

void readContour(const ConfigNode& node, RollingCase& study)
{
  Contour contour;
  node.readMap({required(key("points", [&](const ConfigNode& points) { contour = readPoints(points); })),
                kindsKey("contact", ElementKind::CONTACT, contour), kindsKey("held", ElementKind::HELD, contour)});
  try
  {
    contour.validate();
  }
  catch (const std::invalid_argument& error)
  {
    node.at("points").fail(std::string(error.what()) + ", expected a simple polygon run counter-clockwise");
  }
  study.contour = contour;
}

void readMesh(const ConfigNode& node, RollingCase& study)
{
  node.readMap({key("growth", study.mesh.growth, between(1.0, 10.0)),
                key("max_angle", study.mesh.max_angle, between(1e-3, 0.5)),
                key("held_angle", study.mesh.held_angle, between(1e-3, 1.57))});
}

/// Keys that another one leaves without a meaning are mistakes, not to be passed over.
void checkDiscretisation(const ConfigNode& root, const RollingCase& study)
{
  const bool half_plane = study.source == FlexibilitySource::HALF_PLANE;
  for (const char* name : {"contour", "mesh"})
    if (half_plane && root.has(name))
      root.at(name).fail("found beside flexibility: half_plane, expected boundary_elements");
  for (const char* name : {"nodes", "half_width", "mesh"})
    if (study.contour && root.has(name))
      root.at(name).fail("found beside contour, whose points are the mesh, expected one of them");
  if (!half_plane && study.half_width > study.radius)
    root.at("half_width").failExpecting("a number up to the radius of " + numberText(study.radius) + " m");
}

ConfigKeys discretisationKeys(RollingCase& study)
{
  return {key("flexibility", study.source,
              Choices<FlexibilitySource>{{"boundary_elements", FlexibilitySource::BOUNDARY_ELEMENTS},
                                         {"half_plane", FlexibilitySource::HALF_PLANE}}),
          key("frames", study.frames,
              Choices<ContactFrames>{{"contour", ContactFrames::CONTOUR}, {"flat", ContactFrames::FLAT}}),
          key("gap", study.gap, Choices<GapShape>{{"parabola", GapShape::PARABOLA}, {"circle", GapShape::CIRCLE}}),
          key("nodes", study.nodes, 1, MAX_NODES),
          key("half_width", study.half_width, positive()),
          key("datum", study.datum, positive()),
          key(
              "mesh", [&study](const ConfigNode& node) { readMesh(node, study); }),
          key(
              "contour", [&study](const ConfigNode& node) { readContour(node, study); })};
}

void readLoad(const ConfigNode& node, RollingCase& study)
{
  study.load.emplace();
  const auto read_shares = [&study](const ConfigNode& shares)
  {
    for (const ConfigNode& one : listed(shares))
      study.load_shares.push_back(one.number(inside(-1.0, 1.0)));
  };
  node.readMap({required(key("normal", *study.load, positive())), key("tangential_share", read_shares)});
}

void readDisplacement(const ConfigNode& node, RollingCase& study)
{
  node.readMap({required(key("normal", study.normal_displacement, positive())),
                key("tangential", study.tangential_displacement)});
}

void readRolling(const ConfigNode& node, RollingCase& study)
{
  const auto read_direction = [&study](const ConfigNode& direction)
  {
    study.direction = direction.number();
    if (std::abs(study.direction) != 1.0)
      direction.failExpecting("1 or -1");
  };
  node.readMap(
      {key("motion", study.motion,
           Choices<Motion>{{"static", Motion::STATIC}, {"transient", Motion::TRANSIENT}, {"steady", Motion::STEADY}}),
       key("creepage", study.creepage), key("direction", read_direction), key("max_steps", study.max_steps, 1, 1000000),
       key("steady_tolerance", study.steady_tolerance, positive())});
}

ConfigKeys drivingKeys(RollingCase& study)
{
  return {key(
              "load", [&study](const ConfigNode& node) { readLoad(node, study); }),
          key(
              "displacement", [&study](const ConfigNode& node) { readDisplacement(node, study); }),
          key(
              "rolling", [&study](const ConfigNode& node) { readRolling(node, study); }),
          key(
              "creep_curve", [&study](const ConfigNode& node)
              { node.readMap({required(key("points", study.curve_points, 3, 1000))}); })};
}

void checkDriving(const ConfigNode& root, const RollingCase& study)
{
  if (study.load_shares.size() > 1 && study.motion != Motion::STATIC)
    root.at("load").at("tangential_share").fail("found several beside rolling.motion, expected one, or motion: static");
  if (root.has("load") == root.has("displacement"))
    root.at("load").fail("found both or neither of load and displacement, expected one of them");
  if (root.has("creep_curve") && !root.has("load"))
    root.at("creep_curve").fail("found without load, expected load.normal, which the curve keeps");
}

/** The beginning of the names of files. */
std::string readName(const ConfigNode& node)
{
  if (!node.isScalar() || node.literal().find('/') != std::string::npos)
    node.failExpecting("a word without slashes, the beginning of the files' names");
  return node.literal();
}

RollingCase readCase(const ConfigNode& root)
{
  RollingCase study;
  study.name = root.stem();
  study.friction.clear();
  root.readMap(ConfigKeys{key("name", [&](const ConfigNode& node) { study.name = readName(node); }),
                          required(key("upper",
                                       [&](const ConfigNode& node)
                                       {
                                         readUpper(node, study);
                                         study.lower_poisson_ratio = study.upper.poisson_ratio;
                                       })),
                          key("lower", [&](const ConfigNode& node) { readLower(node, study); }),
                          key("radius", study.radius, positive()),
                          required(key("friction",
                                       [&](const ConfigNode& node)
                                       {
                                         for (const ConfigNode& one : listed(node))
                                           study.friction.push_back(one.number(notNegative()));
                                       }))} +
               discretisationKeys(study) + drivingKeys(study));
  checkDiscretisation(root, study);
  checkDriving(root, study);
  return study;
}
}  // namespace

RollingCase parseRollingCase(const std::string& text, const std::string& name)
{
  return readCase(parseYaml(text, name));
}

RollingCase loadRollingCase(const std::string& file)
{
  return readCase(loadYaml(file, "a rolling case"));
}

}  // namespace frictional_contact_sim
