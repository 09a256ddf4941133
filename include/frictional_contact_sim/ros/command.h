#pragma once
/**
 * @file command.h
 * @brief Command messages to joint commands: pure functions that take a message as a whole or not at all.
 */
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
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

constexpr double MAX_TRAVEL = 50.0;  ///< [rad] or [m]
constexpr double MAX_EFFORT = 1e9;  ///< [N m] or [N]

/** @brief Index into NameTable::joints and the target there. */
using JointTargets = std::vector<std::pair<int, double>>;

/**
 * @brief sensor_msgs/JointState's form: names and their values.
 * @throws CommandError unknown or mimic joint, joint named twice, wrong length, number that is not finite
 */
JointTargets namedTargets(const NameTable& names, const std::vector<std::string>& joints,
                          const std::vector<double>& values, const std::string& field);
/**
 * @brief std_msgs/Float64MultiArray's form: one value for each actuated joint, in the order of joint_states.
 * @throws CommandError wrong length, number that is not finite
 */
JointTargets orderedTargets(const NameTable& names, const std::vector<double>& values);

/**
 * @brief Takes a target into what its joint can do: a position within the URDF's limits and no further than
 * MAX_TRAVEL from where the joint is, an effort within the URDF's limit and MAX_EFFORT.
 * @param position of the joint [rad] or [m]
 * @return one line when the target was changed, without the target itself: the same for each such command
 */
std::optional<std::string> clampTarget(const Joint& joint, const std::string& name, JointCommand::Mode mode,
                                       double position, double& target);

/** @brief The servo of a joint: its own gains, else those of `default`, else defaults from its inertia. */
JointCommand positionCommand(double target, const std::string& joint, const std::map<std::string, ServoGains>& gains);
/** @brief An effort: the servo's limit does not concern it, only the URDF's does. */
JointCommand effortCommand(double target);

}  // namespace frictional_contact_sim
