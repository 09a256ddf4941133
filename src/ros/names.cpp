#include "frictional_contact_sim/ros/names.h"

#include <cctype>
#include <map>

namespace frictional_contact_sim
{
namespace
{
std::string qualified(const std::string& body_name, const std::string& name)
{
  return body_name + "/" + name;
}

/** @brief How often each URDF name occurs, joints or links of all bodies. */
std::map<std::string, int> countNames(const Simulator& simulator, const std::string Frame::*name)
{
  std::map<std::string, int> count;
  for (int body = 0; body < simulator.bodyCount(); ++body)
    for (const Frame& frame : simulator.model(body).frames)
      ++count[frame.*name];
  return count;
}

void addJoints(const Simulator& simulator, int body, const std::map<std::string, int>& count, NameTable& table)
{
  const MultibodyModel& model = simulator.model(body);
  for (size_t i = 1; i < model.joints.size(); ++i)  // joint 0 is the base
  {
    const Joint& joint = model.joints[i];
    const std::string name = count.at(joint.name) == 1 ? joint.name : qualified(simulator.bodyName(body), joint.name);
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

NameTable makeNameTable(const Simulator& simulator)
{
  NameTable table;
  const std::map<std::string, int> joint_count = countNames(simulator, &Frame::joint);
  const std::map<std::string, int> link_count = countNames(simulator, &Frame::name);
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const MultibodyModel& model = simulator.model(body);
    table.bodies.push_back(simulator.bodyName(body));
    addJoints(simulator, body, joint_count, table);
    std::vector<std::string> frames;
    std::vector<std::string> frame_joints;
    const auto unique = [&](const std::map<std::string, int>& count, const std::string& name)
    { return name.empty() || count.at(name) == 1 ? name : qualified(simulator.bodyName(body), name); };
    for (const Frame& frame : model.frames)
    {
      frames.push_back(unique(link_count, frame.name));
      frame_joints.push_back(unique(joint_count, frame.joint));
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

}  // namespace frictional_contact_sim
