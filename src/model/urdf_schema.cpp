#include "urdf_schema.h"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
using tinyxml2::XMLElement;

enum class Range
{
  ANY,
  NOT_NEGATIVE,
  POSITIVE,
  NOT_ZERO
};

enum class Need
{
  OPTIONAL,
  REQUIRED
};

struct AttributeRule
{
  const char* element;
  const char* name;
  int numbers;  ///< 0 = text
  Range range;
  Need need;
};

constexpr std::array ATTRIBUTES = {
    AttributeRule{"robot", "name", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"robot", "version", 0, Range::ANY, Need::OPTIONAL},
    AttributeRule{"link", "name", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"joint", "name", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"joint", "type", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"loop_joint", "name", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"loop_joint", "type", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"link1", "link", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"link2", "link", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"origin1", "xyz", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"origin1", "rpy", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"origin2", "xyz", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"origin2", "rpy", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"child_origin", "xyz", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"child_origin", "rpy", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"collision", "name", 0, Range::ANY, Need::OPTIONAL},
    AttributeRule{"parent", "link", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"child", "link", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"mimic", "joint", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"mesh", "filename", 0, Range::ANY, Need::REQUIRED},
    AttributeRule{"mesh", "scale", 3, Range::NOT_ZERO, Need::OPTIONAL},
    AttributeRule{"origin", "xyz", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"origin", "rpy", 3, Range::ANY, Need::OPTIONAL},
    AttributeRule{"axis", "xyz", 3, Range::ANY, Need::REQUIRED},
    AttributeRule{"mass", "value", 1, Range::NOT_NEGATIVE, Need::REQUIRED},
    AttributeRule{"inertia", "ixx", 1, Range::ANY, Need::REQUIRED},
    AttributeRule{"inertia", "ixy", 1, Range::ANY, Need::REQUIRED},
    AttributeRule{"inertia", "ixz", 1, Range::ANY, Need::REQUIRED},
    AttributeRule{"inertia", "iyy", 1, Range::ANY, Need::REQUIRED},
    AttributeRule{"inertia", "iyz", 1, Range::ANY, Need::REQUIRED},
    AttributeRule{"inertia", "izz", 1, Range::ANY, Need::REQUIRED},
    AttributeRule{"box", "size", 3, Range::POSITIVE, Need::REQUIRED},
    AttributeRule{"sphere", "radius", 1, Range::NOT_NEGATIVE, Need::REQUIRED},
    AttributeRule{"cylinder", "radius", 1, Range::POSITIVE, Need::REQUIRED},
    AttributeRule{"cylinder", "length", 1, Range::POSITIVE, Need::REQUIRED},
    AttributeRule{"capsule", "radius", 1, Range::POSITIVE, Need::REQUIRED},
    AttributeRule{"capsule", "length", 1, Range::NOT_NEGATIVE, Need::REQUIRED},
    AttributeRule{"limit", "lower", 1, Range::ANY, Need::OPTIONAL},
    AttributeRule{"limit", "upper", 1, Range::ANY, Need::OPTIONAL},
    AttributeRule{"limit", "effort", 1, Range::NOT_NEGATIVE, Need::REQUIRED},
    AttributeRule{"limit", "velocity", 1, Range::NOT_NEGATIVE, Need::REQUIRED},
    AttributeRule{"dynamics", "damping", 1, Range::NOT_NEGATIVE, Need::OPTIONAL},
    AttributeRule{"dynamics", "friction", 1, Range::NOT_NEGATIVE, Need::OPTIONAL},
    AttributeRule{"mimic", "multiplier", 1, Range::ANY, Need::OPTIONAL},
    AttributeRule{"mimic", "offset", 1, Range::ANY, Need::OPTIONAL},
};

struct ElementRule
{
  const char* parent;
  const char* name;
  Need need;
  bool repeated;  ///< may appear more than once
};

