#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "frictional_contact_sim/ros/end_request.h"
#include "frictional_contact_sim/ros/node_help.h"
#include "frictional_contact_sim/ros/parameter_error.h"
#include "frictional_contact_sim/ros/program.h"
#include "frictional_contact_sim/ros/simulator_node.h"

namespace frictional_contact_sim
{
namespace
{
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

int simulate(ros::NodeHandle& node)
{
  ros::NodeHandle private_node("~");
  Reconfiguration::forget();
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(ros::this_node::getName(), tree);
  NodeParameters parameters = readParameters(tree, findRobotDescription(node, private_node));
  parameters.scenario.stopping.stop = &endRequested();
  for (const std::string& warning : parameters.warnings)
    ROS_WARN_STREAM(warning);
  return SimulatorNode(node, private_node, parameters).run();
}

}  // namespace

int runSimulatorNode(int argc, char** argv)
{
  return runProgram(
      {"simulator_node", nodeHelp()}, argc, argv, 0,
      [](ros::NodeHandle& node, const std::vector<std::string>&) { return simulate(node); });
}

}  // namespace frictional_contact_sim
