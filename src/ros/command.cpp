#include "frictional_contact_sim/ros/command.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace frictional_contact_sim
{
namespace
{
using Mode = JointCommand::Mode;

void requireFinite(double value, const std::string& joint, const std::string& field)
{
  if (!std::isfinite(value))
    throw CommandError("joint '" + joint + "': found " + std::to_string(value) + " in '" + field +
                       "', expected a finite number");
}

/** @brief One number for each name, or none at all where the field is optional. */
const std::vector<double>& readField(const sensor_msgs::JointState& message, const std::vector<double>& values,
                                     const std::string& field, bool optional)
{
  if (values.size() != message.name.size() && !(optional && values.empty()))
  {
    throw CommandError("found " + std::to_string(message.name.size()) + " names and " + std::to_string(values.size()) +
                       " numbers in '" + field + "', expected one for each name" + (optional ? ", or none" : ""));
  }
  for (size_t i = 0; i < values.size(); ++i)
    requireFinite(values[i], message.name[i], field);
  return values;
}

const ServoGains* findGains(const std::string& joint, const std::map<std::string, ServoGains>& gains)
{
  auto found = gains.find(joint);
  if (found == gains.end())
    found = gains.find("default");
  return found == gains.end() ? nullptr : &found->second;
}

}  // namespace

std::vector<int> findJoints(const NameTable& names, const std::vector<std::string>& joints)
{
  std::vector<int> indices;
  for (const std::string& name : joints)
  {
    const int joint = findJoint(names, name);
    if (joint < 0)
      throw CommandError("unknown joint '" + name + "'");
    if (names.joints[joint].mimic)
      throw CommandError("joint '" + name + "' follows another one and takes no command");
    if (std::find(indices.begin(), indices.end(), joint) != indices.end())
      throw CommandError("joint '" + name + "' is named twice");
    indices.push_back(joint);
  }
  return indices;
}

std::vector<JointTarget> namedTargets(const NameTable& names, Mode mode, const sensor_msgs::JointState& message)
{
  const std::vector<double> none;
  const bool position = mode == Mode::POSITION;
  const std::vector<double>& targets = position ? readField(message, message.position, "position", false)
                                       : mode == Mode::VELOCITY
                                           ? readField(message, message.velocity, "velocity", false)
                                           : readField(message, message.effort, "effort", false);
  const std::vector<double>& rates = position ? readField(message, message.velocity, "velocity", true) : none;
  const std::vector<double>& feedforward =
      mode == Mode::EFFORT ? none : readField(message, message.effort, "effort", true);
  const std::vector<int> indices = findJoints(names, message.name);
  std::vector<JointTarget> read(indices.size());
  for (size_t i = 0; i < indices.size(); ++i)
    read[i] = {indices[i], targets[i], rates.empty() ? 0.0 : rates[i], feedforward.empty() ? 0.0 : feedforward[i]};
  return read;
}

std::vector<JointTarget> orderedTargets(const NameTable& names, const std::vector<double>& values)
{
  if (values.size() != names.actuated.size())
  {
    throw CommandError("found " + std::to_string(values.size()) + " numbers, expected " +
                       std::to_string(names.actuated.size()) + ", one for each actuated joint");
  }
  std::vector<JointTarget> targets(values.size());
  for (size_t i = 0; i < values.size(); ++i)
  {
    requireFinite(values[i], names.joints[names.actuated[i]].name, "data");
    targets[i].index = names.actuated[i];
    targets[i].target = values[i];
  }
  return targets;
}

std::optional<std::string> clampTarget(const Joint& joint, const std::string& name, Mode mode, double position,
                                       double& target)
{
  const double wanted = target;
  const char* quantity = "effort";
  if (mode == Mode::POSITION)
  {
    quantity = "position";
    target = reachableTarget(joint.limit, position, target);
  }
  else if (mode == Mode::VELOCITY)
  {
    quantity = "velocity";
    target = reachableSpeed(joint.limit, target);
  }
  else
  {
    const double most = std::min(joint.limit.effort, MAX_EFFORT);
    target = std::clamp(target, -most, most);
  }
  if (target == wanted)
    return std::nullopt;
  std::ostringstream line;
  line << "joint '" << name << "': the command is " << (wanted > target ? "above the largest " : "below the smallest ")
       << quantity << " it can be given now, " << target << ", which is taken";
  return line.str();
}

JointCommand positionCommand(double target, const std::string& joint, const std::map<std::string, ServoGains>& gains)
{
  JointCommand command;
  command.mode = Mode::POSITION;
  command.target = target;
  if (const ServoGains* own = findGains(joint, gains))
  {
    command.kp = own->kp;
    command.kd = own->kd;
    command.max_effort = own->max_effort;
  }
  return command;
}

JointCommand velocityCommand(double target, const std::string& joint, const std::map<std::string, ServoGains>& gains)
{
  JointCommand command;
  command.mode = Mode::VELOCITY;
  command.target = target;
  if (const ServoGains* own = findGains(joint, gains))
  {
    command.kd = own->velocity_gain;
    command.max_effort = own->max_effort;
  }
  return command;
}

JointCommand effortCommand(double target)
{
  JointCommand command;
  command.mode = Mode::EFFORT;
  command.target = target;
  return command;
}

std::vector<ClampedTarget> giveTarget(JointTarget target, Mode mode, const NameTable& names,
                                      const std::map<std::string, ServoGains>& gains, Simulator& simulator)
{
  const JointHandle& handle = names.joints[target.index];
  const Joint& joint = simulator.model(handle.body).joints[handle.joint];
  const double position = simulator.position(handle.body)[handle.q_index];
  std::vector<ClampedTarget> changed;
  const auto clamp = [&](Mode quantity, double& value)
  {
    if (const std::optional<std::string> line = clampTarget(joint, handle.name, quantity, position, value))
      changed.push_back({quantity, *line});
  };
  clamp(mode, target.target);
  clamp(Mode::VELOCITY, target.rate);
  clamp(Mode::EFFORT, target.feedforward);
  JointCommand command = mode == Mode::EFFORT     ? effortCommand(target.target)
                         : mode == Mode::VELOCITY ? velocityCommand(target.target, handle.name, gains)
                                                  : positionCommand(target.target, handle.name, gains);
  command.rate = target.rate;
  command.feedforward = target.feedforward;
  simulator.setCommand(handle.body, handle.joint, command);
  return changed;
}

}  // namespace frictional_contact_sim
