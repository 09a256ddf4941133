#pragma once
/**
 * @file names.h
 * @brief How joints and links of a scenario are called on ROS topics: by their URDF name while it is unique among all
 * bodies of the scenario, else `body/name`. Robots of ~robots and bodies that were spawned are always `body/name`: that
 * is the tf_prefix of a robot_state_publisher of their own.
 */
#include <map>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief A joint with one coordinate: the joints of joint_states, in its order. */
struct JointHandle
{
  std::string name;  ///< on topics
  int body = 0;  ///< of the scenario
  int joint = 0;  ///< in the body's model
  int q_index = 0;
  int v_index = 0;
  bool mimic = false;
};

struct NameTable
{
  std::vector<JointHandle> joints;  ///< bodies in order, joints in the order of their models
  std::vector<int> actuated;  ///< indices into joints: those that take commands (no mimic joints)
  std::vector<std::string> bodies;  ///< by body
  std::vector<std::vector<std::string>> frames;  ///< by body and frame of its model
  /// By body and frame: name of its URDF joint, fixed ones too, unique as the others are; empty for a root.
  std::vector<std::vector<std::string>> frame_joints;
  std::vector<std::string> roots;  ///< tf name of each body's root link
  std::vector<std::string> unsupported_joints;  ///< planar and floating joints: no place in sensor_msgs/JointState
};

/** @brief What decides between `name` and `body/name`. Made at the start: names stay while bodies come and go. */
struct NameRules
{
  std::set<std::string> prefixed;  ///< bodies that are always `body/name`
  std::string first;  ///< the body whose odometry has no name in its topic; may be empty
  std::map<std::string, int> joints;  ///< how often each URDF name occurs among the other bodies
  std::map<std::string, int> links;
};

NameRules nameRules(const Simulator& simulator, const std::set<std::string>& prefixed = {});
NameTable makeNameTable(const Simulator& simulator, const NameRules& rules);
/** @brief Of the start, no body prefixed. */
NameTable makeNameTable(const Simulator& simulator);

/** @brief By joint of `before` its index now, -1 when it is gone: names stay while bodies come and go. */
std::vector<int> newJointIndices(const NameTable& before, const NameTable& now);

/** @brief A URDF name as a part of a topic: what ROS does not take there becomes `_`. */
std::string topicName(const std::string& urdf_name);
/** @brief A name that can be part of a topic's: a letter, then letters, digits and _. */
bool isTopicPart(const std::string& name);

/** @return index into table.joints, -1 when unknown; `body/joint` is always understood. */
int findJoint(const NameTable& table, const std::string& name);

}  // namespace frictional_contact_sim
