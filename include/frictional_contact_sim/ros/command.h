#pragma once
/**
 * @file command.h
 * @brief Command messages to joint commands: pure functions that take a message as a whole or not at all.
 */
#include <sensor_msgs/JointState.h>

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/ros/parameters.h"

namespace frictional_contact_sim
{
/** @brief One line: why a command was not taken. */
class CommandError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/** @brief What a message wants of one joint. */
struct JointTarget
{
  int index = 0;  ///< into NameTable::joints
  double target = 0.0;  ///< of the message's mode [rad], [rad/s], [N m]; [m], [m/s], [N]
  double rate = 0.0;  ///< beside a position [rad/s] or [m/s]
  double feedforward = 0.0;  ///< beside a position or velocity [N m] or [N]
};

/** @return indices into NameTable::joints. @throws CommandError unknown or mimic joint, joint named twice */
std::vector<int> findJoints(const NameTable& names, const std::vector<std::string>& joints);

/**
 * @brief sensor_msgs/JointState's form: names, the numbers of `mode`, and those of the fields that stand beside them
 * (velocity and effort of a position command, effort of a velocity command), all of them or none.
 * @throws CommandError as findJoints; wrong length, number that is not finite
 */
std::vector<JointTarget> namedTargets(const NameTable& names, JointCommand::Mode mode,
                                      const sensor_msgs::JointState& message);
/**
 * @brief std_msgs/Float64MultiArray's form: one value for each actuated joint, in the order of joint_states.
 * @throws CommandError wrong length, number that is not finite
 */
std::vector<JointTarget> orderedTargets(const NameTable& names, const std::vector<double>& values);

/**
 * @brief Takes a target into what its joint can do: a position as reachableTarget, a velocity as reachableSpeed, an
 * effort within the URDF's limit and MAX_EFFORT.
 * @param position of the joint [rad] or [m]
 * @return one line when the target was changed
 */
std::optional<std::string> clampTarget(const Joint& joint, const std::string& name, JointCommand::Mode mode,
                                       double position, double& target);

/** @brief The servo of a joint: its own gains, else those of `default`, else defaults from its inertia. */
JointCommand positionCommand(double target, const std::string& joint, const std::map<std::string, ServoGains>& gains);
/** @brief The same for a velocity. */
JointCommand velocityCommand(double target, const std::string& joint, const std::map<std::string, ServoGains>& gains);
/** @brief An effort: the servo's limit does not concern it, only the URDF's does. */
JointCommand effortCommand(double target);

/** @brief What clampTarget said of one number of a target. */
struct ClampedTarget
{
  JointCommand::Mode quantity;
  std::string line;
};

/** @brief Takes all numbers of a target into what its joint can do and gives the command to the simulator.
 *  @return what was changed */
std::vector<ClampedTarget> giveTarget(JointTarget target, JointCommand::Mode mode, const NameTable& names,
                                      const std::map<std::string, ServoGains>& gains, Simulator& simulator);

}  // namespace frictional_contact_sim
