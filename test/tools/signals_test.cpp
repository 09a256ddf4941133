// SIGINT and SIGTERM end a long solve; what is done is written, exit code 130. And what a failed step does to a run.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;
using nlohmann::json;

namespace
{
/** The tool with a signal after two seconds; ended for good after 100 more. */
CommandResult runWithSignal(const std::string& signal, const std::string& name, const std::string& arguments)
{
  const fs::path base = fs::temp_directory_path() / ("signals_" + std::to_string(getpid()));
  // --foreground: otherwise timeout signals the program and then its group, and a second signal ends it at once.
  const std::string command = "timeout --foreground --preserve-status -k 100 -s " + signal + " 2 " + TOOL_DIR + "/" +
                              name + " " + arguments + " >" + base.string() + ".out 2>" + base.string() +
                              ".err </dev/null";
  const int status = std::system(command.c_str());
  CommandResult result;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.output = textOf(base.string() + ".out");
  result.errors = textOf(base.string() + ".err");
  fs::remove(base.string() + ".out");
  fs::remove(base.string() + ".err");
  return result;
}

class SignalsTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("signals_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /** A mass point between the ground and a wall that comes down at 1 m/s: no answer, sweeps go on for ever. */
  std::string squeezed() const
  {
    Eigen::MatrixXd spatial = Eigen::MatrixXd::Zero(6, 3);
    spatial.topRows(3).setIdentity();
    spatial.bottomRows(3) = -Eigen::Matrix3d::Identity();
    Eigen::VectorXd w = Eigen::VectorXd::Zero(6);
    w[3] = -1.0;
    const std::string path = (folder_ / "squeezed.hdf5").string();
    writeFclib(path,
               denseProblem(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.01, 0.0, 0.0), spatial, w,
                            {{LawType::COULOMB_3D, 0.5}, {LawType::COULOMB_3D, 0.5}}),
               {});
    return path;
  }
  /** The same as a scenario: a plate comes down on a box; it meets it after some 50 steps. */
  std::string press(const std::string& lines) const
  {
    const std::string path = (folder_ / "press.yaml").string();
    std::ofstream(path) << lines << "duration: 1\nground: {}\nbodies:\n  - {name: box, urdf: " << PROJECT_DIR
                        << "/urdf/block.urdf, pose: {xyz: [0, 0, 0.1]}}\n  - {name: plate, urdf: " << PROJECT_DIR
                        << "/urdf/block.urdf, base: fixed, pose: {xyz: [0, 0, 0.35]}, motion: {linear: [0, 0, -1]}}\n";
    return path;
  }

  fs::path folder_;
};

const std::string ENDLESS = " --tolerance 1e-300 --max-iterations 1000000000 --time-limit 0 ";
}  // namespace

TEST_F(SignalsTest, FclibSolveWritesItsBestIterate)
{
  for (const std::string signal : {"INT", "TERM"})
  {
    const std::string output = (folder_ / ("answer_" + signal + ".hdf5")).string();
    const CommandResult result =
        runWithSignal(signal, "fclib_solve", squeezed() + ENDLESS + "--solver gauss_seidel --json --output " + output);
    EXPECT_EQ(result.code, 130) << result.errors;
    EXPECT_EQ(json::parse(result.output)["status"], "STOPPED_BY_USER") << result.output;
    EXPECT_TRUE(fs::exists(output));
  }
}

TEST_F(SignalsTest, CompareSolversKeepsTheRowsDone)
{
  const CommandResult result =
      runWithSignal("INT", "compare_solvers", squeezed() + ENDLESS + "--solvers interior_point,gauss_seidel,haslinger");
  EXPECT_EQ(result.code, 130) << result.errors;
  EXPECT_NE(result.output.find(",interior_point,"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("STOPPED_BY_USER"), std::string::npos) << result.output;
}

TEST_F(SignalsTest, RunScenarioWritesTheStepsDone)
{
  const std::string scene = press("solver: {name: gauss_seidel, tolerance: 1.0e-9, max_iterations: 1000000000}\n");
  for (const std::string signal : {"INT", "TERM"})
  {
    const std::string output = (folder_ / signal).string();
    const CommandResult result = runWithSignal(signal, "run_scenario", scene + " --json --output " + output);
    EXPECT_EQ(result.code, 130) << result.errors;
    const json summary = json::parse(result.output);
    EXPECT_EQ(summary["failed_steps"], 0) << "a signal is no failure";
    EXPECT_NEAR(summary["steps"].get<double>(), 50.0, 2.0);  // 0.05 m at 1 m/s in steps of 1 ms
    EXPECT_EQ(lines(textOf(output + "/steps.csv")), summary["steps"].get<long>() + 1);
  }
}

TEST_F(SignalsTest, AFailedStepStopsARunAsThePolicySays)
{
  const std::string solver = "solver: {max_iterations: 50}\n";
  for (const std::string policy : {"", "failure: {policy: stop}\n", "failure: {policy: pause, fallback: false}\n"})
  {
    const CommandResult result =
        runTool("run_scenario", press(solver + policy) + " --json --dump-every 1000 --dump " + folder_.string());
    EXPECT_EQ(result.code, 1) << result.errors;
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    for (const char* word : {"step ", " at 0.0", " s: ", "policy: "})
      EXPECT_NE(result.errors.find(word), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("problem in " + folder_.string()), std::string::npos) << result.errors;
    const json summary = json::parse(result.output);
    EXPECT_EQ(summary["failed_steps"], 1);
    EXPECT_NEAR(summary["steps"].get<double>(), 50.0, 2.0);
  }
}

TEST_F(SignalsTest, HoldAndAcceptGoOnAndCountTheFailedSteps)
{
  for (const std::string policy : {"hold", "accept"})
    for (const bool flag : {false, true})
    {
      const std::string lines =
          "solver: {max_iterations: 20}\n" + (flag ? "" : "failure: {policy: " + policy + ", fallback: false}\n");
      const CommandResult result = runTool("run_scenario", press(lines) + " --json --duration 0.1" +
                                                               (flag ? " --no-fallback --on-failure " + policy : ""));
      EXPECT_EQ(result.code, 1) << result.errors;
      const json summary = json::parse(result.output);
      EXPECT_EQ(summary["steps"], 100);
      EXPECT_GT(summary["failed_steps"], 40);
    }
  EXPECT_EQ(runTool("run_scenario", press("") + " --on-failure explode").code, 2);
}

TEST_F(SignalsTest, AnErrorInTheFailureKeyIsOneLine)
{
  const CommandResult result = runTool("run_scenario", press("failure: {policy: explode}\n"));
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.errors.find("press.yaml:1"), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("failure.policy"), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("found 'explode', expected stop, pause, hold or accept"), std::string::npos)
      << result.errors;
}
