// The programs of examples/, run from outside.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <set>
#include <sstream>

#include "command.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

TEST(ManySimulationsTest, EightDifferentRunsTheSameWheneverTheyAreRun)
{
  const std::string arguments = std::string(PROJECT_DIR) + "/config/scenarios/quadruped.yaml 200";
  const CommandResult first = runTool("many_simulations", arguments);
  ASSERT_EQ(first.code, 0) << first.errors;
  EXPECT_EQ(first.errors, "");
  EXPECT_EQ(runTool("many_simulations", arguments).output, first.output);
  std::istringstream lines(first.output);
  std::set<std::string> hashes;
  std::string number;
  std::string hash;
  while (lines >> number >> hash && std::getline(lines, number))
    hashes.insert(hash);
  EXPECT_EQ(hashes.size(), 8u) << "every simulation has its own push";
}

TEST(ManySimulationsTest, AMissingScenarioIsOneLine)
{
  const CommandResult result = runTool("many_simulations", "no_such.yaml");
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.errors.find("no_such.yaml"), std::string::npos);
}

TEST(EnumerateThesisTest, SubsetsAndSolutionsAreAsMany)
{
  const CommandResult result = runTool("enumerate_thesis", "subset_sum 3 5 7");
  ASSERT_EQ(result.code, 0) << result.errors;
  const std::regex line(R"((\d+) bars, sum +(\d+): (\d+) subsets, (\d+) solutions, complete,)");
  int lines = 0;
  for (std::sregex_iterator match(result.output.begin(), result.output.end(), line); match != std::sregex_iterator();
       ++match, ++lines)
    EXPECT_EQ((*match)[3], (*match)[4]) << match->str();
  EXPECT_EQ(lines, 6) << result.output;
}

TEST(EnumerateThesisTest, ARodThatIsPressedDownHasTwoSolutionsAboveTheFrictionOfTheParadox)
{
  const CommandResult result = runTool("enumerate_thesis", "rod 6");
  ASSERT_EQ(result.code, 0) << result.errors;
  const std::regex line(R"(\n1,1,([\d.]+),([\d.]+),1,(\d),0)");  // gravity and support, angle, friction, complete
  int lines = 0;
  for (std::sregex_iterator match(result.output.begin(), result.output.end(), line); match != std::sregex_iterator();
       ++match, ++lines)
  {
    const bool is_paradox = std::stod((*match)[2]) > std::tan(std::stod((*match)[1]));
    EXPECT_EQ((*match)[3], is_paradox ? "2" : "1") << match->str();
  }
  EXPECT_EQ(lines, 36) << result.output;
}
