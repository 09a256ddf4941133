// The programs of examples/, run from outside.
#include <gtest/gtest.h>

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
