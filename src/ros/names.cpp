#include "frictional_contact_sim/ros/names.h"

#include <cctype>
#include <regex>

namespace frictional_contact_sim
{
namespace
{
std::string qualified(const std::string& body_name, const std::string& name)
{
  return body_name + "/" + name;
}

/** @brief Bare while it is the only one. */
std::string nameOf(const NameRules& rules, const std::map<std::string, int>& count, const std::string& body,
                   const std::string& name)
{
  const auto found = count.find(name);
  const bool is_unique = found != count.end() && found->second == 1;
  return is_unique && rules.prefixed.count(body) == 0 ? name : qualified(body, name);
}

void addJoints(const Simulator& simulator, int body, const NameRules& rules, NameTable& table)
{
  const MultibodyModel& model = simulator.model(body);
  for (size_t i = 1; i < model.joints.size(); ++i)  // joint 0 is the base
  {
    const Joint& joint = model.joints[i];
    if (joint.type == JointType::FIXED)  // nodes of a deformable body
      continue;
    const std::string name = nameOf(rules, rules.joints, simulator.bodyName(body), joint.name);
    if (velocitySize(joint.type) != 1)
    {
      table.unsupported_joints.push_back(name);
      continue;
    }
    const bool mimic = joint.mimic.joint >= 0;
    if (!mimic)
      table.actuated.push_back(static_cast<int>(table.joints.size()));
    table.joints.push_back({name, body, static_cast<int>(i), joint.q_index, joint.v_index, mimic});
  }
}

}  // namespace

NameRules nameRules(const Simulator& simulator, const std::set<std::string>& prefixed)
{
  NameRules rules;
  rules.prefixed = prefixed;
  if (simulator.bodyCount() > 0 && prefixed.count(simulator.bodyName(0)) == 0)
    rules.first = simulator.bodyName(0);
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    if (prefixed.count(simulator.bodyName(body)) > 0)
      continue;
    for (const Frame& frame : simulator.model(body).frames)
    {
      ++rules.joints[frame.joint];  // fixed ones too
      ++rules.links[frame.name];
    }
  }
  return rules;
}

NameTable makeNameTable(const Simulator& simulator)
{
  return makeNameTable(simulator, nameRules(simulator));
}

NameTable makeNameTable(const Simulator& simulator, const NameRules& rules)
{
  NameTable table;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const MultibodyModel& model = simulator.model(body);
    table.bodies.push_back(simulator.bodyName(body));
    addJoints(simulator, body, rules, table);
    std::vector<std::string> frames;
    std::vector<std::string> frame_joints;
    for (const Frame& frame : model.frames)
    {
      frames.push_back(nameOf(rules, rules.links, simulator.bodyName(body), frame.name));
      frame_joints.push_back(frame.joint.empty() ? ""
                                                 : nameOf(rules, rules.joints, simulator.bodyName(body), frame.joint));
    }
    const int root = model.findFrame(model.links.front().name);
    table.roots.push_back(root >= 0 ? frames[root] : model.links.front().name);
    table.frames.push_back(frames);
    table.frame_joints.push_back(frame_joints);
  }
  return table;
}

std::string topicName(const std::string& urdf_name)
{
  std::string name = urdf_name;
  for (char& letter : name)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '/')
      letter = '_';
  return name;
}

bool isTopicPart(const std::string& name)
{
  static const std::regex PART("[A-Za-z][A-Za-z0-9_]*");
  return std::regex_match(name, PART);
}

int findJoint(const NameTable& table, const std::string& name)
{
  for (size_t i = 0; i < table.joints.size(); ++i)
  {
    const JointHandle& joint = table.joints[i];
    if (joint.name == name)
      return static_cast<int>(i);
    const std::string& body_name = table.bodies[joint.body];
    const bool starts_with_body = name.size() > body_name.size() && name.compare(0, body_name.size(), body_name) == 0;
    if (starts_with_body && name[body_name.size()] == '/' &&
        name.compare(body_name.size() + 1, std::string::npos, joint.name) == 0)
      return static_cast<int>(i);
  }
  return -1;
}

std::vector<int> newJointIndices(const NameTable& before, const NameTable& now)
{
  std::vector<int> indices;
  for (const JointHandle& joint : before.joints)
    indices.push_back(findJoint(now, joint.name));
  return indices;
}

}  // namespace frictional_contact_sim
