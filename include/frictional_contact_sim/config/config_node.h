#pragma once
/**
 * @file config_node.h
 * @brief The one reader of configuration: scenarios, creep curves and rolling cases (YAML, config/yaml_config.h) and
 * parameters of the node (XmlRpc, ros/parameter_tree.h).
 *
 * A back end turns its document into a tree of ConfigValues once; all rules are here. Every mistake is a ConfigError of
 * one line that names file and line or parameter, key, what was found and what was expected. A map is read by a table
 * of its keys, each named once: what it is called, where its value goes, what the value must be.
 *
 *     node.readMap({key("friction", material.friction, notNegative()), key("restitution", e, between(0.0, 1.0))});
 */
#include <Eigen/Core>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/config/config_error.h"
#include "frictional_contact_sim/config/number_range.h"

namespace frictional_contact_sim
{
struct ConfigEntry;

/** @brief A value of a document with what it may be read as: a YAML `1` is a number, an integer and a text. */
struct ConfigValue
{
  enum class Kind
  {
    NOTHING,  ///< not there, or null
    SCALAR,
    LIST,
    MAP
  };
  Kind kind = Kind::NOTHING;
  int line = 0;  ///< from 1, 0 = not known
  std::string shown = "nothing";  ///< in messages: "'abc'", "a list of 3"
  std::string literal;  ///< a scalar as it may be written in a file
  std::optional<std::string> text;
  std::optional<double> number;
  std::optional<int> integer;
  std::optional<bool> boolean;
  std::vector<ConfigValue> items;  ///< of a list
  std::vector<ConfigEntry> entries;  ///< of a map, in the order of the document, each key once
};

struct ConfigEntry
{
  std::string key;
  int line = 0;  ///< of the key
  ConfigValue value;
};

/** @brief How places are written in messages: FILE:LINE: key 'a.b[0]', or ~a/b/0. */
enum class ConfigNotation
{
  FILE,
  PARAMETERS
};

struct ConfigDocument
{
  ConfigValue root;
  ConfigNotation notation = ConfigNotation::FILE;
  std::string source;  ///< file name
  std::vector<std::string>* warnings = nullptr;  ///< where unknown keys are noted; none: they are errors
};

class ConfigNode;

/** @brief A key of a map and what is done with its value. */
struct ConfigKey
{
  std::string name;
  std::function<void(const ConfigNode&)> read;
  bool required = false;  ///< read, and refused, when it is not there
  bool even_empty = false;  ///< read when the key stands there without a value
};
using ConfigKeys = std::vector<ConfigKey>;

/** @brief Words and what they mean. */
template <typename T>
using Choices = std::vector<std::pair<std::string, T>>;

/** @brief Whether a map takes keys that nobody reads. */
enum class UnknownKeys
{
  AS_DOCUMENT,  ///< warnings where the document has a place for them, else errors
  REFUSED
};

class ConfigNode
{
public:
  explicit ConfigNode(std::shared_ptr<const ConfigDocument> document);

  bool isThere() const { return value_->kind != ConfigValue::Kind::NOTHING; }
  bool isScalar() const { return value_->kind == ConfigValue::Kind::SCALAR; }
  bool isList() const { return value_->kind == ConfigValue::Kind::LIST; }
  bool isMap() const { return value_->kind == ConfigValue::Kind::MAP; }
  bool isBoolean() const { return value_->boolean.has_value(); }
  /** @brief A map that has the key with a value. */
  bool has(const std::string& key) const;
  /** @brief The value of a key; one that is not there is nothing, at the line of the map. */
  ConfigNode at(const std::string& key) const;
  std::vector<std::pair<std::string, ConfigNode>> entries() const;  ///< @throws ConfigError unless it is a map
  /** @param of_what "wrenches", for the message; @throws ConfigError unless it is a list */
  std::vector<ConfigNode> items(const std::string& of_what) const;

