#pragma once
/**
 * @file command_listener.h
 * @brief The topics ~command/effort, velocity, position: messages to commands of the simulator, what is wrong with them
 * to the log.
 *
 * A command holds from the next step on, or from the first step that begins at header.stamp or later.
 */
#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/command.h"
#include "frictional_contact_sim/ros/throttle.h"

namespace frictional_contact_sim
{
class CommandListener
{
public:
  CommandListener(ros::NodeHandle& private_node, Simulator& simulator, const NameTable& names,
                  const std::map<std::string, ServoGains>& servo_gains);

  /** @brief Gives the commands whose time has come; before each step. */
  void giveDue();
  /** @brief Forgets those whose time has not come: their stamps are of another time. */
  void forgetPending() { pending_.clear(); }
  /** @brief Bodies have come or gone. @param new_index see newJointIndices */
  void renumberJoints(const std::vector<int>& new_index);

private:
  struct Command
  {
    std::string topic;
    JointCommand::Mode mode;
    std::vector<JointTarget> targets;
  };

  void subscribe(ros::NodeHandle& private_node, const std::string& topic, JointCommand::Mode mode);
  void receive(const std::string& topic, JointCommand::Mode mode, const ros::Time& stamp,
               const std::function<std::vector<JointTarget>()>& read);
  void keep(const ros::Time& stamp, const Command& command);
  void give(const Command& command);
  void warn(const std::string& line);

  Simulator& simulator_;
  const NameTable& names_;
  const std::map<std::string, ServoGains>& servo_gains_;
  std::multimap<ros::Time, Command> pending_;  // by stamp, those of one stamp as they came
  LineThrottle lines_;
  std::set<std::pair<std::string, JointCommand::Mode>> clamped_;  // joints and quantities that have had their warning
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace frictional_contact_sim
