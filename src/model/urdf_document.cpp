#include "urdf_document.h"

#include <tinyxml2.h>

#include <cstring>
#include <sstream>

#include "frictional_contact_sim/math/roll_pitch_yaw.h"
#include "frictional_contact_sim/model/model_error.h"
#include "urdf_schema.h"

namespace frictional_contact_sim
{
namespace
{
using tinyxml2::XMLElement;

/// Shorter axes have no direction to speak of [-].
constexpr double LEAST_AXIS = 1e-9;

/** Calls visit for each child element of that name. */
template <typename Visitor>
void forEachChild(XMLElement& parent, const char* name, const Visitor& visit)
{
  for (XMLElement* child = parent.FirstChildElement(name); child != nullptr; child = child->NextSiblingElement(name))
    visit(*child);
}

double numberAttribute(const XMLElement& element, const char* name, double fallback)
{
  const char* text = element.Attribute(name);
  double value = fallback;
  if (text != nullptr)
    parseNumber(text, value);  // the schema has checked it
  return value;
}

std::map<std::string, XMLElement*> collectNames(XMLElement& robot, const char* kind, const std::string& source)
{
  std::map<std::string, XMLElement*> found;
  forEachChild(robot, kind,
               [&](XMLElement& element)
               {
                 const auto [place, inserted] = found.emplace(element.Attribute("name"), &element);
                 if (!inserted)
                   failAt(source, element.GetLineNum(),
                          std::string("a second <") + kind + "> is named '" + place->first +
                              "', the first is at line " + std::to_string(place->second->GetLineNum()));
               });
  return found;
}

using Names = std::map<std::string, XMLElement*>;

/** Each link but one has one parent, and all hang on that one. */
void checkTree(const Names& links, const Names& joints, const std::string& source)
{
  std::map<std::string, const XMLElement*> parent_joint;
  std::multimap<std::string, std::string> children;
  for (const auto& [name, joint] : joints)
  {
    const std::string parent = joint->FirstChildElement("parent")->Attribute("link");
    const std::string child = joint->FirstChildElement("child")->Attribute("link");
    for (const std::string& link : {parent, child})
      if (links.count(link) == 0)
        failAt(source, joint->GetLineNum(), "joint '" + name + "': there is no link '" + link + "'");
    const auto [place, inserted] = parent_joint.emplace(child, joint);
    if (!inserted)
    {
      failAt(source, joint->GetLineNum(),
             "link '" + child + "' is the child of two joints, '" + place->second->Attribute("name") + "' and '" +
                 name + "': expected a tree");
    }
    children.emplace(parent, child);
  }
  std::vector<std::string> reached;
  for (const auto& [name, link] : links)
  {
    if (parent_joint.count(name) == 0)
    {
      if (!reached.empty())
      {
        failAt(source, link->GetLineNum(),
               "two root links, '" + reached[0] + "' and '" + name + "': expected one, all others hanging on it");
      }
      reached.push_back(name);
    }
  }
  for (size_t i = 0; i < reached.size(); ++i)
  {
    const auto [begin, end] = children.equal_range(reached[i]);
    for (auto child = begin; child != end; ++child)
      reached.push_back(child->second);
  }
  const std::set<std::string> connected(reached.begin(), reached.end());
  for (const auto& [name, link] : links)
    if (connected.count(name) == 0)
      failAt(source, link->GetLineNum(), "link '" + name + "' is part of a cycle of joints: expected a tree");
}

bool isType(const XMLElement& joint, std::initializer_list<const char*> types)
{
  for (const char* type : types)
    if (std::strcmp(joint.Attribute("type"), type) == 0)
      return true;
  return false;
}

void checkLimit(XMLElement& joint, const std::string& label, const std::string& source, OmissionTally& omissions)
{
  const XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr)
  {
    if (isType(joint, {"revolute", "prismatic"}))
    {
      failAt(source, joint.GetLineNum(),
             label + " is " + joint.Attribute("type") + " and has no <limit>: expected lower, upper, effort, velocity");
    }
    return;
  }
  const double lower = numberAttribute(*limit, "lower", 0.0);
  const double upper = numberAttribute(*limit, "upper", 0.0);
  if (isType(joint, {"revolute", "prismatic"}) && lower > upper)
  {
    failAt(source, limit->GetLineNum(),
           label + ": <limit> lower = " + limit->Attribute("lower") + " is above upper = " +
               (limit->Attribute("upper") == nullptr ? "0 (the default)" : limit->Attribute("upper")));
  }
  if (isType(joint, {"revolute", "prismatic"}) && lower == upper)
    omissions.addNote("<limit> with lower = upper: the joint cannot move", label);
  if (isType(joint, {"continuous"}) && (lower != 0.0 || upper != 0.0))
    omissions.add("lower and upper of <limit> in a continuous joint", label);
  if (isType(joint, {"planar", "floating"}))
    omissions.add(std::string("<limit> in a ") + joint.Attribute("type") + " joint", label);
}

/** What a mimic follows must exist and move; a follower must not follow itself, not even through others. */
void checkMimic(const XMLElement& joint, const Names& joints, const std::string& label, const std::string& source)
{
  const XMLElement* follower = &joint;
  std::string way;
  std::set<const XMLElement*> passed;
  while (passed.insert(follower).second)
  {
    const XMLElement* mimic = follower->FirstChildElement("mimic");
    if (mimic == nullptr)
      return;
    const auto leader = joints.find(mimic->Attribute("joint"));
    if (leader == joints.end() || !isType(*leader->second, {"revolute", "continuous", "prismatic"}) ||
        !isType(joint, {"revolute", "continuous", "prismatic"}))
    {
      failAt(source, mimic->GetLineNum(),
             label + ": <mimic> joint = '" + mimic->Attribute("joint") + "', expected that both are joints of one " +
                 "coordinate (revolute, continuous, prismatic)");
    }
    follower = leader->second;
    way += (way.empty() ? "'" : " - '") + leader->first + "'";
  }
  failAt(source, joint.GetLineNum(), label + ": <mimic> follows itself: " + way);
}

void checkJoint(XMLElement& joint, const Names& joints, const std::string& source, OmissionTally& omissions)
{
  const std::string label = std::string("joint '") + joint.Attribute("name") + "'";
  if (!isType(joint, {"revolute", "continuous", "prismatic", "planar", "floating", "fixed"}))
  {
    failAt(source, joint.GetLineNum(),
           label + ": type = '" + joint.Attribute("type") +
               "', expected revolute, continuous, prismatic, planar, floating or fixed");
  }
  if (isType(joint, {"fixed"}))
  {
    // Nothing moves: what else is said about it (limits, an axis of zero) is without effect, and urdfdom need not see
    // it.
    for (const char* name : {"axis", "limit", "dynamics", "mimic"})
      while (XMLElement* element = joint.FirstChildElement(name))
        joint.DeleteChild(element);
    return;
  }
  checkLimit(joint, label, source, omissions);
  checkMimic(joint, joints, label, source);
  const XMLElement* axis = joint.FirstChildElement("axis");
  if (axis != nullptr && largestMagnitude(axis->Attribute("xyz")) < LEAST_AXIS && !isType(joint, {"floating"}))
    failAt(source, axis->GetLineNum(), label + ": <axis> xyz = '" + axis->Attribute("xyz") + "', expected a direction");
  XMLElement* dynamics = joint.FirstChildElement("dynamics");
  if (dynamics != nullptr && dynamics->Attribute("damping") == nullptr && dynamics->Attribute("friction") == nullptr)
    joint.DeleteChild(dynamics);  // urdfdom takes an empty one for an error
}

/** Notes capsules and writes them as cylinders; leaves out collisions without a shape that is known. */
void readCollisions(XMLElement& link, const std::string& name, UrdfDocument& document, OmissionTally& omissions)
{
  int place = 0;
  XMLElement* next = nullptr;
  for (XMLElement* collision = link.FirstChildElement("collision"); collision != nullptr; collision = next)
  {
    next = collision->NextSiblingElement("collision");
    XMLElement* shape = collision->FirstChildElement("geometry")->FirstChildElement();
    if (shape == nullptr)
    {
      omissions.add("<collision> without a shape that is known", "link '" + name + "'");
      link.DeleteChild(collision);
      continue;
    }
    if (std::strcmp(shape->Name(), "capsule") == 0)
    {
      document.capsules.emplace(name, place);
      shape->SetName("cylinder");
    }
    ++place;
  }
}

/** Gazebo writes <mu1>0.8</mu1> or <mu1 value="0.8"/>. */
double readFriction(const XMLElement& element, const std::string& source)
{
  const char* attribute = element.Attribute("value");
  const char* text = attribute != nullptr ? attribute : element.GetText();
  std::string word = text == nullptr ? "" : text;
  word.erase(0, word.find_first_not_of(" \t\r\n"));
  word.erase(word.find_last_not_of(" \t\r\n") + 1);
  double value = 0.0;
  if (!parseNumber(word, value) || value < 0.0)
  {
    failAt(source, element.GetLineNum(),
           std::string("<gazebo> <") + element.Name() + "> = '" + word + "', expected a finite number >= 0");
  }
  return value;
}

void readGazebo(XMLElement& gazebo, const Names& links, const Names& joints, const std::string& source,
                UrdfDocument& document, OmissionTally& omissions)
{
  const char* attribute = gazebo.Attribute("reference");
  const std::string reference = attribute == nullptr ? "" : attribute;
  const std::string label = reference.empty() ? "the robot" : "'" + reference + "'";
  const XMLElement* mu1 = gazebo.FirstChildElement("mu1");
  const XMLElement* mu2 = gazebo.FirstChildElement("mu2");
  if (!reference.empty() && links.count(reference) == 0 && joints.count(reference) == 0)
  {
    document.warnings.push_back("<gazebo> reference = " + label + " names no link or joint");
  }
  else if (links.count(reference) > 0 && (mu1 != nullptr || mu2 != nullptr))
  {
    const double first = mu1 == nullptr ? -1.0 : readFriction(*mu1, source);
    const double second = mu2 == nullptr ? first : readFriction(*mu2, source);
    if (first == second)
    {
      document.friction[reference] = first;
    }
    else
    {
      document.warnings.push_back("link " + label + ": Gazebo's mu1 and mu2 are not equal, neither is used (friction " +
                                  "is isotropic here): the material of the scenario decides");
    }
  }
  for (XMLElement* child = gazebo.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
  {
    const std::string kind = child->Name();
    const bool friction = links.count(reference) > 0 && (kind == "mu1" || kind == "mu2");
    if (!friction)
      omissions.add("<" + kind + "> in <gazebo>", label);
  }
}

/** Numbers that the schema has checked. */
Eigen::Vector3d vectorAttribute(const XMLElement& element, const char* name)
{
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  const char* text = element.Attribute(name);
  if (text == nullptr)
    return vector;
  std::istringstream words(text);
  for (double& number : vector)
  {
    std::string word;
    words >> word;
    parseNumber(word, number);
  }
  return vector;
}

Eigen::Isometry3d readOrigin(const XMLElement& element)
{
  return Eigen::Translation3d(vectorAttribute(element, "xyz")) * fromRollPitchYaw(vectorAttribute(element, "rpy"));
}

/** The child of a loop_joint by its name or, as in a <joint>, by the other one; nullptr where there is neither. */
const XMLElement* eitherOf(const XMLElement& element, const char* name, const char* other)
{
  const XMLElement* child = element.FirstChildElement(name);
  return child != nullptr ? child : element.FirstChildElement(other);
}

LoopElement readLoop(const XMLElement& element, const Names& links, const std::string& source)
{
  LoopElement loop;
  loop.name = element.Attribute("name");
  loop.line = element.GetLineNum();
  const std::string label = "loop_joint '" + loop.name + "'";
  const std::string type = element.Attribute("type");
  bool is_known = false;
  for (const LoopType known : {LoopType::POINT, LoopType::AXIS, LoopType::WELD})
    if (type == toString(known))
    {
      loop.type = known;
      is_known = true;
    }
  if (!is_known)
    failAt(source, loop.line, label + ": type = '" + type + "', expected point, axis or weld");
  const XMLElement* parent = eitherOf(element, "link1", "parent");
  const XMLElement* child = eitherOf(element, "link2", "child");
  if (parent == nullptr || child == nullptr)
    failAt(source, loop.line,
           label + ": no <" + (parent == nullptr ? "link1" : "link2") + ">, expected both links: <link1 link='...'/>");
  loop.parent = parent->Attribute("link");
  loop.child = child->Attribute("link");
  for (const std::string& link : {loop.parent, loop.child})
    if (links.count(link) == 0)
      failAt(source, loop.line, label + ": there is no link '" + link + "'");
  if (const XMLElement* origin = eitherOf(element, "origin1", "origin"))
    loop.origin = readOrigin(*origin);
  if (const XMLElement* origin = eitherOf(element, "origin2", "child_origin"))
    loop.child_origin = readOrigin(*origin);
  const XMLElement* axis = element.FirstChildElement("axis");
  if (axis != nullptr && loop.type != LoopType::AXIS)
    failAt(source, axis->GetLineNum(), label + ": <axis> in a " + type + ", expected it in type = 'axis' only");
  if (axis != nullptr && largestMagnitude(axis->Attribute("xyz")) < LEAST_AXIS)
    failAt(source, axis->GetLineNum(), label + ": <axis> xyz = '" + axis->Attribute("xyz") + "', expected a direction");
  if (axis != nullptr)
    loop.axis = vectorAttribute(*axis, "xyz").stableNormalized();
  return loop;
}

XMLElement& parseXml(const std::string& xml, const std::string& source, tinyxml2::XMLDocument& parsed)
{
  if (parsed.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS)
    failAt(source, parsed.ErrorLineNum(), std::string("broken XML (") + parsed.ErrorName() + "), expected a URDF");
  XMLElement* robot = parsed.RootElement();
  if (robot == nullptr || std::strcmp(robot->Name(), "robot") != 0)
  {
    failAt(source, robot == nullptr ? 0 : robot->GetLineNum(),
           "the root element is " + (robot == nullptr ? "missing" : "<" + std::string(robot->Name()) + ">") +
               ", expected <robot>");
  }
  return *robot;
}
}  // namespace

UrdfDocument readDocument(const std::string& xml, const std::string& source)
{
  tinyxml2::XMLDocument parsed;
  XMLElement& robot = parseXml(xml, source, parsed);
  OmissionTally omissions;
  applySchema(robot, source, omissions);
  robot.DeleteAttribute("version");  // urdfdom refuses "1"

  const Names links = collectNames(robot, "link", source);
  const Names joints = collectNames(robot, "joint", source);
  checkTree(links, joints, source);

  UrdfDocument document;
  forEachChild(robot, "joint",
               [&](XMLElement& joint)
               {
                 checkJoint(joint, joints, source, omissions);
                 document.joint_order.emplace(joint.Attribute("name"), static_cast<int>(document.joint_order.size()));
               });
  for (const auto& [name, link] : links)
    readCollisions(*link, name, document, omissions);
  while (XMLElement* gazebo = robot.FirstChildElement("gazebo"))
  {
    readGazebo(*gazebo, links, joints, source, document, omissions);
    robot.DeleteChild(gazebo);
  }
  collectNames(robot, "loop_joint", source);  // no two of one name
  while (XMLElement* loop = robot.FirstChildElement("loop_joint"))
  {
    document.loops.push_back(readLoop(*loop, links, source));
    robot.DeleteChild(loop);
  }
  const std::vector<std::string> lines = omissions.lines();
  document.warnings.insert(document.warnings.end(), lines.begin(), lines.end());

  tinyxml2::XMLPrinter printer(nullptr, true);
  parsed.Print(&printer);
  document.text = printer.CStr();
  return document;
}

}  // namespace frictional_contact_sim
