#include "frictional_contact_sim/ros/command.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace frictional_contact_sim
{
namespace
{
void requireFinite(double value, const std::string& joint)
{
  if (!std::isfinite(value))
    throw CommandError("joint '" + joint + "': found " + std::to_string(value) + ", expected a finite number");
}

}  // namespace

JointTargets namedTargets(const NameTable& names, const std::vector<std::string>& joints,
                          const std::vector<double>& values, const std::string& field)
{
  if (joints.size() != values.size())
  {
    throw CommandError("found " + std::to_string(joints.size()) + " names and " + std::to_string(values.size()) +
                       " numbers in '" + field + "', expected one for each name");
  }
  JointTargets targets;
  for (size_t i = 0; i < joints.size(); ++i)
  {
    const int joint = findJoint(names, joints[i]);
    if (joint < 0)
      throw CommandError("unknown joint '" + joints[i] + "'");
    if (names.joints[joint].mimic)
      throw CommandError("joint '" + joints[i] + "' follows another one and takes no command");
    const auto same = [joint](const std::pair<int, double>& target) { return target.first == joint; };
    if (std::any_of(targets.begin(), targets.end(), same))
      throw CommandError("joint '" + joints[i] + "' is named twice");
    requireFinite(values[i], joints[i]);
    targets.emplace_back(joint, values[i]);
  }
  return targets;
}

JointTargets orderedTargets(const NameTable& names, const std::vector<double>& values)
{
  if (values.size() != names.actuated.size())
  {
    throw CommandError("found " + std::to_string(values.size()) + " numbers, expected " +
                       std::to_string(names.actuated.size()) + ", one for each actuated joint");
  }
  JointTargets targets;
  for (size_t i = 0; i < values.size(); ++i)
  {
    requireFinite(values[i], names.joints[names.actuated[i]].name);
    targets.emplace_back(names.actuated[i], values[i]);
  }
  return targets;
}

std::optional<std::string> clampTarget(const Joint& joint, const std::string& name, JointCommand::Mode mode,
                                       double position, double& target)
{
  double lower = -std::min(joint.limit.effort, MAX_EFFORT);
  double upper = -lower;
  if (mode == JointCommand::Mode::POSITION)
  {
    // A joint beyond its limits may still be sent back to them.
    lower = std::min(std::max(joint.limit.lower, position - MAX_TRAVEL), joint.limit.upper);
    upper = std::max(std::min(joint.limit.upper, position + MAX_TRAVEL), joint.limit.lower);
  }
  if (target >= lower && target <= upper)
    return std::nullopt;
  const bool above = target > upper;
  target = above ? upper : lower;
  std::ostringstream line;
  line << "joint '" << name << "': the command is " << (above ? "above " : "below ")
       << (above ? "the largest" : "the smallest") << (mode == JointCommand::Mode::POSITION ? " position" : " effort")
       << " it can be given now, " << target << ", which is taken";
  return line.str();
}

JointCommand positionCommand(double target, const std::string& joint, const std::map<std::string, ServoGains>& gains)
{
  JointCommand command;
  command.mode = JointCommand::Mode::POSITION;
  command.target = target;
  auto found = gains.find(joint);
  if (found == gains.end())
    found = gains.find("default");
  if (found != gains.end())
  {
    command.kp = found->second.kp;
    command.kd = found->second.kd;
    command.max_effort = found->second.max_effort;
  }
  return command;
}

JointCommand effortCommand(double target)
{
  JointCommand command;
  command.mode = JointCommand::Mode::EFFORT;
  command.target = target;
  return command;
}

}  // namespace frictional_contact_sim
