// What all programs have in common, from outside: --version, folders given as files, what a terminal shows.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "command.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;

namespace
{
const std::vector<std::string> TOOLS = {"compare_solvers", "fclib_solve", "generate_problem", "rolling_contact",
                                        "run_scenario"};

class CommonOptionsTest : public testing::Test
{
protected:
  CommonOptionsTest() : folder_((fs::temp_directory_path() / ("common_options_" + std::to_string(getpid()))).string())
  {
    fs::create_directories(folder_ + "/folder");
    std::ofstream(folder_ + "/file") << "no scenario";
    setenv("ROS_PACKAGE_PATH", PROJECT_DIR, 1);
  }
  ~CommonOptionsTest() override { fs::remove_all(folder_); }
  /// The same program with a terminal for all it writes (script of util-linux).
  std::string onATerminal(const std::string& name, const std::string& arguments) const
  {
    const std::string command = "script -qec '" + std::string(TOOL_DIR) + "/" + name + " " + arguments +
                                "' /dev/null >" + folder_ + "/screen </dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0) << textOf(folder_ + "/screen");
    return textOf(folder_ + "/screen");
  }
  std::string folder_;
};

TEST_F(CommonOptionsTest, EveryProgramSaysItsVersion)
{
  for (const std::string& tool : TOOLS)
  {
    const CommandResult result = runTool(tool, "--version");
    EXPECT_EQ(result.code, 0);
    EXPECT_EQ(result.output.rfind(tool + " ", 0), 0u) << result.output;
    EXPECT_NE(textOf(std::string(PROJECT_DIR) + "/package.xml")
                  .find("<version>" + result.output.substr(tool.size() + 1, result.output.size() - tool.size() - 2)),
              std::string::npos)
        << result.output;
  }
}

TEST_F(CommonOptionsTest, AFolderForAFileIsSaidToBeOneAndAFileForAFolderIsNamed)
{
  const std::string file = folder_ + "/file";
  const std::string folder = folder_ + "/folder";
  const std::string problem = folder_ + "/problem.hdf5";
  const std::string carter = std::string(PROJECT_DIR) + "/config/rolling/carter.yaml --nodes 10 --output ";
  ASSERT_EQ(runTool("generate_problem", "alea " + problem).code, 0);
  const std::vector<std::array<std::string, 3>> cases = {
      {"run_scenario", folder, "is a folder"},
      {"run_scenario", "grasp --load-state " + folder, "directory"},
      {"run_scenario", "grasp --duration 0 --output " + file, file + ": cannot be created"},
      {"run_scenario", "grasp --duration 0 --dump " + file, file + ": Not a directory, expected a folder"},
      {"fclib_solve", folder, "is a folder, expected an FCLib file"},
      {"fclib_solve", problem + " --history " + folder, "it is a folder, expected a file"},
      {"compare_solvers", folder, "has no file ending in .hdf5"},
      {"compare_solvers", problem + " --output " + folder, "it is a folder, expected a file"},
      {"generate_problem", "alea " + folder, "expected a file to write"},
      {"generate_problem", "alea-small " + file, file + ": Not a directory, expected a folder"},
      {"rolling_contact", folder, "is a folder"},
      {"rolling_contact", carter + file, file + ": Not a directory, expected a folder"},
  };
  for (const auto& [tool, arguments, expected] : cases)
  {
    const CommandResult result = runTool(tool, arguments);
    EXPECT_EQ(result.code, 2) << tool << ' ' << arguments;
    EXPECT_NE(result.errors.find(expected), std::string::npos) << tool << ' ' << arguments << '\n' << result.errors;
  }
}

/// The line of a summary that begins with a word, without it.
std::string lineOf(const std::string& summary, const std::string& begin)
{
  const size_t at = summary.find("\n  " + begin + " ");
  EXPECT_NE(at, std::string::npos) << begin << " is not in\n" << summary;
  return at == std::string::npos ? "" : summary.substr(at + begin.size() + 3, summary.find('\n', at + 1) - at - 3);
}

TEST_F(CommonOptionsTest, TheSummarySaysWhatTheObjectSays)
{
  int scenarios = 0;
  for (const auto& entry : fs::directory_iterator(std::string(PROJECT_DIR) + "/config/scenarios"))
  {
    const std::string name = entry.path().stem().string();
    const std::string arguments = name + " --duration 0.01 --time-step 0.002 ";
    const CommandResult run = runTool("run_scenario", arguments + "--json");
    ASSERT_EQ(run.code, 0) << name << run.errors;
    const nlohmann::json object = nlohmann::json::parse(run.output);
    const std::string summary = runTool("run_scenario", arguments + "--summary").output;
    EXPECT_EQ(summary.rfind(name + ": 5 steps of 0.002 s, 0.01 s simulated", 0), 0u) << summary;
    EXPECT_EQ(std::stol(lineOf(summary, "failed steps")), 0);
    // Two decimals of the mantissa are printed.
    const double residual = object["worst_residual"];
    EXPECT_NEAR(std::stod(lineOf(summary, "worst residual")), residual, 0.006 * residual) << name;
    const double depth = object["max_penetration"];
    EXPECT_NEAR(std::stod(lineOf(summary, "deepest penetration")), depth, 0.006 * depth) << name;
    int listed = 0;
    for (const auto& [body, state] : object["bodies"].items())
    {
      if (object["bodies"].size() > 12 && summary.find("\n  " + body + " ") == std::string::npos)
        continue;  // the first twelve
      ++listed;
      std::istringstream line(lineOf(summary, body));
      double x, y, z, roll, pitch, yaw, speed, fx, fy, fz;
      ASSERT_TRUE(line >> x >> y >> z >> roll >> pitch >> yaw >> speed >> fx >> fy >> fz) << line.str();
      const std::vector<double> position = state["position"], velocity = state["linear_velocity"];
      const std::vector<double> force = object["contact_force"][body];
      const double expected = std::hypot(velocity[0], velocity[1], velocity[2]);
      EXPECT_LE(std::max({std::abs(x - position[0]), std::abs(y - position[1]), std::abs(z - position[2])}), 5.1e-5);
      EXPECT_NEAR(speed, expected, 0.006 * expected);
      EXPECT_LE(std::max({std::abs(fx - force[0]), std::abs(fy - force[1]), std::abs(fz - force[2])}), 5.1e-4);
      // Angles give the orientation again: their quaternion is the object's up to its sign.
      const double r = roll * M_PI / 360.0, p = pitch * M_PI / 360.0, w = yaw * M_PI / 360.0;
      const std::vector<double> q = state["orientation"];
      const double dot = q[0] * (std::sin(r) * std::cos(p) * std::cos(w) - std::cos(r) * std::sin(p) * std::sin(w)) +
                         q[1] * (std::cos(r) * std::sin(p) * std::cos(w) + std::sin(r) * std::cos(p) * std::sin(w)) +
                         q[2] * (std::cos(r) * std::cos(p) * std::sin(w) - std::sin(r) * std::sin(p) * std::cos(w)) +
                         q[3] * (std::cos(r) * std::cos(p) * std::cos(w) + std::sin(r) * std::sin(p) * std::sin(w));
      EXPECT_NEAR(std::abs(dot), 1.0, 1e-6) << name << ' ' << body;
    }
    EXPECT_EQ(listed, std::min<int>(12, static_cast<int>(object["bodies"].size()))) << name;
    ++scenarios;
  }
  EXPECT_GE(scenarios, 6);
}

TEST_F(CommonOptionsTest, ATerminalGetsTheSummaryUnlessTheObjectIsAskedFor)
{
  EXPECT_NE(onATerminal("run_scenario", "grasp --duration 0.01").find("worst residual"), std::string::npos);
  EXPECT_EQ(onATerminal("run_scenario", "grasp --duration 0.01 --json 2>/dev/null").front(), '{');
  const CommandResult piped = runTool("run_scenario", "grasp --duration 0.01");
  EXPECT_GT(lines(piped.output), 10);
  EXPECT_EQ(nlohmann::json::parse(piped.output)["steps"], 10);
  EXPECT_EQ(runTool("run_scenario", "grasp --json --summary").code, 2);
}

TEST_F(CommonOptionsTest, LongWorkOnATerminalHasABarWithTheTimeLeft)
{
  const std::string screen =
      onATerminal("run_scenario", "quadruped --duration 600 & sleep 2.8; kill -INT $!; wait $!; true");
  EXPECT_NE(screen.find(" %, "), std::string::npos) << screen;
  EXPECT_NE(screen.find(" left, quadruped"), std::string::npos) << screen;
  EXPECT_EQ(onATerminal("run_scenario", "quadruped --duration 0.1").find("left"), std::string::npos);
  EXPECT_EQ(runTool("run_scenario", "grasp --duration 0.1").errors.find('%'), std::string::npos);
}
}  // namespace
