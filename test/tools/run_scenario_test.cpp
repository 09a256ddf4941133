// run_scenario --dump from outside: the problems of chosen steps as FCLib files.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "command.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/solver/registry.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;

namespace
{
class RunScenarioDumpTest : public testing::Test
{
protected:
  void SetUp() override
  {
    base_ = (fs::temp_directory_path() / ("run_scenario_test_" + std::to_string(getpid()))).string();
    folder_ = base_ + "_dump";
    fs::create_directories(base_);
  }
  void TearDown() override
  {
    fs::remove_all(base_);
    fs::remove_all(folder_);
  }
  /// A box of 10 kg held by friction on the ground, pulled sideways; 12 steps.
  std::string run(const std::string& arguments, int code = 0, const std::string& solver = "tolerance: 1.0e-8") const
  {
    const std::string scene = base_ + "/box.yaml";
    std::ofstream(scene) << "solver: {" << solver
                         << "}\nduration: 0.012\ngravity: [2, 0.5, -9.81]\nground: {}\nbodies:\n  - {name: box, urdf: "
                         << PROJECT_DIR << "/urdf/block.urdf, pose: {xyz: [0, 0, 0.1]}}\n";
    const CommandResult result = runTool("run_scenario", scene + " " + arguments);
    EXPECT_EQ(result.code, code) << result.errors;
    return result.errors;
  }
  std::vector<std::string> files() const
  {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  std::string base_;
  fs::path folder_;
};

TEST_F(RunScenarioDumpTest, WritesEveryNthStepWithTheSameAnswerInBothForms)
{
  for (const std::string form : {"", " --dump-local"})
  {
    run("--dump " + folder_.string() + " --dump-every 5" + form);
    EXPECT_EQ(files(), (std::vector<std::string>{"box_4_10.hdf5", "box_4_5.hdf5"}));
    const FclibProblem problem = readFclib((folder_ / "box_4_10.hdf5").string());
    EXPECT_EQ(problem.kind, form.empty() ? FclibKind::GLOBAL : FclibKind::LOCAL);
    EXPECT_EQ(problem.contacts, 4);
    const std::unique_ptr<Solver> solver = createSolver("portfolio");
    solver->setStopping({1e-12, 1000, 0.0});
    const SolverResult result = form.empty() ? solver->solve(problem.global) : solver->solve(problem.local);
    ASSERT_EQ(result.status, SolverStatus::CONVERGED);
    double normal = 0.0;
    for (int i = 0; i < 4; ++i)
      normal += result.solution.r[3 * i];
    EXPECT_NEAR(normal, 10.0 * 9.81 * 0.001, 1e-9);  // 10 kg for one step; solver's tolerance
    fs::remove_all(folder_);
  }
}

TEST_F(RunScenarioDumpTest, IsWrittenThoughTheSolveFails)
{
  run("--on-failure accept --no-fallback --dump " + folder_.string(), 1,
      "name: ac_fixed_point, max_iterations: 1, tolerance: 1.0e-14");
  EXPECT_EQ(files().size(), 12U);
}

TEST_F(RunScenarioDumpTest, OptionsWithoutAFolderAreRefused)
{
  EXPECT_NE(run("--dump-every 5", 2).find("--dump"), std::string::npos);
  EXPECT_NE(run("--dump-local", 2).find("--dump"), std::string::npos);
  EXPECT_NE(run("--dump /proc/nowhere", 2).find("/proc/nowhere"), std::string::npos);
}
class RunScenarioStateTest : public testing::Test
{
protected:
  RunScenarioStateTest()
    : folder_((fs::temp_directory_path() / ("run_scenario_state_" + std::to_string(getpid()))).string())
  {
    fs::create_directories(folder_);
  }
  ~RunScenarioStateTest() override { fs::remove_all(folder_); }
  CommandResult run(const std::string& scenario, const std::string& arguments) const
  {
    return runTool("run_scenario",
                   std::string(PROJECT_DIR) + "/config/scenarios/" + scenario + ".yaml --json " + arguments);
  }
  static std::string hashOf(const CommandResult& result)
  {
    return nlohmann::json::parse(result.output).at("state_hash").dump();
  }
  std::string folder_;
};

TEST_F(RunScenarioStateTest, ASecondSavedAndASecondMoreInANewProcessAreTwoSecondsToTheBit)
{
  const std::string file = folder_ + "/state";
  for (const std::string scenario : {"quadruped", "grasp", "bouncing_ball"})
  {
    const CommandResult whole = run(scenario, "--duration 2");
    ASSERT_EQ(run(scenario, "--duration 1 --save-state " + file).code, 0);
    const CommandResult half = run(scenario, "--duration 1 --load-state " + file);
    ASSERT_EQ(half.code, whole.code) << half.errors;
    EXPECT_EQ(hashOf(half), hashOf(whole)) << scenario;
  }
}

TEST_F(RunScenarioStateTest, WrongStateFilesAreBadInputInOneLine)
{
  const std::string file = folder_ + "/state";
  ASSERT_EQ(run("grasp", "--duration 0.1 --save-state " + file).code, 0);
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const auto refused = [&](const std::string& scenario, const std::string& path, const std::string& reason)
  {
    const CommandResult result = run(scenario, "--load-state " + path);
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
    EXPECT_EQ(result.output, "");
  };
  refused("quadruped", file, "number of bodies is 2, expected 1");
  refused("grasp", folder_ + "/none", "none");
  std::ofstream(folder_ + "/cut", std::ios::binary) << bytes.substr(0, bytes.size() - 1);
  refused("grasp", folder_ + "/cut", "cut: has ");
  EXPECT_EQ(run("grasp", "--duration 0.1 --save-state " + folder_ + "/no/such/state").code, 2);
}

/// In an empty folder, with the package found as ROS finds it.
class RunScenarioNameTest : public testing::Test
{
protected:
  RunScenarioNameTest()
    : back_(fs::current_path())
    , folder_((fs::temp_directory_path() / ("run_scenario_name_" + std::to_string(getpid()))).string())
  {
    fs::create_directories(folder_);
    fs::current_path(folder_);
    setenv("ROS_PACKAGE_PATH", PROJECT_DIR, 1);
  }
  ~RunScenarioNameTest() override
  {
    fs::current_path(back_);
    fs::remove_all(folder_);
  }
  static void expectRefused(const std::string& arguments, const std::string& reason)
  {
    const CommandResult result = runTool("run_scenario", arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
  }
  fs::path back_;
  std::string folder_;
};

TEST_F(RunScenarioNameTest, NamesThatTheLaunchFileTakesAreTaken)
{
  const std::string file = std::string(PROJECT_DIR) + "/config/scenarios/grasp.yaml";
  const auto hash = [](const std::string& scenario)
  {
    const CommandResult result = runTool("run_scenario", scenario + " --duration 0.01 --json");
    EXPECT_EQ(result.code, 0) << result.errors;
    return nlohmann::json::parse(result.output).at("state_hash").dump();
  };
  const std::string expected = hash(file);
  EXPECT_EQ(hash("grasp"), expected);
  fs::create_directories("grasp");  // a folder of the name is no scenario
  EXPECT_EQ(hash("grasp"), expected);
  expectRefused("./grasp", "./grasp: is a folder, expected a scenario file (YAML)");
  fs::create_directories("elsewhere");
  expectRefused("elsewhere", "elsewhere: is a folder and no scenario of the package");
  expectRefused("grsap", "grsap: is no file and no scenario of the package, did you mean 'grasp'?");
  expectRefused("nowhere.yaml", "nowhere.yaml: is no file");
  expectRefused("", "FILE is missing");
}

TEST_F(RunScenarioNameTest, OptionsOfTheMethodAreArgumentsToo)
{
  expectRefused("grasp --option relaxaton=1", "portfolio has no option 'relaxaton'");
  expectRefused("grasp --solver gauss_seidel --option relaxaton=1", "did you mean 'relaxation'?");
  EXPECT_EQ(runTool("run_scenario", "grasp --duration 0.01 --solver gauss_seidel --option relaxation=0.9").code, 0);
  EXPECT_EQ(runTool("run_scenario", "--list-solvers").output, describeSolvers());
  EXPECT_EQ(runTool("compare_solvers", "--list-solvers").output, describeSolvers());
}

TEST_F(RunScenarioNameTest, WhereSeveralMethodsAreComparedAnOptionMayNameItsOwn)
{
  const auto refused = [](const std::string& tool, const std::string& arguments, const std::string& reason)
  {
    const CommandResult result = runTool(tool, arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    EXPECT_NE(result.errors.find(reason), std::string::npos) << result.errors;
  };
  const std::string cattaneo = std::string(PROJECT_DIR) + "/config/rolling/cattaneo.yaml --compare admm,gauss_seidel ";
  refused("rolling_contact", cattaneo + "--option admm.penlty=1", "did you mean 'penalty'?");
  refused("rolling_contact", cattaneo + "--option relaxation=1", "admm has no option 'relaxation'");
  const std::string both = "none.hdf5 --solvers admm,gauss_seidel ";
  refused("compare_solvers", both + "--option amdm.penalty=1", "did you mean 'admm'?");
  refused("compare_solvers", both + "--option gauss_seidel.relaxation=2", "expected a number in (0, 2)");
  const CommandResult taken = runTool("compare_solvers", both + "--option gauss_seidel.relaxation=1.5");
  EXPECT_NE(taken.output.find("BAD_INPUT"), std::string::npos) << taken.output;  // the file, not the option
}
}  // namespace
