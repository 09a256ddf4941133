#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <atomic>
#include <csignal>

#include "frictional_contact_sim/ros/parameter_error.h"
#include "frictional_contact_sim/ros/simulator_node.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int BAD_INPUT = 2;

std::atomic<bool> stop{false};  ///< SIGINT or SIGTERM: ends a solve under way

/** @brief ROS shuts down, and a long solve ends; a second signal ends the process. */
void endOnSignals()
{
  struct sigaction action
  {
  };
  action.sa_handler = [](int)
  {
    stop = true;
    ros::requestShutdown();
  };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/** @brief ~robot_description, else robot_description of this namespace or one above, else empty. */
std::string findRobotDescription(ros::NodeHandle& node, ros::NodeHandle& private_node)
{
  XmlRpc::XmlRpcValue value;
  std::string key;
  const bool found = private_node.getParam("robot_description", value) ||
                     (node.searchParam("robot_description", key) && node.getParam(key, value));
  if (found && value.getType() != XmlRpc::XmlRpcValue::TypeString)
    throw ParameterError("robot_description: expected a string with a URDF document");
  return found ? static_cast<std::string>(value) : std::string();
}

}  // namespace

int runSimulatorNode(int argc, char** argv)
{
  ros::init(argc, argv, "simulator_node", ros::init_options::NoSigintHandler);
  endOnSignals();
  ros::NodeHandle node;
  ros::NodeHandle private_node("~");
  try
  {
    XmlRpc::XmlRpcValue tree;
    private_node.getParam(ros::this_node::getName(), tree);
    NodeParameters parameters = readParameters(tree, findRobotDescription(node, private_node));
    parameters.scenario.stopping.stop = &stop;
    for (const std::string& warning : parameters.warnings)
      ROS_WARN_STREAM(warning);
    return SimulatorNode(node, private_node, parameters).run();
  }
  catch (const std::exception& error)
  {
    ROS_FATAL_STREAM(error.what());
  }
  return BAD_INPUT;
}

}  // namespace frictional_contact_sim
