#pragma once
/**
 * @file command_listener.h
 * @brief The topics ~command/...: messages to commands of the simulator, what is wrong with them to the log.
 */
#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>

#include <functional>
#include <map>
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

private:
  void subscribe(ros::NodeHandle& private_node, const std::string& topic, JointCommand::Mode mode,
                 std::vector<double> sensor_msgs::JointState::*field, const std::string& field_name);
  void command(const std::string& topic, JointCommand::Mode mode, const std::function<JointTargets()>& read);
  void give(const std::string& topic, JointCommand::Mode mode, int index, double target);
  void warn(const std::string& line);

  Simulator& simulator_;
  const NameTable& names_;
  const std::map<std::string, ServoGains>& servo_gains_;
  LineThrottle lines_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace frictional_contact_sim
