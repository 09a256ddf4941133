#include "yaml_reader.h"

#include <algorithm>

#include "frictional_contact_sim/simulation/scenario_error.h"

namespace frictional_contact_sim
{
std::string YamlReader::found() const
{
  if (!node_.IsDefined() || node_.IsNull())
    return "nothing";
  if (node_.IsScalar())
    return "'" + node_.Scalar() + "'";
  return node_.IsSequence() ? "a list of " + std::to_string(node_.size()) : "a map";
}

std::string YamlReader::place() const
{
  const int line = node_.IsDefined() ? node_.Mark().line + 1 : 0;
  return file_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
         (key_.empty() ? "the document" : "key '" + key_ + "'");
}

void YamlReader::fail(const std::string& reason) const
{
  throw ScenarioError(place() + ": " + reason);
}

void YamlReader::expectMap() const
{
  if (!node_.IsDefined() || !node_.IsMap())
    fail("found " + found() + ", expected a map");
}

void YamlReader::expectMap(std::initializer_list<const char*> keys) const
{
  expectMap();
  for (const auto& entry : node_)
  {
    const std::string name = entry.first.Scalar();
    if (std::find(keys.begin(), keys.end(), name) != keys.end())
      continue;
    std::string known;
    for (const char* key : keys)
      known += (known.empty() ? "" : ", ") + std::string(key);
    YamlReader(entry.first, file_, key_.empty() ? name : key_ + "." + name)
        .fail("unknown key, expected one of: " + known);
  }
}

void YamlReader::expectSequence(const std::string& of_what) const
{
  if (!node_.IsDefined() || !node_.IsSequence())
    fail("found " + found() + ", expected a list of " + of_what);
}

double YamlReader::number() const
{
  double value = 0.0;
  if (!node_.IsDefined() || !node_.IsScalar() || !YAML::convert<double>::decode(node_, value))
    fail("found " + found() + ", expected a number");
  if (!std::isfinite(value))
    fail("found " + found() + ", expected a finite number");
  return value;
}

double YamlReader::number(double lower, double upper, const std::string& expected) const
{
  const double value = number();
  if (value < lower || value > upper)
    fail("found " + found() + ", expected " + expected);
  return value;
}

int YamlReader::integer(int lower) const
{
  int value = 0;
  if (!node_.IsDefined() || !node_.IsScalar() || !YAML::convert<int>::decode(node_, value) || value < lower)
    fail("found " + found() + ", expected a whole number of at least " + std::to_string(lower));
  return value;
}

bool YamlReader::boolean() const
{
  bool value = false;
  if (!node_.IsDefined() || !node_.IsScalar() || !YAML::convert<bool>::decode(node_, value))
    fail("found " + found() + ", expected true or false");
  return value;
}

std::string YamlReader::text() const
{
  if (!node_.IsDefined() || !node_.IsScalar() || node_.Scalar().empty())
    fail("found " + found() + ", expected a text");
  return node_.Scalar();
}

Eigen::Vector3d YamlReader::vector3() const
{
  if (!node_.IsDefined() || !node_.IsSequence() || node_.size() != 3)
    fail("found " + found() + ", expected a list of 3 numbers");
  return {item(0).number(), item(1).number(), item(2).number()};
}

}  // namespace frictional_contact_sim
