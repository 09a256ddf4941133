#include "frictional_contact_sim/config/config_node.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "frictional_contact_sim/config/nearest_name.h"

namespace frictional_contact_sim
{
namespace
{
const ConfigValue NOTHING;

const ConfigEntry* find(const ConfigValue& map, const std::string& key)
{
  const auto found =
      std::find_if(map.entries.begin(), map.entries.end(), [&](const ConfigEntry& entry) { return entry.key == key; });
  return found == map.entries.end() ? nullptr : &*found;
}
}  // namespace

ConfigNode::ConfigNode(std::shared_ptr<const ConfigDocument> document)
  : document_(std::move(document))
  , value_(&document_->root)
  , path_(document_->notation == ConfigNotation::PARAMETERS ? "~" : "")
  , line_(value_->line)
{
}

ConfigNode::ConfigNode(const ConfigNode& parent, const ConfigValue& value, std::string path, int line)
  : document_(parent.document_), value_(&value), path_(std::move(path)), line_(line)
{
}

ConfigNode ConfigNode::child(const std::string& key, const ConfigValue& value, int line) const
{
  const std::string separator = document_->notation == ConfigNotation::FILE ? "." : "/";
  const bool is_root = path_.empty() || path_ == "~";
  return {*this, value, path_ + (is_root ? "" : separator) + key, line};
}

ConfigNode ConfigNode::child(const ConfigEntry& entry) const
{
  return child(entry.key, entry.value, entry.value.line > 0 ? entry.value.line : entry.line);
}

bool ConfigNode::has(const std::string& key) const
{
  const ConfigEntry* entry = find(*value_, key);
  return entry != nullptr && entry->value.kind != ConfigValue::Kind::NOTHING;
}

ConfigNode ConfigNode::at(const std::string& key) const
{
  const ConfigEntry* entry = find(*value_, key);
  return entry == nullptr ? child(key, NOTHING, line_) : child(*entry);
}

std::vector<std::pair<std::string, ConfigNode>> ConfigNode::entries() const
{
  if (!isMap())
    failExpecting("a map");
  std::vector<std::pair<std::string, ConfigNode>> entries;
  for (const ConfigEntry& entry : value_->entries)
    entries.emplace_back(entry.key, child(entry));
  return entries;
}

std::vector<ConfigNode> ConfigNode::items(const std::string& of_what) const
{
  if (!isList())
    failExpecting("a list of " + of_what);
  std::vector<ConfigNode> items;
  for (size_t i = 0; i < value_->items.size(); ++i)
  {
    const std::string index = std::to_string(i);
    const std::string place = document_->notation == ConfigNotation::FILE ? "[" + index + "]" : "/" + index;
    const ConfigValue& item = value_->items[i];
    items.push_back({*this, item, path_ + place, item.line > 0 ? item.line : line_});
  }
  return items;
}

double ConfigNode::number(const NumberRange& range, const std::string& or_else) const
{
  if (!value_->number || !range.holds(*value_->number))
    failExpecting(range.expected() + or_else);
  return *value_->number;
}

int ConfigNode::integer(int lower, int upper) const
{
  NumberRange range = atLeast(lower);
  if (upper < std::numeric_limits<int>::max())
    range.upper = upper;
  if (!value_->integer || !range.holds(*value_->integer))
    failExpecting(range.expected("an integer"));
  return *value_->integer;
}

bool ConfigNode::boolean() const
{
  if (!value_->boolean)
    failExpecting("true or false");
  return *value_->boolean;
}

std::string ConfigNode::text() const
{
  if (!value_->text || value_->text->empty())
    failExpecting("a text");
  return *value_->text;
}

std::string ConfigNode::anyText() const
{
  if (!value_->text)
    failExpecting("a text");
  return *value_->text;
}

std::string ConfigNode::literal() const
{
  if (!isScalar())
    failExpecting("a number, a word, true or false");
  return value_->literal;
}

std::vector<double> ConfigNode::numbers(const NumberRange& range) const
{
  std::vector<double> values;
  for (const ConfigNode& item : items("numbers"))
    values.push_back(item.number(range));
  return values;
}

std::vector<double> ConfigNode::numbersOf(size_t size) const
{
  if (!isList() || value_->items.size() != size)
    failExpecting("a list of " + std::to_string(size) + " numbers");
  return numbers();
}

std::vector<std::string> ConfigNode::texts() const
{
  std::vector<std::string> values;
  for (const ConfigNode& item : items("texts"))
    values.push_back(item.text());
  return values;
}

std::pair<std::string, std::string> ConfigNode::pairOfTexts() const
{
  if (!isList() || value_->items.size() != 2)
    failExpecting("a pair of names: [a, b]");
  const std::vector<std::string> both = texts();
  return {both[0], both[1]};
}

size_t ConfigNode::indexOf(const std::vector<std::string>& words) const
{
  const std::string found = value_->text.value_or("");
  const auto word = std::find(words.begin(), words.end(), found);
  if (!value_->text || word == words.end())
  {
    const std::string nearest = nearestName(found, words);
    failExpecting(eitherOf(words) + (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)"));
  }
  return static_cast<size_t>(word - words.begin());
}

void ConfigNode::judgeUnknown(const ConfigEntry& entry, const ConfigKeys& keys, UnknownKeys unknown) const
{
  std::vector<std::string> names;
  for (const ConfigKey& one : keys)
    names.push_back(one.name);
  const ConfigNode node = child(entry.key, entry.value, entry.line);
  const std::string meant = didYouMean(entry.key, names);
  if (unknown == UnknownKeys::REFUSED || document_->warnings == nullptr)
    node.fail("unknown key, " + meant + "expected one of: " + joinNames(names));
  document_->warnings->push_back(node.message("unknown parameter, " + meant + "ignored"));
}

void ConfigNode::readMap(const ConfigKeys& keys, UnknownKeys unknown) const
{
  if (!isMap())
    failExpecting("a map");
  for (const ConfigEntry& entry : value_->entries)
    if (std::none_of(keys.begin(), keys.end(), [&](const ConfigKey& one) { return one.name == entry.key; }))
      judgeUnknown(entry, keys, unknown);
  for (const ConfigKey& one : keys)
    if (one.required || has(one.name) || (one.even_empty && find(*value_, one.name) != nullptr))
      one.read(at(one.name));
}

std::string ConfigNode::place() const
{
  if (document_->notation == ConfigNotation::PARAMETERS)
    return path_;
  return document_->source + (line_ > 0 ? ":" + std::to_string(line_) : "") + ": " +
         (path_.empty() ? "the document" : "key '" + path_ + "'");
}

std::string ConfigNode::message(const std::string& reason) const
{
  return inOneLine(place() + ": " + reason);
}

void ConfigNode::fail(const std::string& reason) const
{
  throw ConfigError(message(reason));
}

void ConfigNode::failExpecting(const std::string& expected) const
{
  fail("found " + found() + ", expected " + expected);
}

std::string ConfigNode::folder() const
{
  const std::filesystem::path file = document_->notation == ConfigNotation::FILE ? document_->source : "";
  return std::filesystem::absolute(file.empty() ? "." : file.parent_path() / ".").lexically_normal().string();
}

namespace
{
/** The element of a list by index or name; nullptr where there is none. */
ConfigValue* elementOf(ConfigValue& list, const std::string& part)
{
  const bool is_index = !part.empty() && part.size() < 9 && part.find_first_not_of("0123456789") == std::string::npos;
  if (is_index && static_cast<size_t>(std::stoi(part)) < list.items.size())
    return &list.items[static_cast<size_t>(std::stoi(part))];
  for (ConfigValue& item : list.items)
    for (const ConfigEntry& entry : item.entries)
      if (entry.key == "name" && entry.value.text == part)
        return &item;
  return nullptr;
}
}  // namespace

ConfigNode ConfigNode::changed(const std::string& path, double value) const
{
  const auto document = std::make_shared<ConfigDocument>(*document_);
  ConfigValue* place = &document->root;
  const auto refuse = [&](const std::string& reason)
  { throw ConfigError(document_->source + ": '" + path + "': " + reason); };
  for (size_t begin = 0; begin <= path.size();)
  {
    const size_t end = std::min(path.find('.', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    begin = end + 1;
    if (part.empty())
      refuse("found an empty name, expected keys with dots between");
    if (place->kind == ConfigValue::Kind::LIST)
    {
      ConfigValue* element = elementOf(*place, part);
      if (element == nullptr)
        refuse("found no element '" + part + "', expected an index below " + std::to_string(place->items.size()) +
               " or the name of one");
      place = element;
      continue;
    }
    if (place->kind == ConfigValue::Kind::SCALAR)
      refuse("found " + place->shown + " on the way to '" + part + "', expected a map or a list");
    place->kind = ConfigValue::Kind::MAP;
    ConfigValue* next = nullptr;
    for (ConfigEntry& entry : place->entries)
      if (entry.key == part)
        next = &entry.value;
    if (next == nullptr)
    {
      place->entries.push_back({part, place->line, {}});
      next = &place->entries.back().value;
      next->line = place->line;
    }
    place = next;
  }
  if (place->kind == ConfigValue::Kind::LIST || place->kind == ConfigValue::Kind::MAP)
    refuse("found " + place->shown + ", expected a number");
  char text[40];
  std::snprintf(text, sizeof(text), "%.17g", value);
  place->kind = ConfigValue::Kind::SCALAR;
  place->literal = text;
  place->shown = "'" + place->literal + "'";
  place->text = place->literal;
  place->number = value;
  place->boolean.reset();
  place->integer.reset();
  if (value == std::round(value) && std::abs(value) < 1e9)
    place->integer = static_cast<int>(value);
  return ConfigNode(document);
}

std::string ConfigNode::stem() const
{
  return std::filesystem::path(document_->source).stem().string();
}

ConfigKey key(const std::string& name, double& target, const NumberRange& range)
{
  return {name, [&target, range](const ConfigNode& node) { target = node.number(range); }};
}

ConfigKey key(const std::string& name, int& target, int lower, int upper)
{
  return {name, [&target, lower, upper](const ConfigNode& node) { target = node.integer(lower, upper); }};
}

ConfigKey key(const std::string& name, bool& target)
{
  return {name, [&target](const ConfigNode& node) { target = node.boolean(); }};
}

ConfigKey key(const std::string& name, std::string& target)
{
  return {name, [&target](const ConfigNode& node) { target = node.anyText(); }};
}

ConfigKey key(const std::string& name, std::function<void(const ConfigNode&)> read)
{
  return {name, std::move(read)};
}

ConfigKey required(ConfigKey one)
{
  one.required = true;
  return one;
}

ConfigKey evenEmpty(ConfigKey one)
{
  one.even_empty = true;
  return one;
}

ConfigKeys operator+(ConfigKeys first, const ConfigKeys& second)
{
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace frictional_contact_sim
