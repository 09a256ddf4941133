#include "frictional_contact_sim/ros/command_listener.h"

#include <ros/console.h>
#include <std_msgs/Float64MultiArray.h>

namespace frictional_contact_sim
{
namespace
{
constexpr double LINE_PERIOD = 1.0;  // of the same line: commands may come a thousand times a second [s]
constexpr size_t MOST_LINES = 10;  // different ones within that time
constexpr std::uint32_t QUEUE = 10;

}  // namespace

CommandListener::CommandListener(ros::NodeHandle& private_node, Simulator& simulator, const NameTable& names,
                                 const std::map<std::string, ServoGains>& servo_gains)
  : simulator_(simulator), names_(names), servo_gains_(servo_gains), lines_(LINE_PERIOD, MOST_LINES)
{
  using Mode = JointCommand::Mode;
  subscribe(private_node, "command/effort", Mode::EFFORT, &sensor_msgs::JointState::effort, "effort");
  subscribe(private_node, "command/position", Mode::POSITION, &sensor_msgs::JointState::position, "position");
}

void CommandListener::subscribe(ros::NodeHandle& private_node, const std::string& topic, JointCommand::Mode mode,
                                std::vector<double> sensor_msgs::JointState::*field, const std::string& field_name)
{
  subscribers_.push_back(private_node.subscribe<sensor_msgs::JointState>(
      topic, QUEUE,
      [this, topic, mode, field, field_name](const sensor_msgs::JointState::ConstPtr& message)
      { command(topic, mode, [&] { return namedTargets(names_, message->name, (*message).*field, field_name); }); }));
  const std::string array_topic = topic + "_array";
  subscribers_.push_back(private_node.subscribe<std_msgs::Float64MultiArray>(
      array_topic, QUEUE,
      [this, array_topic, mode](const std_msgs::Float64MultiArray::ConstPtr& message)
      { command(array_topic, mode, [&] { return orderedTargets(names_, message->data); }); }));
}

/** @brief All of a message or nothing of it. */
void CommandListener::command(const std::string& topic, JointCommand::Mode mode,
                              const std::function<JointTargets()>& read)
{
  try
  {
    for (const auto& [index, target] : read())
      give(topic, mode, index, target);
  }
  catch (const std::exception& error)
  {
    warn("~" + topic + ": command ignored: " + error.what());
  }
}

void CommandListener::give(const std::string& topic, JointCommand::Mode mode, int index, double target)
{
  const JointHandle& handle = names_.joints[index];
  const Joint& joint = simulator_.model(handle.body).joints[handle.joint];
  const double position = simulator_.position(handle.body)[handle.q_index];
  if (const std::optional<std::string> line = clampTarget(joint, handle.name, mode, position, target))
    warn("~" + topic + ": " + *line);
  simulator_.setCommand(
      handle.body, handle.joint,
      mode == JointCommand::Mode::EFFORT ? effortCommand(target) : positionCommand(target, handle.name, servo_gains_));
}

void CommandListener::warn(const std::string& line)
{
  if (lines_.pass(line, ros::WallTime::now().toSec()))
    ROS_WARN_STREAM(line);
}

}  // namespace frictional_contact_sim
