/**
 * @file generate_problem_test.cpp
 * @brief The commands generate_problem and compare_solvers from outside: what they write, bad numbers.
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
class GenerateProblemTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("generate_problem_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  /// The one line of a refusal, which must leave no file behind.
  std::string complaint(const std::string& family, const std::string& options) const
  {
    const CommandResult result = runTool("generate_problem", family + " " + options + " " + file("out.hdf5"));
    EXPECT_EQ(result.code, 2) << options;
    EXPECT_EQ(lines(result.errors), 1) << options << ": " << result.errors;
    EXPECT_EQ(result.output, "") << options;
    EXPECT_FALSE(fs::exists(file("out.hdf5"))) << options;
    EXPECT_THAT(result.errors, StartsWith("generate_problem: "));
    return result.errors;
  }

  fs::path folder_;
};
}  // namespace

TEST_F(GenerateProblemTest, BadNumbersNameTheOptionWhatWasFoundAndExpected)
{
  EXPECT_THAT(complaint("alea", "--condition 1e308"),
              HasSubstr("condition is 1e+308, expected a number from 1 to 1e+15"));
  EXPECT_THAT(complaint("alea", "--condition nan"), HasSubstr("condition is nan, expected"));
  EXPECT_THAT(complaint("alea", "--external-velocity 1e308"), HasSubstr("external_velocity is 1e+308, expected"));
  EXPECT_THAT(complaint("alea", "--friction-min -1e-9"), HasSubstr("friction_min is -1e-09, expected"));
  EXPECT_THAT(complaint("alea", "--friction-max inf"), HasSubstr("friction_max is inf, expected"));
  EXPECT_THAT(complaint("alea", "--contacts 2147483647"), HasSubstr("contacts is 2147483647, expected"));
  EXPECT_THAT(complaint("alea", "--velocities 43"), HasSubstr("velocities is 43, expected a multiple of"));
  EXPECT_THAT(complaint("granular", "--mass-ratio 1e300"), HasSubstr("mass_ratio is 1e+300, expected"));
  EXPECT_THAT(complaint("granular", "--agitation 1e300"), HasSubstr("agitation is 1e+300, expected"));
  EXPECT_THAT(complaint("granular", "--width 100000"), HasSubstr("width is 100000, expected"));
  EXPECT_THAT(complaint("boxes", "--time-step 0"), HasSubstr("time_step is 0, expected"));
  EXPECT_THAT(complaint("boxes", "--points-per-side 2147483647"), HasSubstr("points_per_side is 2147483647, expected"));
  EXPECT_THAT(complaint("boxes", "--levels 2147483647"), HasSubstr("levels is 2147483647, expected"));
  EXPECT_THAT(complaint("rods", "--spacing 0"), HasSubstr("spacing is 0, expected"));
  EXPECT_THAT(complaint("rods", "--curl 1e300"), HasSubstr("curl is 1e+300, expected"));
  EXPECT_THAT(complaint("rods", "--pieces 2147483647"), HasSubstr("pieces is 2147483647, expected"));
  EXPECT_THAT(complaint("alea", "--contacts many"), HasSubstr("--contacts"));
  EXPECT_THAT(complaint("rods", "--seed -1"), HasSubstr("--seed: is -1, expected a whole number >= 0"));
}

TEST_F(GenerateProblemTest, ComparesWhatWasGenerated)
{
  ASSERT_EQ(runTool("generate_problem", "alea --contacts 5 " + file("a.hdf5")).code, 0);
  const CommandResult result = runTool("compare_solvers", file("a.hdf5") + " --solvers ac_newton,cadoux_newton");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_EQ(lines(result.output), 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr(",cadoux_newton,CONVERGED,"));
}

TEST_F(GenerateProblemTest, ComparisonWritesAHistoryASolve)
{
  ASSERT_EQ(runTool("generate_problem", "alea --contacts 5 " + file("a.hdf5")).code, 0);
  ASSERT_EQ(runTool("generate_problem", "alea --contacts 6 " + file("b.hdf5")).code, 0);
  const std::string call = file("a.hdf5") + " " + file("b.hdf5") + " --solvers ac_newton,portfolio --history ";
  ASSERT_EQ(runTool("compare_solvers", call + file("new/folder")).code, 0);
  for (const char* name : {"a_ac_newton", "a_portfolio", "b_ac_newton", "b_portfolio"})
  {
    const std::string text = textOf(file(std::string("new/folder/") + name + ".csv"));
    EXPECT_EQ(text.rfind("iteration,seconds,residual,file,solver\n", 0), 0u) << name << text;
    EXPECT_GE(lines(text), 3) << name;
  }
  EXPECT_THAT(textOf(file("new/folder/b_portfolio.csv")), HasSubstr("b.hdf5,portfolio\n"));
  EXPECT_THAT(runTool("compare_solvers", "--help").output, HasSubstr("--history"));
}

TEST_F(GenerateProblemTest, AHistoryThatCannotBeWrittenIsOneLine)
{
  ASSERT_EQ(runTool("generate_problem", "alea --contacts 5 " + file("a.hdf5")).code, 0);
  fs::create_directories(file("other"));
  fs::copy(file("a.hdf5"), file("other/a.hdf5"));
  const auto refused = [&](const std::string& arguments, const char* part)
  {
    const CommandResult result = runTool("compare_solvers", file("a.hdf5") + " " + arguments + " --solvers portfolio");
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    EXPECT_THAT(result.errors, HasSubstr(part));
    EXPECT_EQ(result.output, "");
  };
  refused("--history " + file("a.hdf5"), "is no folder to write to");
  refused("--history " + file("a.hdf5") + "/below", "is no folder to write to");
  refused(file("other/a.hdf5") + " --history " + file("histories"), "two files are called a.hdf5");
}

TEST_F(GenerateProblemTest, ComparisonRefusesBadOptionsBeforeItTouchesAFile)
{
  ASSERT_EQ(runTool("generate_problem", "alea --contacts 5 " + file("a.hdf5")).code, 0);
  std::ofstream(file("results.csv")) << "yesterday's";
  for (const char* options : {"--solvers nonsense", "--solvers portfolio --tolerance nan", "--tolerance -1",
                              "--time-limit -1", "--repeat 0", "--max-iterations 1e3"})
  {
    const CommandResult result =
        runTool("compare_solvers", file("a.hdf5") + " --output " + file("results.csv") + " " + options);
    EXPECT_EQ(result.code, 2) << options;
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    EXPECT_EQ(textOf(file("results.csv")), "yesterday's") << options;
  }
}
