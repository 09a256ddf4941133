/**
 * @file certify_tool_test.cpp
 * @brief The commands certify and threshold from outside: verdicts, JSON, exit codes, bad input.
 */
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "command.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using testing::HasSubstr;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace
{
class CertifyToolTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("certify_tool_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  std::string write(const std::string& name, const IncrementalProblem& problem, const Solution* answer = nullptr)
  {
    writeFclib(file(name), problem, {name, "test", ""}, answer);
    return file(name);
  }
  static Json report(const std::string& arguments, int code)
  {
    const CommandResult result = runTool("certify", arguments + " --json");
    EXPECT_EQ(result.code, code) << result.errors;
    EXPECT_EQ(lines(result.output), 1);
    return Json::parse(result.output);
  }

  fs::path folder_;
};
}  // namespace

TEST_F(CertifyToolTest, ASqueezedDiscIsRefutedWithBothContacts)
{
  const Json object = report(write("disc.hdf5", squeezedDisc(1.0, 0.5)) + " --proof", 0);
  EXPECT_EQ(object["existence"], "REFUTED");
  EXPECT_EQ(object["blocking_contacts"], Json({0, 1}));
  EXPECT_LT(object["margin"].get<double>(), 0.0);
  EXPECT_EQ(object["multiplier"].size(), object["rows"].get<size_t>());
  for (const char* key : {"file", "existence", "margin", "blocking_contacts", "rank", "condition", "seconds"})
    EXPECT_TRUE(object.contains(key)) << key;
}

TEST_F(CertifyToolTest, Example321CarriesTheoremThatItsStoredFixedPointIsNoSolution)
{
  Solution trap;
  trap.v.setZero(2);
  trap.u.setZero(3);
  trap.r.setZero(3);
  const std::string path = write("example321.hdf5", example321(), &trap);
  const Json object = report(path + " --klarbring-pang", 0);
  EXPECT_EQ(object["existence"], "CERTIFIED");
  EXPECT_EQ(object["theorem_3_20"]["fixed_point"], true);
  EXPECT_EQ(object["theorem_3_20"]["solution"], false);
  EXPECT_EQ(object["theorem_3_20"]["unqualified_contacts"], Json({0}));
  EXPECT_EQ(object["solvable_for_every_w"], false);
  const Json solved = report(path + " --solver portfolio", 0);
  EXPECT_EQ(solved["theorem_3_20"]["solution"], true);
}

TEST_F(CertifyToolTest, PainlevesRodIsUndecidedWithExitCodeOne)
{
  const Json object = report(write("rod.hdf5", painleveRod(0.7, 2.0, 1.0, 1.0)), 1);
  EXPECT_EQ(object["existence"], "UNDECIDED");
  EXPECT_NEAR(object["margin"].get<double>(), -std::tan(0.7), 1e-6);
  EXPECT_EQ(object["blocking_contacts"], Json::array());
  EXPECT_EQ(report(file("rod.hdf5") + " --bound 1e-3", 1)["bound"], 1e-3);
}

TEST_F(CertifyToolTest, BadInputIsOneLineAndExitCodeTwo)
{
  for (const std::string& arguments :
       {std::string("/nowhere.hdf5"), std::string(""), write("x.hdf5", example321()) + " --bound -1",
        file("x.hdf5") + " --solver nobody"})
  {
    const CommandResult result = runTool("certify", arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
  }
}

TEST_F(CertifyToolTest, AThresholdOfFrictionOnAnIncline)
{
  std::ofstream(file("incline.yaml"))
      << "time_step: 0.002\nduration: 0.2\ngravity: [3.0, 0, -9.0]\nground: {}\nbodies:\n  - {name: box, urdf: "
      << PROJECT_DIR << "/urdf/block.urdf, pose: {xyz: [0, 0, 0.1]}}\n";
  const std::string common = file("incline.yaml") + " --vary materials.default.friction --from 0.1 --to 1 ";
  const CommandResult result = runTool("threshold", common + "--hold 'max_speed < 1e-6' --tolerance 1e-3 --json");
  ASSERT_EQ(result.code, 0) << result.errors;
  const Json object = Json::parse(result.output);
  EXPECT_NEAR(object["holds_from"].get<double>(), 1.0 / 3.0, 1e-3);
  EXPECT_EQ(object["holds_to"], 1.0);
  EXPECT_EQ(object["runs"].get<int>(), static_cast<int>(object["tried"].size()) + 1);
  EXPECT_EQ(object["certificate"]["existence"]["existence"], "CERTIFIED");
  EXPECT_THAT(object["certificate"]["text"].get<std::string>(), HasSubstr("holds for materials.default.friction >="));
  EXPECT_EQ(runTool("threshold", common + "--hold 'max_speed > 1e6'").code, 1);
  for (const char* hold : {"'max_sped < 1'", "'max_speed'"})
  {
    const CommandResult bad = runTool("threshold", common + "--hold " + hold);
    EXPECT_EQ(bad.code, 2);
    EXPECT_EQ(lines(bad.errors), 1) << bad.errors;
  }
  EXPECT_EQ(runTool("threshold", file("incline.yaml") + " --vary no.such --from 0 --to 1 --hold 'kinetic < 1'").code,
            2);
}
