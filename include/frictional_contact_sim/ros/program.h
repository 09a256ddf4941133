#pragma once
/**
 * @file program.h
 * @brief The frame of a program that is a ROS node: --help and --version without a master, bad names and every
 * exception as one line, signals.
 */
#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
/// Exit codes (docs/interfaces.md): 0 all well, 1 something did not converge, 2 bad input.
constexpr int SUCCESS = 0;
constexpr int NOT_CONVERGED = 1;
constexpr int BAD_INPUT = 2;

struct ProgramInfo
{
  std::string name;  ///< of the node too, unless it is remapped
  std::string help;
  size_t fewest_arguments = 0;
  size_t most_arguments = 0;
};

/**
 * @param init_options of ros::init, besides NoSigintHandler
 * @param run is called when the master answers, with the arguments but ROS's own (name:=value); it looks at
 * endRequested()
 * @return run's exit code; BAD_INPUT after an exception, with one line
 */
int runProgram(const ProgramInfo& info, int argc, char** argv, std::uint32_t init_options,
               const std::function<int(ros::NodeHandle&, const std::vector<std::string>&)>& run);

}  // namespace frictional_contact_sim
