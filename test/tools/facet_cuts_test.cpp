/**
 * @file facet_cuts_test.cpp
 * @brief The command facet_cuts from outside: a program by hand, files that were written, exit codes, bad input.
 */
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;

namespace
{
class FacetCutsTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("facet_cuts_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text) const
  {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  nlohmann::json answer(const std::string& arguments, int code = 0) const
  {
    const CommandResult result = runTool("facet_cuts", arguments + " --json");
    EXPECT_EQ(result.code, code) << result.errors;
    EXPECT_EQ(lines(result.output), 1);
    return nlohmann::json::parse(result.output);
  }

  fs::path folder_;
};

/// max y, y <= 3 x, y <= 3 (1 - x), x and y >= 0 whole: the relaxation's vertex (1/2, 3/2); the split of x leaves y =
/// 0.
constexpr const char* TRIANGLE =
    "NAME triangle FREE\nROWS\n N obj\n L up\n L down\nCOLUMNS\n M1 'MARKER' 'INTORG'\n x up -3 down 3\n"
    " y obj -1 up 1\n y down 1\n M2 'MARKER' 'INTEND'\nRHS\n RHS down 3\nBOUNDS\n UP BND x 5\n UP BND y 5\nENDATA\n";
}  // namespace

TEST_F(FacetCutsTest, TheTriangleIsCutToItsBase)
{
  const nlohmann::json found = answer(file("triangle.mps", TRIANGLE) + " --check-facets");
  EXPECT_EQ(found["status"], "STUDIED");
  EXPECT_NEAR(found["objective"]["relaxation"].get<double>(), -1.5, 1e-9);
  for (const char* kind : {"most_violated", "deepest", "facets"})  // y <= 0 (or the split of y itself: y <= 1)
    EXPECT_GT(found["objective"][kind].get<double>(), -1.5 + 0.4) << kind;
  EXPECT_LT(found["duality_error"].get<double>(), 1e-10);
  const nlohmann::json& deepest = found["deepest"];
  EXPECT_GE(deepest["depth"].get<double>(), found["most_violated"]["depth"].get<double>() - 1e-9);
  for (const auto& [x, y] : {std::pair(0.0, 0.0), std::pair(1.0, 0.0)})
    for (const nlohmann::json& cut : found["facet_cuts"])
      EXPECT_LE(cut["row"][0].get<double>() * x + cut["row"][1].get<double>() * y,
                cut["right_hand_side"].get<double>() + 1e-9);
}

TEST_F(FacetCutsTest, AGeneratedProgramIsTheSameFromItsFile)
{
  const std::string path = (folder_ / "program.mps").string();
  const nlohmann::json made = answer("generate --variables 9 --constraints 7 --seed 4 --output " + path);
  const nlohmann::json read = answer(path);
  EXPECT_EQ(read["cuts"], made["cuts"]);
  EXPECT_NEAR(read["objective"]["facets"].get<double>(), -made["objective"]["facets"].get<double>(), 1e-6);
  const nlohmann::json bounded = answer("generate --variables 9 --seed 4 --bound-factor 10 --start projection");
  EXPECT_GT(bounded["bound"].get<double>(), 0.0);
  EXPECT_EQ(bounded["rays"], 0);
}

TEST_F(FacetCutsTest, BadInputIsOneLine)
{
  const std::string good = file("triangle.mps", TRIANGLE);
  const std::string sense = file("sense.mps", "NAME a\nOBJSENSE\n MAX\nROWS\n N obj\nCOLUMNS\nENDATA\n");
  std::string real = TRIANGLE;
  real.erase(real.find(" M1"), real.find(" x up") - real.find(" M1"));
  real.erase(real.find(" M2"), real.find("RHS\n") - real.find(" M2"));
  for (const std::string& arguments :
       {std::string(), good + " generate", file("bad.mps", "no program\n"), sense, file("real.mps", real),
        (folder_ / "none.mps").string(), folder_.string(), std::string("generate --variables 0"),
        "generate --output " + (folder_ / "none" / "x.mps").string(), good + " --start nowhere"})
  {
    const CommandResult result = runTool("facet_cuts", arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_EQ(lines(result.errors), 1) << arguments << result.errors;
    EXPECT_TRUE(result.output.empty()) << arguments << result.output;
  }
}
