#include "frictional_contact_sim/ros/parameter_tree.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include "frictional_contact_sim/config/nearest_name.h"

namespace frictional_contact_sim
{
using XmlRpc::XmlRpcValue;

namespace
{
constexpr size_t LONGEST_SHOWN = 80;  ///< letters of a string in a message

ConfigValue read(XmlRpcValue& value);  // the accessors of XmlRpcValue are not const

ConfigValue scalar(const std::string& literal, const std::string& shown)
{
  ConfigValue read;
  read.kind = ConfigValue::Kind::SCALAR;
  read.literal = literal;
  read.shown = shown;
  return read;
}

ConfigValue readNumber(double number)
{
  ConfigValue read = scalar(numberText(number), "the number " + numberText(number));
  read.number = number;
  return read;
}

ConfigValue readBoolean(bool boolean)
{
  const std::string word = boolean ? "true" : "false";
  ConfigValue read = scalar(word, "the boolean " + word);
  read.boolean = boolean;
  return read;
}

ConfigValue readString(const std::string& text)
{
  ConfigValue read = scalar(text, "the string '" + inOneLine(text, LONGEST_SHOWN) + "'");
  read.text = text;
  return read;
}

ConfigValue readList(XmlRpcValue& list)
{
  ConfigValue result;
  result.kind = ConfigValue::Kind::LIST;
  result.shown = "a list of " + std::to_string(list.size());
  for (int i = 0; i < list.size(); ++i)
    result.items.push_back(read(list[i]));
  return result;
}

ConfigValue readMap(XmlRpcValue& map)
{
  ConfigValue result;
  result.kind = ConfigValue::Kind::MAP;
  result.shown = "a dictionary";
  for (auto& entry : map)
    result.entries.push_back({entry.first, 0, read(entry.second)});
  return result;
}

ConfigValue read(XmlRpcValue& value)
{
  switch (value.getType())
  {
    case XmlRpcValue::TypeBoolean:
      return readBoolean(static_cast<bool>(value));
    case XmlRpcValue::TypeInt:
    {
      ConfigValue result = readNumber(static_cast<int>(value));
      result.integer = static_cast<int>(value);
      return result;
    }
    case XmlRpcValue::TypeDouble:
      return readNumber(static_cast<double>(value));
    case XmlRpcValue::TypeString:
      return readString(static_cast<std::string>(value));
    case XmlRpcValue::TypeArray:
      return readList(value);
    case XmlRpcValue::TypeStruct:
      return readMap(value);
    default:
      return scalar("", "a value of another type");  // a date, bytes
  }
}
}  // namespace

ConfigNode parameterTree(const XmlRpcValue& tree, std::vector<std::string>* warnings)
{
  auto document = std::make_shared<ConfigDocument>();
  document->notation = ConfigNotation::PARAMETERS;
  document->warnings = warnings;
  document->root.kind = ConfigValue::Kind::MAP;
  XmlRpcValue copy = tree;
  if (copy.getType() == XmlRpcValue::TypeStruct)
    document->root = read(copy);
  return ConfigNode(document);
}

}  // namespace frictional_contact_sim
