/**
 * @file simulator_node.cpp
 * @brief The ROS node: parameters, topics and services are listed in docs/interfaces.md.
 */
#include "frictional_contact_sim/ros/simulator_node.h"

int main(int argc, char** argv)
{
  return frictional_contact_sim::runSimulatorNode(argc, argv);
}