/// `gazebo` and `loop_joint` are read apart; they are kept here and removed by the reader.
constexpr std::array ELEMENTS = {
    ElementRule{"robot", "link", Need::REQUIRED, true},
    ElementRule{"robot", "joint", Need::OPTIONAL, true},
    ElementRule{"robot", "gazebo", Need::OPTIONAL, true},
    ElementRule{"robot", "loop_joint", Need::OPTIONAL, true},
    ElementRule{"link", "inertial", Need::OPTIONAL, false},
    ElementRule{"link", "collision", Need::OPTIONAL, true},
    ElementRule{"inertial", "origin", Need::OPTIONAL, false},
    ElementRule{"inertial", "mass", Need::REQUIRED, false},
    ElementRule{"inertial", "inertia", Need::REQUIRED, false},
    ElementRule{"collision", "origin", Need::OPTIONAL, false},
    ElementRule{"collision", "geometry", Need::REQUIRED, false},
    ElementRule{"geometry", "box", Need::OPTIONAL, false},
    ElementRule{"geometry", "sphere", Need::OPTIONAL, false},
    ElementRule{"geometry", "cylinder", Need::OPTIONAL, false},
    ElementRule{"geometry", "capsule", Need::OPTIONAL, false},
    ElementRule{"geometry", "mesh", Need::OPTIONAL, false},
    ElementRule{"joint", "origin", Need::OPTIONAL, false},
    ElementRule{"joint", "parent", Need::REQUIRED, false},
    ElementRule{"joint", "child", Need::REQUIRED, false},
    ElementRule{"joint", "axis", Need::OPTIONAL, false},
    ElementRule{"joint", "limit", Need::OPTIONAL, false},
    ElementRule{"joint", "dynamics", Need::OPTIONAL, false},
    ElementRule{"joint", "mimic", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "link1", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "link2", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "origin1", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "origin2", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "parent", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "child", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "origin", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "child_origin", Need::OPTIONAL, false},
    ElementRule{"loop_joint", "axis", Need::OPTIONAL, false},
};

bool same(const char* a, const char* b)
{
  return std::strcmp(a, b) == 0;
}

std::string tag(const XMLElement& element)
{
  return std::string("<") + element.Name() + ">";
}

const char* describe(Range range)
{
  switch (range)
  {
    case Range::ANY:
      return "";
    case Range::NOT_NEGATIVE:
      return " >= 0";
    case Range::POSITIVE:
      return " > 0";
    case Range::NOT_ZERO:
      return ", none zero";
  }
  return "";
}

bool inRange(double value, Range range)
{
  switch (range)
  {
    case Range::ANY:
      return true;
    case Range::NOT_NEGATIVE:
      return value >= 0.0;
    case Range::POSITIVE:
      return value > 0.0;
    case Range::NOT_ZERO:
      return value != 0.0;
  }
  return true;
}

std::vector<std::string> splitWords(const std::string& text)
{
  static const char* const BLANKS = " \t\r\n";
  std::vector<std::string> words;
  size_t begin = text.find_first_not_of(BLANKS);
  while (begin != std::string::npos)
  {
    const size_t end = text.find_first_of(BLANKS, begin);
    words.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    begin = text.find_first_not_of(BLANKS, end);
  }
  return words;
}

/** Checks the numbers of an attribute and rewrites them separated by one blank: urdfdom knows no other separator. */
void checkNumbers(XMLElement& element, const AttributeRule& rule, const std::string& source)
{
  const std::string text = element.Attribute(rule.name);
  const std::vector<std::string> words = splitWords(text);
  std::string normalised;
  bool good = static_cast<int>(words.size()) == rule.numbers;
  for (const std::string& word : words)
  {
    double value = 0.0;
    good = good && parseNumber(word, value) && inRange(value, rule.range);
    normalised += (normalised.empty() ? "" : " ") + word.substr(word[0] == '+' ? 1 : 0);
  }
  if (!good)
  {
    const std::string count = rule.numbers == 1 ? "a finite number" : std::to_string(rule.numbers) + " finite numbers";
    failAt(source, element.GetLineNum(),
           describeOwner(element) + ": " + tag(element) + " " + rule.name + " = '" + text + "', expected " + count +
               describe(rule.range));
  }
  element.SetAttribute(rule.name, normalised.c_str());
}

void checkAttributes(XMLElement& element, const std::string& source, OmissionTally& omissions)
{
  for (const AttributeRule& rule : ATTRIBUTES)
  {
    if (!same(rule.element, element.Name()))
      continue;
    const char* text = element.Attribute(rule.name);
    if (rule.need == Need::REQUIRED && (text == nullptr || *text == '\0'))
    {
      failAt(source, element.GetLineNum(),
             describeOwner(element) + ": " + tag(element) + " has no attribute '" + rule.name + "'");
    }
    if (text != nullptr && rule.numbers > 0)
      checkNumbers(element, rule, source);
  }
  for (const tinyxml2::XMLAttribute* attribute = element.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next())
  {
    const bool known = std::any_of(ATTRIBUTES.begin(), ATTRIBUTES.end(),
                                   [&](const AttributeRule& rule) {
                                     return same(rule.element, element.Name()) && same(rule.name, attribute->Name());
                                   });
    if (!known && std::strncmp(attribute->Name(), "xmlns", 5) != 0)
      omissions.add("attribute '" + std::string(attribute->Name()) + "' of " + tag(element), describeOwner(element));
  }
}