  // Each throws a ConfigError unless the value is what is asked for.
  /** @param or_else what else is expected, for the message: " or rigid" */
  double number(const NumberRange& range = anyNumber(), const std::string& or_else = "") const;
  int integer(int lower, int upper = std::numeric_limits<int>::max()) const;
  bool boolean() const;
  std::string text() const;  ///< not empty
  std::string anyText() const;  ///< may be empty
  std::string literal() const;  ///< a scalar of any type
  std::vector<double> numbers(const NumberRange& range = anyNumber()) const;
  std::vector<std::string> texts() const;
  std::pair<std::string, std::string> pairOfTexts() const;
  template <int N>
  Eigen::Matrix<double, N, 1> vector() const
  {
    const std::vector<double> values = numbersOf(N);
    return Eigen::Map<const Eigen::Matrix<double, N, 1>>(values.data());
  }
  template <typename T>
  T choice(const Choices<T>& choices) const
  {
    std::vector<std::string> words;
    for (const auto& entry : choices)
      words.push_back(entry.first);
    return choices[indexOf(words)].second;
  }

  /**
   * @brief Reads a map by the table of its keys, in the table's order.
   * @throws ConfigError when it is no map, lacks a required key, or has one that is not in the table (with the nearest
   * one that is); where the document takes warnings the last is a warning
   */
  void readMap(const ConfigKeys& keys, UnknownKeys unknown = UnknownKeys::AS_DOCUMENT) const;

  /**
   * @brief A copy of the whole document with another number at one place, which is added to its map where it is not
   * there.
   * @param path keys with dots between; an element of a list by its index or by its key `name`: "bodies.box.pose.xyz.2"
   * @throws ConfigError when the path leads through a scalar, or to an element that is not there
   */
  ConfigNode changed(const std::string& path, double value) const;

  /** @brief FILE:LINE: key 'KEY', or the parameter. */
  std::string place() const;
  /** @brief @throws ConfigError "PLACE: reason" */
  [[noreturn]] void fail(const std::string& reason) const;
  /** @brief @throws ConfigError "PLACE: found VALUE, expected EXPECTED" */
  [[noreturn]] void failExpecting(const std::string& expected) const;
  /** @brief The value as messages show it. */
  const std::string& found() const { return value_->shown; }
  /** @brief Where relative paths start: the folder of the file, the current one for parameters. */
  std::string folder() const;
  /** @brief The file's name without folder and ending. */
  std::string stem() const;

private:
  ConfigNode(const ConfigNode& parent, const ConfigValue& value, std::string path, int line);
  ConfigNode child(const std::string& key, const ConfigValue& value, int line) const;
  ConfigNode child(const ConfigEntry& entry) const;
  std::string message(const std::string& reason) const;
  size_t indexOf(const std::vector<std::string>& words) const;
  std::vector<double> numbersOf(size_t size) const;
  void judgeUnknown(const ConfigEntry& entry, const ConfigKeys& keys, UnknownKeys unknown) const;

  std::shared_ptr<const ConfigDocument> document_;
  const ConfigValue* value_;
  std::string path_;
  int line_;
};

ConfigKey key(const std::string& name, double& target, const NumberRange& range = anyNumber());
ConfigKey key(const std::string& name, int& target, int lower, int upper = std::numeric_limits<int>::max());
ConfigKey key(const std::string& name, bool& target);
ConfigKey key(const std::string& name, std::string& target);  ///< may be empty
ConfigKey key(const std::string& name, std::function<void(const ConfigNode&)> read);
template <int N>
ConfigKey key(const std::string& name, Eigen::Matrix<double, N, 1>& target)
{
  return {name, [&target](const ConfigNode& node) { target = node.vector<N>(); }};
}
template <typename T>
ConfigKey key(const std::string& name, T& target, Choices<T> choices)
{
  return {name, [&target, choices](const ConfigNode& node) { target = node.choice(choices); }};
}
ConfigKey required(ConfigKey one);
ConfigKey evenEmpty(ConfigKey one);
/** @brief Both tables. */
ConfigKeys operator+(ConfigKeys first, const ConfigKeys& second);

}  // namespace frictional_contact_sim
