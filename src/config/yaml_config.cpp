#include "frictional_contact_sim/config/yaml_config.h"

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "frictional_contact_sim/config/nearest_name.h"

namespace frictional_contact_sim
{
namespace
{
constexpr size_t LONGEST_SHOWN = 80;  ///< letters of a value in a message
constexpr int DEEPEST = 100;  ///< an alias can contain itself
constexpr size_t MOST_VALUES = 500000;  ///< aliases of aliases multiply

class Reader
{
public:
  explicit Reader(std::string source) : source_(std::move(source)) {}

  ConfigValue read(const YAML::Node& node, int depth = 0)
  {
    ConfigValue value;
    value.line = lineOf(node);
    if (depth > DEEPEST || ++count_ > MOST_VALUES)
      fail(value.line, depth > DEEPEST ? "is nested more than 100 deep" : "has more than 500000 values");
    if (node.IsScalar())
      readScalar(node, value);
    else if (node.IsSequence())
      readList(node, depth, value);
    else if (node.IsMap())
      readMap(node, depth, value);
    return value;
  }
  [[noreturn]] void fail(int line, const std::string& reason) const
  {
    throw ConfigError(inOneLine(source_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + reason));
  }

private:
  static int lineOf(const YAML::Node& node) { return node.IsDefined() ? node.Mark().line + 1 : 0; }

  template <typename T>
  static std::optional<T> as(const YAML::Node& node)
  {
    T value{};
    return YAML::convert<T>::decode(node, value) ? std::optional<T>(value) : std::nullopt;
  }

  static void readScalar(const YAML::Node& node, ConfigValue& value)
  {
    value.kind = ConfigValue::Kind::SCALAR;
    value.literal = node.Scalar();
    value.text = value.literal;
    value.number = as<double>(node);
    value.integer = as<int>(node);
    value.boolean = as<bool>(node);
    value.shown = "'" + inOneLine(value.literal, LONGEST_SHOWN) + "'";
  }

  void readList(const YAML::Node& node, int depth, ConfigValue& value)
  {
    value.kind = ConfigValue::Kind::LIST;
    value.shown = "a list of " + std::to_string(node.size());
    for (const YAML::Node& item : node)
      value.items.push_back(read(item, depth + 1));
  }

  void readMap(const YAML::Node& node, int depth, ConfigValue& value)
  {
    value.kind = ConfigValue::Kind::MAP;
    value.shown = "a map";
    std::map<std::string, int> lines;
    for (const auto& entry : node)
    {
      const int line = lineOf(entry.first);
      if (!entry.first.IsScalar())
        fail(line, "a key is no word, expected KEY: VALUE");
      const std::string key = entry.first.Scalar();
      const auto [first, is_new] = lines.emplace(key, line);
      if (!is_new)
        fail(line,
             "key '" + key + "': found twice, first in line " + std::to_string(first->second) + ", expected once");
      value.entries.push_back({key, line, read(entry.second, depth + 1)});
    }
  }

  std::string source_;
  size_t count_ = 0;
};
}  // namespace

ConfigNode parseYaml(const std::string& text, const std::string& source)
{
  auto document = std::make_shared<ConfigDocument>();
  document->source = source;
  Reader reader(source);
  try
  {
    document->root = reader.read(YAML::Load(text));
  }
  catch (const YAML::Exception& error)
  {
    reader.fail(error.mark.line + 1, "not valid YAML: " + error.msg);
  }
  return ConfigNode(document);
}

ConfigNode loadYaml(const std::string& path, const std::string& what)
{
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw ConfigError(path + ": is a folder, expected " + what + " (YAML)");
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || (file.peek() != std::ifstream::traits_type::eof() && !(text << file.rdbuf())))
    throw ConfigError(path + ": cannot be read, expected " + what + " (YAML)");
  return parseYaml(text.str(), path);
}

}  // namespace frictional_contact_sim