const ElementRule* findRule(const XMLElement& parent, const XMLElement& child)
{
  const auto rule = std::find_if(ELEMENTS.begin(), ELEMENTS.end(),
                                 [&](const ElementRule& candidate) {
                                   return same(candidate.parent, parent.Name()) && same(candidate.name, child.Name());
                                 });
  return rule == ELEMENTS.end() ? nullptr : &*rule;
}

void checkRequiredChildren(const XMLElement& element, const std::string& source)
{
  for (const ElementRule& rule : ELEMENTS)
  {
    if (rule.need == Need::REQUIRED && same(rule.parent, element.Name()) &&
        element.FirstChildElement(rule.name) == nullptr)
    {
      failAt(source, element.GetLineNum(),
             describeOwner(element) + ": " + tag(element) + " has no <" + rule.name + ">");
    }
  }
}

/** Depth is bounded by the schema (robot/link/collision/geometry/mesh), so the recursion is too. */
void applyToElement(XMLElement& element, const std::string& source, OmissionTally& omissions)
{
  checkAttributes(element, source, omissions);
  XMLElement* next = nullptr;
  for (XMLElement* child = element.FirstChildElement(); child != nullptr; child = next)
  {
    next = child->NextSiblingElement();
    if (std::strncmp(child->Name(), "xacro:", 6) == 0)
    {
      failAt(source, child->GetLineNum(),
             tag(*child) + " is a xacro element: expected a plain URDF, run the file through xacro first");
    }
    const bool drawn_only = same(child->Name(), "visual") || same(child->Name(), "material");
    const ElementRule* rule = findRule(element, *child);
    const bool first = element.FirstChildElement(child->Name()) == child;
    if (rule != nullptr && same(element.Name(), "geometry") && element.FirstChildElement() != child)
    {
      // urdfdom takes the first; what cannot be read was removed before
      omissions.add("a second shape " + tag(*child) + " in " + tag(element), describeOwner(element));
      element.DeleteChild(child);
      continue;
    }
    if (rule != nullptr && (first || rule->repeated))
    {
      if (!same(child->Name(), "gazebo"))
        applyToElement(*child, source, omissions);
      continue;
    }
    if (rule != nullptr)
      omissions.add("a second " + tag(*child) + " in " + tag(element), describeOwner(element));
    else if (!drawn_only)
      omissions.add(tag(*child) + " in " + tag(element), describeOwner(*child));
    element.DeleteChild(child);
  }
  checkRequiredChildren(element, source);
}
}  // namespace

void OmissionTally::add(const std::string& what, const std::string& where)
{
  addNote(what + " is not used", where);
}

void OmissionTally::addNote(const std::string& what, const std::string& where)
{
  for (Entry& entry : entries_)
  {
    if (entry.what == what)
    {
      ++entry.count;
      return;
    }
  }
  entries_.push_back({what, where, 1});
}

std::vector<std::string> OmissionTally::lines() const
{
  std::vector<std::string> lines;
  for (const Entry& entry : entries_)
  {
    const std::string count = entry.count == 1 ? "" : std::to_string(entry.count) + " times, first ";
    lines.push_back(entry.what + " (" + count + "at " + entry.first + ")");
  }
  return lines;
}

std::string describeOwner(const XMLElement& element)
{
  for (const XMLElement* e = &element; e != nullptr; e = e->Parent() == nullptr ? nullptr : e->Parent()->ToElement())
  {
    if (same(e->Name(), "link") || same(e->Name(), "joint") || same(e->Name(), "loop_joint"))
    {
      const char* name = e->Attribute("name");
      return std::string(e->Name()) + " '" + (name == nullptr ? "" : name) + "'";
    }
  }
  const char* name = element.Attribute("name");
  return tag(element) + (name == nullptr ? "" : " '" + std::string(name) + "'");
}

bool parseNumber(const std::string& text, double& value)
{
  const char* begin = text.data() + (!text.empty() && text[0] == '+' ? 1 : 0);
  const char* end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(begin, end, value);
  return result.ec == std::errc() && result.ptr == end && std::isfinite(value);
}

double largestMagnitude(const std::string& numbers)
{
  double largest = 0.0;
  for (const std::string& word : splitWords(numbers))
  {
    double value = 0.0;
    largest = parseNumber(word, value) ? std::max(largest, std::abs(value)) : largest;
  }
  return largest;
}

void applySchema(XMLElement& robot, const std::string& source, OmissionTally& omissions)
{
  applyToElement(robot, source, omissions);
}

}  // namespace frictional_contact_sim
