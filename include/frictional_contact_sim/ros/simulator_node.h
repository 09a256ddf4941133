#pragma once
/**
 * @file simulator_node.h
 * @brief The ROS node around one Simulator.
 */
namespace frictional_contact_sim
{
/** @brief The whole program. @return exit code: 0 done or interrupted, 1 a step failed (~on_failure stop), 2 bad input */
int runSimulatorNode(int argc, char** argv);

}  // namespace frictional_contact_sim
