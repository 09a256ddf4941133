#include "frictional_contact_sim/ros/program.h"

#include <ros/console.h>
#include <ros/init.h>

#include <algorithm>
#include <cstdio>
#include <initializer_list>

#include "frictional_contact_sim/ros/end_request.h"

namespace frictional_contact_sim
{
namespace
{
bool asks(const std::vector<std::string>& arguments, std::initializer_list<const char*> options)
{
  return std::any_of(
      arguments.begin(), arguments.end(),
      [&](const std::string& argument)
      { return std::find(options.begin(), options.end(), argument) != options.end(); });
}

}  // namespace

int runProgram(const ProgramInfo& info, int argc, char** argv, std::uint32_t init_options,
               const std::function<int(ros::NodeHandle&, const std::vector<std::string>&)>& run)
{
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  arguments.erase(arguments.begin(), arguments.begin() + std::min<std::ptrdiff_t>(1, arguments.size()));
  if (asks(arguments, {"--help", "-h"}))
  {
    std::fputs(info.help.c_str(), stdout);
    return SUCCESS;
  }
  if (asks(arguments, {"--version"}))
  {
    std::printf("%s %s\n", info.name.c_str(), FRICTIONAL_CONTACT_SIM_VERSION);
    return SUCCESS;
  }
  if (arguments.size() < info.fewest_arguments || arguments.size() > info.most_arguments)
  {
    std::fprintf(stderr, "%s: found %zu arguments%s: see %s --help\n", info.name.c_str(), arguments.size(),
                 arguments.empty() ? "" : (", '" + arguments.front() + "' ...").c_str(), info.name.c_str());
    return BAD_INPUT;
  }
  try
  {
    ros::init(argc, argv, info.name, init_options | ros::init_options::NoSigintHandler);
  }
  catch (const std::exception& error)  // ros::InvalidNodeNameException, and what a remapping can be wrong in
  {
    std::fprintf(stderr, "%s: %s\n", info.name.c_str(), error.what());
    return BAD_INPUT;
  }
  endOnSignals();
  if (!waitForMaster())
    return SUCCESS;
  ros::NodeHandle node;  // outlives what is caught: the last one closes the log
  try
  {
    return endRequested() ? SUCCESS : run(node, arguments);
  }
  catch (const std::exception& error)
  {
    if (endRequested())
      return SUCCESS;  // what was not read because of the end is not an error
    ROS_FATAL_STREAM(error.what());
  }
  return BAD_INPUT;
}

}  // namespace frictional_contact_sim
