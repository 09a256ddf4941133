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

int simulate(ros::NodeHandle& node)
{
  ros::NodeHandle private_node("~");
  Reconfiguration::forget();
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(ros::this_node::getName(), tree);
  const FindDescription find = [&](const std::string& parameter)
  { return findDescription(node, private_node, parameter); };
  NodeParameters parameters = readParameters(tree, find("robot_description"), find);
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
