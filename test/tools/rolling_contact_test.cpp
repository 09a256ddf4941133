/**
 * @file rolling_contact_test.cpp
 * @brief The command rolling_contact from outside: exit codes, summary, files, bad input.
 */
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command.h"

using namespace frictional_contact_sim::test_support;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

namespace
{
class RollingContactTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("rolling_contact_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& text) const
  {
    std::ofstream(file("case.yaml")) << text;
    return file("case.yaml");
  }
  static std::string example(const std::string& name)
  {
    return std::string(PROJECT_DIR) + "/config/rolling/" + name + ".yaml";
  }

  fs::path folder_;
};
}  // namespace

TEST_F(RollingContactTest, HelpExplainsAndSucceeds)
{
  const CommandResult result = runTool("rolling_contact", "--help");
  EXPECT_EQ(result.code, 0);
  for (const char* word : {"FILE", "--output", "--nodes", "Exit 0"})
    EXPECT_THAT(result.output, HasSubstr(word));
}

TEST_F(RollingContactTest, ExamplesAreSolvedAndWritten)
{
  for (const char* name : {"paper", "paper_small", "cattaneo"})
  {
    const CommandResult result = runTool("rolling_contact", example(name) + " --nodes 40 --output " + file("new/out"));
    EXPECT_EQ(result.code, 0) << name << result.errors;
    EXPECT_EQ(result.errors, "") << name;
    EXPECT_THAT(result.output, HasSubstr("LCP: residual "));
    EXPECT_TRUE(fs::exists(file("new/out/") + name + "_nodes.csv")) << name;
    EXPECT_TRUE(fs::exists(file("new/out/") + name + "_runs.csv")) << name;
  }
}

TEST_F(RollingContactTest, CreepCurveIsExported)
{
  const CommandResult result = runTool("rolling_contact", example("materials") + " --nodes 30 --output " + file(""));
  EXPECT_EQ(result.code, 0) << result.errors;
  for (int run = 0; run < 10; ++run)
    EXPECT_THAT(textOf(file("materials_curve_" + std::to_string(run) + ".yaml")), StartsWith("creep_curve:\n"));
}

TEST_F(RollingContactTest, ComparesWithTheCoresSolvers)
{
  const CommandResult result =
      runTool("rolling_contact", example("cattaneo") + " --nodes 20 --compare lcp_lemke,ac_newton");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("core's lcp_lemke: CONVERGED"));
  EXPECT_THAT(result.output, HasSubstr("core's ac_newton: CONVERGED"));
}

TEST_F(RollingContactTest, UnfinishedWorkIsExitCodeOne)
{
  const CommandResult result =
      runTool("rolling_contact", write("upper: {young_modulus: 94500, poisson_ratio: 0.1}\nfriction: 0.3\nnodes: 30\n"
                                       "flexibility: half_plane\nload: {normal: 100}\n"
                                       "rolling: {motion: transient, creepage: 0.005, max_steps: 3}\n"));
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.output, HasSubstr("NOT CONVERGED"));
}

TEST_F(RollingContactTest, BadInputIsOneLineAndExitCodeTwo)
{
  const std::string rest = ", poisson_ratio: 0.1}\nfriction: 0.3\nload: {normal: 1}\n";
  const auto complaint = [&](const std::string& arguments)
  {
    const CommandResult result = runTool("rolling_contact", arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    EXPECT_EQ(result.output, "") << arguments;
    EXPECT_THAT(result.errors, StartsWith("rolling_contact: "));
    return result.errors;
  };
  EXPECT_THAT(complaint(write("upper: {young_modulus: -1" + rest)),
              HasSubstr("case.yaml:1: key 'upper.young_modulus': found '-1', expected a number > 0"));
  EXPECT_THAT(complaint(write("upper: {young_modulus: 1, poisson_ratio: 0.5}\nfriction: 0\nload: {normal: 1}\n")),
              HasSubstr("found '0.5', expected a number in (-1, 0.5)"));
  EXPECT_THAT(complaint(write("upper: {young_modulus: 1" + rest + "nodes: 0\n")), HasSubstr("key 'nodes': found '0'"));
  EXPECT_THAT(complaint(write("upper: {young_modulus: 1" + rest +
                              "contour: {points: [[0, 0], [1, 1], [0, 1], [1, 0]], contact: [0, 0], held: [2, 2]}\n")),
              HasSubstr("crosses element"));
  EXPECT_THAT(complaint(write("upper: {young_modulus: 1" + rest +
                              "half_width: 1e-6\nflexibility: half_plane\nrolling: {motion: steady}\n")),
              HasSubstr("expected a wider potential contact zone"));
  EXPECT_THAT(complaint(file("missing.yaml")), HasSubstr("cannot be read"));
  EXPECT_THAT(complaint(""), HasSubstr("FILE is required"));
  EXPECT_THAT(complaint(example("cattaneo") + " --nodes 0"), HasSubstr("--nodes"));
  EXPECT_THAT(complaint(example("carter") + " --nodes 20 --compare lcp_lemke"), HasSubstr("--compare expects static"));
  const std::string contour = "contour: {points: [[0, 0], [1, 0], [1, 1], [0, 1]], contact: [0, 0], held: [2, 2]}\n";
  EXPECT_THAT(complaint(write("upper: {young_modulus: 1" + rest + contour) + " --nodes 9"), HasSubstr("--nodes: "));
  EXPECT_THAT(complaint(example("cattaneo") + " --nodes 20 --compare lemke"), HasSubstr("lemke"));
  // Before the computation: nothing is printed.
  EXPECT_THAT(complaint(example("cattaneo") + " --nodes 20 --output " + write("") + "/out"), HasSubstr("/out: "));
}
