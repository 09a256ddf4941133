#include "frictional_contact_sim/ros/parameter_reader.h"

#include <cmath>
#include <sstream>

#include "frictional_contact_sim/ros/parameter_error.h"

namespace frictional_contact_sim
{
using XmlRpc::XmlRpcValue;

namespace
{
std::string numberText(double number)
{
  std::ostringstream text;
  text << number;
  return text.str();
}

bool toNumber(XmlRpcValue value, double& number)
{
  if (value.getType() == XmlRpcValue::TypeInt)
  {
    number = static_cast<int>(value);
    return true;
  }
  if (value.getType() == XmlRpcValue::TypeDouble)
  {
    number = static_cast<double>(value);
    return std::isfinite(number);
  }
  return false;
}

}  // namespace

NumberRule anyNumber()
{
  return {"a finite number", [](double) { return true; }};
}

NumberRule positive()
{
  return {"a finite number > 0", [](double number) { return number > 0.0; }};
}

NumberRule notNegative()
{
  return {"a finite number >= 0", [](double number) { return number >= 0.0; }};
}

NumberRule between(double lower, double upper)
{
  return {"a number in [" + numberText(lower) + ", " + numberText(upper) + "]",
          [lower, upper](double number) { return number >= lower && number <= upper; }};
}

std::string describe(const XmlRpcValue& value)
{
  XmlRpcValue copy = value;  // the accessors of XmlRpcValue are not const
  switch (value.getType())
  {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool>(copy) ? "the boolean true" : "the boolean false";
    case XmlRpcValue::TypeInt:
      return "the number " + std::to_string(static_cast<int>(copy));
    case XmlRpcValue::TypeDouble:
      return "the number " + numberText(static_cast<double>(copy));
    case XmlRpcValue::TypeString:
      return "the string '" + static_cast<std::string>(copy) + "'";
    case XmlRpcValue::TypeArray:
      return "a list of " + std::to_string(value.size());
    case XmlRpcValue::TypeStruct:
      return "a dictionary";
    default:
      return "a value of another type";
  }
}

ParameterReader::ParameterReader(const XmlRpcValue& tree, std::string prefix) : tree_(tree), prefix_(std::move(prefix))
{
}

bool ParameterReader::has(const std::string& name) const
{
  return tree_.getType() == XmlRpcValue::TypeStruct && tree_.hasMember(name);
}

std::vector<std::string> ParameterReader::names() const
{
  std::vector<std::string> names;
  if (tree_.getType() == XmlRpcValue::TypeStruct)
  {
    XmlRpcValue copy = tree_;
    for (const auto& entry : copy)
      names.push_back(entry.first);
  }
  return names;
}

void ParameterReader::fail(const std::string& name, const std::string& expected) const
{
  XmlRpcValue copy = tree_;
  throw ParameterError(prefix_ + name + ": found " + describe(copy[name]) + ", expected " + expected);
}

XmlRpcValue ParameterReader::raw(const std::string& name)
{
  known_.insert(name);
  return has(name) ? tree_[name] : XmlRpcValue();
}

bool ParameterReader::isStruct(const std::string& name) const
{
  return has(name) && XmlRpcValue(tree_)[name].getType() == XmlRpcValue::TypeStruct;
}

bool ParameterReader::isList(const std::string& name) const
{
  return has(name) && XmlRpcValue(tree_)[name].getType() == XmlRpcValue::TypeArray;
}

ParameterReader ParameterReader::child(const std::string& name)
{
  const XmlRpcValue value = raw(name);
  if (has(name) && value.getType() != XmlRpcValue::TypeStruct)
    fail(name, "a dictionary");
  return ParameterReader(value, prefix_ + name + "/");
}

std::vector<std::string> ParameterReader::unknown() const
{
  std::vector<std::string> unknown;
  for (const std::string& name : names())
    if (known_.count(name) == 0)
      unknown.push_back(prefix_ + name);
  return unknown;
}

void ParameterReader::read(const std::string& name, double& value, const NumberRule& rule)
{
  const XmlRpcValue found = raw(name);
  if (!has(name))
    return;
  double number = 0.0;
  if (!toNumber(found, number) || !rule.holds(number))
    fail(name, rule.expected);
  value = number;
}

void ParameterReader::read(const std::string& name, int& value, int smallest)
{
  XmlRpcValue found = raw(name);
  if (!has(name))
    return;
  if (found.getType() != XmlRpcValue::TypeInt || static_cast<int>(found) < smallest)
    fail(name, "an integer >= " + std::to_string(smallest));
  value = static_cast<int>(found);
}

void ParameterReader::read(const std::string& name, bool& value)
{
  XmlRpcValue found = raw(name);
  if (!has(name))
    return;
  if (found.getType() != XmlRpcValue::TypeBoolean)
    fail(name, "true or false");
  value = static_cast<bool>(found);
}

void ParameterReader::read(const std::string& name, std::string& value)
{
  XmlRpcValue found = raw(name);
  if (!has(name))
    return;
  if (found.getType() != XmlRpcValue::TypeString)
    fail(name, "a string");
  value = static_cast<std::string>(found);
}

void ParameterReader::read(const std::string& name, std::vector<double>& value, size_t size)
{
  XmlRpcValue found = raw(name);
  if (!has(name))
    return;
  const std::string expected = "a list of " + std::to_string(size) + " finite numbers";
  if (found.getType() != XmlRpcValue::TypeArray || found.size() != static_cast<int>(size))
    fail(name, expected);
  std::vector<double> numbers(size);
  for (size_t i = 0; i < size; ++i)
    if (!toNumber(found[static_cast<int>(i)], numbers[i]))
      fail(name, expected + " (number " + std::to_string(i + 1) + " is " + describe(found[static_cast<int>(i)]) + ")");
  value = numbers;
}

void ParameterReader::read(const std::string& name, std::vector<std::string>& value)
{
  XmlRpcValue found = raw(name);
  if (!has(name))
    return;
  if (found.getType() != XmlRpcValue::TypeArray)
    fail(name, "a list of strings");
  std::vector<std::string> strings;
  for (int i = 0; i < found.size(); ++i)
  {
    if (found[i].getType() != XmlRpcValue::TypeString)
      fail(name, "a list of strings");
    strings.push_back(static_cast<std::string>(found[i]));
  }
  value = strings;
}

void ParameterReader::read(const std::string& name, std::vector<std::pair<std::string, std::string>>& value)
{
  XmlRpcValue found = raw(name);
  if (!has(name))
    return;
  const std::string expected = "a list of pairs of names: [[a, b], ...]";
  if (found.getType() != XmlRpcValue::TypeArray)
    fail(name, expected);
  std::vector<std::pair<std::string, std::string>> pairs;
  for (int i = 0; i < found.size(); ++i)
  {
    XmlRpcValue& pair = found[i];
    const bool two = pair.getType() == XmlRpcValue::TypeArray && pair.size() == 2;
    if (!two || pair[0].getType() != XmlRpcValue::TypeString || pair[1].getType() != XmlRpcValue::TypeString)
      fail(name, expected);
    pairs.emplace_back(static_cast<std::string>(pair[0]), static_cast<std::string>(pair[1]));
  }
  value = pairs;
}

}  // namespace frictional_contact_sim
