#pragma once
/**
 * @file command.h
 * @brief Runs a command-line tool of the package and catches what it says.
 */
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace frictional_contact_sim
{
namespace test_support
{
struct CommandResult
{
  int code = -1;  ///< exit code, or 128 + the signal that ended it
  std::string output, errors;
};

inline std::string textOf(const std::filesystem::path& path)
{
  std::ifstream input(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(input)), std::istreambuf_iterator<char>());
}

/** @brief TOOL_DIR/name with arguments as a shell would take them; nothing it writes is a terminal. */
inline CommandResult runTool(const std::string& name, const std::string& arguments)
{
  const std::filesystem::path base =
      std::filesystem::temp_directory_path() / ("tool_output_" + std::to_string(getpid()));
  const std::string command = std::string(TOOL_DIR) + "/" + name + " " + arguments + " >" + base.string() + ".out 2>" +
                              base.string() + ".err </dev/null";
  const int status = std::system(command.c_str());
  CommandResult result;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.output = textOf(base.string() + ".out");
  result.errors = textOf(base.string() + ".err");
  std::filesystem::remove(base.string() + ".out");
  std::filesystem::remove(base.string() + ".err");
  return result;
}

inline long lines(const std::string& text)
{
  return std::count(text.begin(), text.end(), '\n');
}

}  // namespace test_support
}  // namespace frictional_contact_sim
