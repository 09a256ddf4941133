// YAML to RollingCase; every mistake is one line: file:line, key, found, expected.
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "frictional_contact_sim/rolling/rolling_case.h"

namespace frictional_contact_sim
{
namespace
{
class Entry
{
public:
  Entry(YAML::Node node, std::string file, std::string key)
    : node_(std::move(node)), file_(std::move(file)), key_(std::move(key))
  {
  }

  const YAML::Node& node() const { return node_; }
  bool has(const char* name) const { return node_[name].IsDefined() && !node_[name].IsNull(); }
  Entry at(const std::string& name) const { return {node_[name], file_, key_.empty() ? name : key_ + "." + name}; }
  Entry at(size_t i) const { return {node_[i], file_, key_ + "[" + std::to_string(i) + "]"}; }

  [[noreturn]] void fail(const std::string& expected) const
  {
    std::string found = "nothing";
    if (node_.IsDefined() && node_.IsScalar())
      found = "'" + node_.Scalar() + "'";
    else if (node_.IsDefined() && node_.IsSequence())
      found = "a list of " + std::to_string(node_.size());
    else if (node_.IsDefined() && node_.IsMap())
      found = "a map";
    failWith("found " + found + ", expected " + expected);
  }
  [[noreturn]] void failWith(const std::string& reason) const
  {
    const int line = node_.IsDefined() ? node_.Mark().line + 1 : 0;
    throw std::invalid_argument(file_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                                (key_.empty() ? "the document" : "key '" + key_ + "'") + ": " + reason);
  }
  void expectMap(const std::vector<std::string>& keys) const
  {
    if (!node_.IsDefined() || !node_.IsMap())
      fail("a map");
    for (const auto& pair : node_)
    {
      const std::string name = pair.first.Scalar();
      std::string known;
      bool listed = false;
      for (const std::string& key : keys)
      {
        known += (known.empty() ? "" : ", ") + key;
        listed = listed || key == name;
      }
      if (!listed)
        Entry(pair.first, file_, key_.empty() ? name : key_ + "." + name).fail("one of the keys " + known);
    }
  }
  template <typename Accept>
  double number(const char* expected, Accept accept) const
  {
    double value = 0.0;
    if (!node_.IsDefined() || !node_.IsScalar() || !YAML::convert<double>::decode(node_, value) ||
        !std::isfinite(value) || !accept(value))
      fail(expected);
    return value;
  }
  double positive() const
  {
    return number(
        "a number > 0", [](double value) { return value > 0.0; });
  }
  double any() const
  {
    return number(
        "a finite number", [](double) { return true; });
  }
  int integer(int lower, int upper) const
  {
    int value = 0;
    if (!node_.IsDefined() || !node_.IsScalar() || !YAML::convert<int>::decode(node_, value) || value < lower ||
        value > upper)
      fail("a whole number from " + std::to_string(lower) + " to " + std::to_string(upper));
    return value;
  }
  /// Index of a word in a list of words.
  int word(const std::vector<std::string>& words) const
  {
    std::string known;
    for (size_t i = 0; i < words.size(); ++i)
    {
      if (node_.IsDefined() && node_.IsScalar() && node_.Scalar() == words[i])
        return static_cast<int>(i);
      known += (i > 0 ? " or " : "") + words[i];
    }
    fail(known);
  }
  /// A scalar or a list, as a list of entries.
  std::vector<Entry> listed() const
  {
    if (node_.IsDefined() && node_.IsScalar())
      return {*this};
    if (!node_.IsDefined() || !node_.IsSequence() || node_.size() == 0)
      fail("a value or a list of values");
    std::vector<Entry> entries;
    for (size_t i = 0; i < node_.size(); ++i)
      entries.push_back(at(i));
    return entries;
  }

private:
  YAML::Node node_;
  std::string file_;
  std::string key_;
};

double poissonRatio(const Entry& entry)
{
  return entry.number(
      "a number in (-1, 0.5)", [](double value) { return value > -1.0 && value < 0.5; });
}

void readMaterials(const Entry& root, RollingCase& study)
{
  const Entry upper = root.at("upper");
  upper.expectMap({"young_modulus", "poisson_ratio"});
  study.upper.young_modulus = upper.at("young_modulus").positive();
  study.upper.poisson_ratio = poissonRatio(upper.at("poisson_ratio"));
  study.lower_poisson_ratio = study.upper.poisson_ratio;
  if (!root.has("lower"))
    return;
  const Entry lower = root.at("lower");
  if (lower.node().IsScalar())
  {
    lower.word({"rigid"});
    return;
  }
  lower.expectMap({"young_modulus", "poisson_ratio"});
  study.lower_moduli.clear();
  for (const Entry& entry : lower.at("young_modulus").listed())
    study.lower_moduli.push_back(entry.node().IsScalar() && entry.node().Scalar() == "rigid"
                                     ? RollingCase::RIGID
                                     : entry.number("a number > 0 or rigid", [](double value) { return value > 0.0; }));
  if (lower.has("poisson_ratio"))
    study.lower_poisson_ratio = poissonRatio(lower.at("poisson_ratio"));
}

void setKinds(const Entry& range, ElementKind kind, Contour& contour)
{
  if (!range.node().IsDefined() || !range.node().IsSequence() || range.node().size() != 2)
    range.fail(kind == ElementKind::CONTACT ? "[first, last] element; there are no contact nodes"
                                            : "[first, last] element");
  const int last = static_cast<int>(contour.size()) - 1;
  const int first = range.at(size_t{0}).integer(0, last);
  for (int i = first; i <= range.at(size_t{1}).integer(first, last); ++i)
    contour.kinds[static_cast<size_t>(i)] = kind;
}

void readContour(const Entry& entry, RollingCase& study)
{
  entry.expectMap({"points", "contact", "held"});
  const Entry points = entry.at("points");
  if (!points.node().IsDefined() || !points.node().IsSequence() || points.node().size() < 3)
    points.fail("a list of at least three points [x, y]");
  Eigen::Matrix2Xd matrix(2, static_cast<Eigen::Index>(points.node().size()));
  for (size_t i = 0; i < points.node().size(); ++i)
  {
    const Entry point = points.at(i);
    if (!point.node().IsSequence() || point.node().size() != 2)
      point.fail("a point [x, y]");
    matrix.col(static_cast<Eigen::Index>(i)) << point.at(size_t{0}).any(), point.at(size_t{1}).any();
  }
  Contour contour = makePolygon(matrix);
  setKinds(entry.at("contact"), ElementKind::CONTACT, contour);
  setKinds(entry.at("held"), ElementKind::HELD, contour);
  try
  {
    contour.validate();
  }
  catch (const std::invalid_argument& error)
  {
    points.failWith(std::string(error.what()) + ", expected a simple polygon run counter-clockwise");
  }
  study.contour = contour;
}

/// Keys that another one leaves without a meaning are mistakes, not to be passed over.
void checkDiscretisation(const Entry& root, const RollingCase& study)
{
  const bool half_plane = study.source == FlexibilitySource::HALF_PLANE;
  for (const char* key : {"contour", "mesh"})
    if (half_plane && root.has(key))
      root.at(key).failWith("found beside flexibility: half_plane, expected boundary_elements");
  for (const char* key : {"nodes", "half_width", "mesh"})
    if (study.contour && root.has(key))
      root.at(key).failWith("found beside contour, whose points are the mesh, expected one of them");
  if (!half_plane && study.half_width > study.radius)
  {
    std::ostringstream expected;
    expected << "a number up to the radius of " << study.radius << " m";
    root.at("half_width").fail(expected.str());
  }
}

void readDiscretisation(const Entry& root, RollingCase& study)
{
  constexpr int MAX_NODES = 2000;
  if (root.has("flexibility"))
    study.source = static_cast<FlexibilitySource>(root.at("flexibility").word({"boundary_elements", "half_plane"}));
  if (root.has("frames"))
    study.frames = static_cast<ContactFrames>(root.at("frames").word({"contour", "flat"}));
  if (root.has("gap"))
    study.gap = static_cast<GapShape>(root.at("gap").word({"parabola", "circle"}));
  if (root.has("nodes"))
    study.nodes = root.at("nodes").integer(1, MAX_NODES);
  if (root.has("half_width"))
    study.half_width = root.at("half_width").positive();
  if (root.has("datum"))
    study.datum = root.at("datum").positive();
  if (root.has("mesh"))
  {
    const Entry mesh = root.at("mesh");
    mesh.expectMap({"growth", "max_angle", "held_angle"});
    const auto within = [&mesh](const char* name, double lower, double upper, const char* expected, double& value)
    {
      if (mesh.has(name))
        value = mesh.at(name).number(expected, [=](double found) { return found >= lower && found <= upper; });
    };
    within("growth", 1.0, 10.0, "a number in [1, 10]", study.mesh.growth);
    within("max_angle", 1e-3, 0.5, "a number in [0.001, 0.5]", study.mesh.max_angle);
    within("held_angle", 1e-3, 1.57, "a number in [0.001, 1.57]", study.mesh.held_angle);
  }
  if (root.has("contour"))
    readContour(root.at("contour"), study);
  checkDiscretisation(root, study);
}

void readDriving(const Entry& root, RollingCase& study)
{
  if (root.has("load") == root.has("displacement"))
    root.at("load").failWith("found both or neither of load and displacement, expected one of them");
  if (root.has("load"))
  {
    const Entry load = root.at("load");
    load.expectMap({"normal", "tangential_share"});
    study.load = load.at("normal").positive();
    if (load.has("tangential_share"))
      study.load_share =
          load.at("tangential_share").number("a number in (-1, 1)", [](double value) { return std::abs(value) < 1.0; });
  }
  else
  {
    const Entry displacement = root.at("displacement");
    displacement.expectMap({"normal", "tangential"});
    study.normal_displacement = displacement.at("normal").positive();
    if (displacement.has("tangential"))
      study.tangential_displacement = displacement.at("tangential").any();
  }
  if (root.has("rolling"))
  {
    const Entry rolling = root.at("rolling");
    rolling.expectMap({"motion", "creepage", "direction", "max_steps", "steady_tolerance"});
    if (rolling.has("motion"))
      study.motion = static_cast<Motion>(rolling.at("motion").word({"static", "transient", "steady"}));
    if (rolling.has("creepage"))
      study.creepage = rolling.at("creepage").any();
    if (rolling.has("direction"))
      study.direction = rolling.at("direction").number("1 or -1", [](double value) { return std::abs(value) == 1.0; });
    if (rolling.has("max_steps"))
      study.max_steps = rolling.at("max_steps").integer(1, 1000000);
    if (rolling.has("steady_tolerance"))
      study.steady_tolerance = rolling.at("steady_tolerance").positive();
  }
  if (root.has("creep_curve"))
  {
    const Entry curve = root.at("creep_curve");
    curve.expectMap({"points"});
    study.curve_points = curve.at("points").integer(3, 1000);
    if (!study.load)
      curve.failWith("found without load, expected load.normal, which the curve keeps");
  }
}
}  // namespace

RollingCase parseRollingCase(const std::string& text, const std::string& name)
{
  YAML::Node document;
  try
  {
    document = YAML::Load(text);
  }
  catch (const YAML::Exception& error)
  {
    throw std::invalid_argument(name + ":" + std::to_string(error.mark.line + 1) + ": not YAML: " + error.msg);
  }
  const Entry root(document, name, "");
  root.expectMap({"name", "upper", "lower", "radius", "friction", "flexibility", "frames", "gap", "nodes", "half_width",
                  "datum", "mesh", "contour", "load", "displacement", "rolling", "creep_curve"});
  RollingCase study;
  study.name = name.substr(name.find_last_of('/') + 1);
  study.name = study.name.substr(0, study.name.find_last_of('.'));
  if (root.has("name"))
  {
    if (!root.at("name").node().IsScalar() || root.at("name").node().Scalar().find('/') != std::string::npos)
      root.at("name").fail("a word without slashes, the beginning of the files' names");
    study.name = root.at("name").node().Scalar();
  }
  readMaterials(root, study);
  if (root.has("radius"))
    study.radius = root.at("radius").positive();
  study.friction.clear();
  for (const Entry& entry : root.at("friction").listed())
    study.friction.push_back(entry.number("a number >= 0", [](double value) { return value >= 0.0; }));
  readDiscretisation(root, study);
  readDriving(root, study);
  return study;
}

RollingCase loadRollingCase(const std::string& file)
{
  std::ifstream in(file);
  std::ostringstream text;
  if (!(in && text << in.rdbuf()))
    throw std::invalid_argument(file + ": cannot be read, expected a YAML file");
  return parseRollingCase(text.str(), file);
}

}  // namespace frictional_contact_sim
