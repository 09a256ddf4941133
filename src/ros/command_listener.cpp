#include "frictional_contact_sim/ros/command_listener.h"

#include <ros/console.h>
#include <std_msgs/Float64MultiArray.h>

#include "frictional_contact_sim/ros/conversions.h"

namespace frictional_contact_sim
{
namespace
{
using Mode = JointCommand::Mode;

constexpr double LINE_PERIOD = 1.0;  // of the same line: commands may come a thousand times a second [s]
constexpr size_t MOST_LINES = 10;  // different ones within that time
constexpr std::uint32_t QUEUE = 1000;  // a second of commands for each step may come at once
constexpr size_t MOST_PENDING = 10000;  // commands for later: ten seconds of one each step
constexpr double FARTHEST_STAMP = 3600.0;  // ahead of simulated time; wall clock would be for ever [s]

}  // namespace

CommandListener::CommandListener(ros::NodeHandle& private_node, Simulator& simulator, const NameTable& names,
                                 const std::map<std::string, ServoGains>& servo_gains)
  : simulator_(simulator), names_(names), servo_gains_(servo_gains), lines_(LINE_PERIOD, MOST_LINES)
{
  subscribe(private_node, "command/effort", Mode::EFFORT);
  subscribe(private_node, "command/velocity", Mode::VELOCITY);
  subscribe(private_node, "command/position", Mode::POSITION);
}

void CommandListener::subscribe(ros::NodeHandle& private_node, const std::string& topic, Mode mode)
{
  subscribers_.push_back(private_node.subscribe<sensor_msgs::JointState>(
      topic, QUEUE,
      [this, topic, mode](const sensor_msgs::JointState::ConstPtr& message)
      { receive(topic, mode, message->header.stamp, [&] { return namedTargets(names_, mode, *message); }); }));
  const std::string array_topic = topic + "_array";
  subscribers_.push_back(private_node.subscribe<std_msgs::Float64MultiArray>(
      array_topic, QUEUE,
      [this, array_topic, mode](const std_msgs::Float64MultiArray::ConstPtr& message)
      { receive(array_topic, mode, ros::Time(), [&] { return orderedTargets(names_, message->data); }); }));
}

/** @brief All of a message or nothing of it. */
void CommandListener::receive(const std::string& topic, Mode mode, const ros::Time& stamp,
                              const std::function<std::vector<JointTarget>()>& read)
{
  try
  {
    const Command command{topic, mode, read()};
    if (stamp > toStamp(simulator_.time()))
      keep(stamp, command);
    else
      give(command);
  }
  catch (const std::exception& error)
  {
    warn("~" + topic + ": command ignored: " + error.what());
  }
}

void CommandListener::keep(const ros::Time& stamp, const Command& command)
{
  if ((stamp - toStamp(simulator_.time())).toSec() > FARTHEST_STAMP)
    throw CommandError(
        "header.stamp is more than an hour ahead of simulated time, expected simulated time (is "
        "/use_sim_time set?) or zero");
  if (pending_.size() >= MOST_PENDING)
    throw CommandError(std::to_string(MOST_PENDING) + " commands wait for their header.stamp already");
  pending_.emplace(stamp, command);
}

void CommandListener::giveDue()
{
  if (pending_.empty())
    return;
  const ros::Time now = toStamp(simulator_.time());
  while (!pending_.empty() && pending_.begin()->first <= now)
  {
    give(pending_.begin()->second);
    pending_.erase(pending_.begin());
  }
}

/** A joint has one warning of each kind: who commands beyond its limits does so at every step. */
void CommandListener::give(const Command& command)
{
  for (const JointTarget& target : command.targets)
    for (const ClampedTarget& clamped : giveTarget(target, command.mode, names_, servo_gains_, simulator_))
      if (clamped_.emplace(names_.joints[target.index].name, clamped.quantity).second)
        ROS_WARN_STREAM("~" << command.topic << ": " << clamped.line << "; further ones of this joint are not shown");
}

void CommandListener::warn(const std::string& line)
{
  if (lines_.pass(line, ros::WallTime::now().toSec()))
    ROS_WARN_STREAM(line);
}

void CommandListener::renumberJoints(const std::vector<int>& new_index)
{
  for (auto& [stamp, command] : pending_)
  {
    std::vector<JointTarget> kept;
    for (JointTarget target : command.targets)
    {
      target.index = new_index[static_cast<size_t>(target.index)];
      if (target.index >= 0)
        kept.push_back(target);
    }
    command.targets = kept;
  }
}

}  // namespace frictional_contact_sim
