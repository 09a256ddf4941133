/**
 * @file enumerate_test.cpp
 * @brief The command enumerate from outside: the keys of the contract, counts, exit codes, bad input.
 */
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;

namespace
{
class EnumerateTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("enumerate_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  template <typename Problem>
  std::string write(const Problem& problem)
  {
    const std::string path = (folder_ / (std::to_string(++files_) + ".hdf5")).string();
    writeFclib(path, problem, {});
    return path;
  }
  template <typename Problem>
  nlohmann::json answer(const Problem& problem, int code = 0, const std::string& options = "")
  {
    const CommandResult result = runTool("enumerate", write(problem) + " --json " + options);
    EXPECT_EQ(result.code, code) << result.errors;
    EXPECT_EQ(lines(result.output), 1);
    return nlohmann::json::parse(result.output);
  }

  fs::path folder_;
  int files_ = 0;
};
}  // namespace

TEST_F(EnumerateTest, JsonHasTheKeysOfTheContract)
{
  const nlohmann::json rod = answer(painleveRod(0.5, 2.0, 1.0, 1.0));
  for (const char* key : {"file", "complete", "solutions", "continua", "velocities", "seconds"})
    EXPECT_TRUE(rod.contains(key)) << key;
  EXPECT_EQ(rod["complete"], true);
  EXPECT_EQ(rod["solutions"], 2);
  EXPECT_EQ(rod["continua"], 0);
  ASSERT_EQ(rod["velocities"].size(), 2U);
  EXPECT_EQ(rod["velocities"][0].size(), 1U);
  EXPECT_EQ(rod["uniqueness"], "MULTIPLE");
  const nlohmann::json square = answer(squareOnTwoContacts());
  EXPECT_EQ(square["solutions"], 0);
  EXPECT_EQ(square["continua"], 1);
  EXPECT_EQ(square["uniqueness"], "UNIQUE_V");
  EXPECT_EQ(square["families"][0]["dimension"], 1);
  EXPECT_EQ(square["families"][0]["pieces"][0]["vertices"].size(), 2U);
}

TEST_F(EnumerateTest, NoSolutionIsAnAnswerALimitIsNot)
{
  const nlohmann::json none = answer(painleveRod(0.5, 2.0, -1.0, 1.0));
  EXPECT_EQ(none["complete"], true);
  EXPECT_EQ(none["solutions"], 0);
  EXPECT_EQ(none["velocities"].size(), 0U);
  EXPECT_EQ(none["diagnosis"], "PAINLEVE_INCONSISTENT");
  EXPECT_EQ(answer(subsetSumMachine({3, 5, 7}, 4), 1, "--option max_nodes=10")["complete"], false);
  EXPECT_EQ(answer(reduce(subsetSumMachine({3, 5, 7, 8}, 8)))["solutions"], 2);  // a local file; velocities are u
}

TEST_F(EnumerateTest, BadInputIsOneLine)
{
  const std::string path = write(squareOnTwoContacts());
  for (const std::string& arguments :
       {std::string(), path + " --option max_nodes=0", path + " --option nodes=3", std::string("/nowhere.hdf5")})
  {
    const CommandResult result = runTool("enumerate", arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    EXPECT_EQ(result.output, "") << arguments;
  }
}
