/**
 * @file fclib_solve_test.cpp
 * @brief The command fclib_solve from outside: exit codes, output, files, bad input (docs/interfaces.md).
 */
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "command.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"
#include "support/validator.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;

namespace
{
class FclibSolveTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("fclib_solve_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  /// A local problem of one sliding contact: W = I, q = (-1, -2, 0), mu = 1/2; r = (1, 1/2, 0).
  std::string localFile(const std::string& name = "local.hdf5") const
  {
    writeFclib(file(name),
               localProblem(Eigen::Matrix3d::Identity(), Eigen::Vector3d(-1, -2, 0), {{LawType::COULOMB_3D, 0.5}}), {});
    return file(name);
  }
  std::string globalFile(const std::string& name = "global.hdf5") const
  {
    RandomProblemOptions options;
    options.bilaterals = 2;
    writeFclib(file(name), randomProblem(options, 2), {});
    return file(name);
  }
  static CommandResult solve(const std::string& arguments) { return runTool("fclib_solve", arguments); }
  static void expectRefused(const CommandResult& result, const std::string& part)
  {
    EXPECT_EQ(result.code, 2) << result.output << result.errors;
    EXPECT_EQ(lines(result.errors), 1) << result.errors;
    EXPECT_NE(result.errors.find(part), std::string::npos) << result.errors << " lacks '" << part << "'";
    EXPECT_EQ(result.output, "");
  }

  fs::path folder_;
};

/// Overwrites one number of a data set.
void setEntry(const std::string& path, const std::string& name, size_t index, double value)
{
  const hid_t handle = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(handle, name.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(dataset);
  std::vector<double> values(static_cast<size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  values.at(index) = value;
  EXPECT_GE(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << name;
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(handle);
}

/// Replaces a data set of numbers by a shorter one.
void shorten(const std::string& path, const std::string& name)
{
  const hid_t handle = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  EXPECT_GE(H5Ldelete(handle, name.c_str(), H5P_DEFAULT), 0) << name;
  const hsize_t size = 1;
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t dataset =
      H5Dcreate2(handle, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const double value = 1.0;
  H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
  H5Dclose(dataset);
  H5Sclose(space);
  H5Fclose(handle);
}

fs::path sharedFolder()
{
  return fs::path(PROJECT_DIR) / ".." / "shared" / "fclib";
}
}  // namespace

TEST_F(FclibSolveTest, JsonHasTheKeysOfTheContractAndTheFileStaysAsItIs)
{
  const std::string path = localFile();
  const std::string before = textOf(path);
  const CommandResult result = solve(path + " --json --repeat 3");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(lines(result.output), 1);
  const nlohmann::json answer = nlohmann::json::parse(result.output);
  for (const char* key : {"file", "kind", "contacts", "dimension", "solver", "status", "iterations", "residual",
                          "siconos_error", "natural_map_1q", "seconds"})
    EXPECT_TRUE(answer.contains(key)) << key;
  EXPECT_EQ(answer["file"], path);
  EXPECT_EQ(answer["kind"], "local");
  EXPECT_EQ(answer["contacts"], 1);
  EXPECT_EQ(answer["dimension"], 3);
  EXPECT_EQ(answer["solver"], "portfolio");
  EXPECT_EQ(answer["status"], "CONVERGED");
  EXPECT_LE(answer["residual"], 1e-8);
  EXPECT_GE(answer["seconds"], 0.0);
  EXPECT_EQ(textOf(path), before);
}

TEST_F(FclibSolveTest, EverySolverOfTheListRunsAndItsExitCodeTellsWhetherItConverged)
{
  const CommandResult list = solve("--list-solvers");
  EXPECT_EQ(list.code, 0);
  EXPECT_EQ(list.output, describeSolvers());
  const std::string path = globalFile();
  for (const SolverEntry& entry : solverRegistry())
  {
    EXPECT_NE(list.output.find(std::string(entry.name) + " "), std::string::npos) << entry.name;
    const CommandResult result = solve(path + " --json --max-iterations 5000 --solver " + entry.name);
    const nlohmann::json answer = nlohmann::json::parse(result.output);
    EXPECT_EQ(answer["solver"], entry.name);
    EXPECT_EQ(answer["kind"], "global");
    EXPECT_EQ(result.code, answer["status"] == "CONVERGED" ? 0 : 1) << result.output;
  }
}

TEST_F(FclibSolveTest, OptionsReachTheMethod)
{
  const auto iterations = [&](const std::string& options)
  {
    const CommandResult result = solve(globalFile() + " --json --solver cadoux_fixed_point " + options);
    EXPECT_EQ(result.code, 0) << result.errors;
    return nlohmann::json::parse(result.output)["iterations"].get<int>();
  };
  const int usual = iterations("");
  EXPECT_EQ(iterations("--option relaxation=1 --option initial_slip=guess"), usual);
  EXPECT_GT(iterations("--option relaxation=0.1 --option inner=admm"), usual);
}

TEST_F(FclibSolveTest, ATextLineWithoutJson)
{
  const CommandResult result = solve(localFile());
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(lines(result.output), 1);
  EXPECT_NE(result.output.find("CONVERGED"), std::string::npos) << result.output;
}

TEST_F(FclibSolveTest, NotConvergedIsExitCodeOneWithTheBestIterate)
{
  const CommandResult result = solve(globalFile() + " --json --solver ds_fixed_point --max-iterations 1");
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(nlohmann::json::parse(result.output)["status"], "MAX_ITERATIONS");
}

TEST_F(FclibSolveTest, OutputHoldsTheProblemAndItsSolution)
{
  EXPECT_EQ(solve(localFile() + " --tolerance 1e-12 --output " + file("out.hdf5")).code, 0);
  const FclibProblem local = readFclib(file("out.hdf5"));
  ASSERT_TRUE(local.solution.has_value());
  EXPECT_LT((local.solution->r - Eigen::Vector3d(1, 0.5, 0)).norm(), 1e-10);
  EXPECT_LT((local.solution->u - Eigen::Vector3d(0, -1.5, 0)).norm(), 1e-10);

  EXPECT_EQ(solve(globalFile() + " --tolerance 1e-10 --output " + file("out.hdf5")).code, 0);  // replaces it
  const FclibProblem global = readFclib(file("out.hdf5"));
  ASSERT_EQ(global.kind, FclibKind::GLOBAL);
  ASSERT_TRUE(global.solution.has_value());
  const Solution& answer = *global.solution;
  EXPECT_LE(validateAnswer(global.global, answer.v, answer.r, answer.lambda).worst(), 2e-10);
  // An old solution of FILE does not survive: one iteration's answer replaces it.
  EXPECT_EQ(solve(file("out.hdf5") + " --solver ds_fixed_point --max-iterations 0 --output " + file("next.hdf5")).code,
            1);
  ASSERT_TRUE(readFclib(file("next.hdf5")).solution.has_value());
  EXPECT_EQ(readFclib(file("next.hdf5")).solution->r.norm(), 0.0);
}

TEST_F(FclibSolveTest, HistoryEndsWithTheReportedResidualWhateverTheMethod)
{
  const std::string path = globalFile(), history = file("history.csv");
  for (const SolverEntry& entry : solverRegistry())
  {
    SCOPED_TRACE(entry.name);
    const CommandResult result =
        solve(path + " --json --max-iterations 50 --solver " + entry.name + " --history " + history);
    ASSERT_NE(result.code, 2) << result.errors;
    const nlohmann::json answer = nlohmann::json::parse(result.output);
    const std::string text = textOf(history);
    EXPECT_EQ(text.rfind("iteration,seconds,residual\n", 0), 0u) << text;
    ASSERT_GE(lines(text), entry.name == std::string("enumerate") ? 2 : 3) << text;  // which has no iterates
    const std::string last = text.substr(text.rfind('\n', text.size() - 2) + 1);
    EXPECT_EQ(std::stod(last.substr(last.rfind(',') + 1)), answer["residual"].get<double>()) << last;
  }
}

TEST_F(FclibSolveTest, HistoryMustBeAWritableFileOfItsOwn)
{
  const std::string path = localFile();
  expectRefused(solve(path + " --history " + path), "is FILE itself");
  expectRefused(solve(path + " --history " + file("nowhere/history.csv")), "cannot write");
  expectRefused(solve(path + " --history " + folder_.string()), "cannot write");
  expectRefused(solve(path + " --history " + file("a") + " --output " + file("a")), "is --output as well");
  EXPECT_NE(solve("--help").output.find("--history"), std::string::npos);
}

TEST_F(FclibSolveTest, OutputMustNotBeTheFileAndMustBeWritable)
{
  const std::string path = localFile();
  const std::string before = textOf(path);
  expectRefused(solve(path + " --output " + path), "is FILE itself");
  expectRefused(solve(path + " --output " + file("no/such/folder/out.hdf5")), "cannot be written");
  EXPECT_EQ(textOf(path), before);
}

TEST_F(FclibSolveTest, ArgumentsOutOfTheirRangeAreRefusedWithIt)
{
  const std::string path = localFile();
  expectRefused(solve(path + " --repeat 0"), "not in range 1 to 1000000");
  expectRefused(solve(path + " --repeat many"), "--repeat");
  expectRefused(solve(path + " --tolerance 0"), "tolerance is 0");
  expectRefused(solve(path + " --tolerance nan"), "tolerance is nan");
  expectRefused(solve(path + " --max-iterations -1"), "max_iterations is -1");
  expectRefused(solve(path + " --time-limit -1"), "time_limit is -1");
  expectRefused(solve(path + " --solver best"), "unknown solver 'best', expected one of: portfolio");
  expectRefused(solve(path + " --solver admm --option penlty=2"),
                "admm has no option 'penlty', did you mean 'penalty'?");
  expectRefused(solve(path + " --solver admm --option penalty=-2"), "found '-2', expected a number > 0");
  expectRefused(solve(path + " --solver admm --option penalty"), "--option: found 'penalty', expected NAME=VALUE");
  expectRefused(solve(path + " --solver admm --option penalty=1 --option penalty=2"), "penalty twice");
  expectRefused(solve(path + " --nonsense"), "nonsense");
  expectRefused(solve(""), "FILE is missing");
  EXPECT_EQ(solve("--help").code, 0);
}

TEST_F(FclibSolveTest, FilesThatAreNoneAreRefusedInOneLine)
{
  expectRefused(solve(file("absent.hdf5")), "no such file");
  std::ofstream(file("text.hdf5")) << "not HDF5";
  expectRefused(solve(file("text.hdf5")), "not an HDF5 file");
  const std::string bytes = textOf(globalFile());
  for (const size_t keep : {size_t(0), size_t(100), bytes.size() / 2, bytes.size() - 10})
  {
    std::ofstream(file("cut.hdf5"), std::ios::binary | std::ios::trunc) << bytes.substr(0, keep);
    expectRefused(solve(file("cut.hdf5")), "cut.hdf5");
  }
}

TEST_F(FclibSolveTest, WrongNumbersAreRefusedInOneLine)
{
  constexpr double NOT_A_NUMBER = std::numeric_limits<double>::quiet_NaN();
  std::string path = localFile();
  setEntry(path, "/fclib_local/vectors/q", 1, NOT_A_NUMBER);
  expectRefused(solve(path), "nan");
  path = localFile();
  setEntry(path, "/fclib_local/W/x", 0, std::numeric_limits<double>::infinity());
  expectRefused(solve(path), "inf");
  path = localFile();
  setEntry(path, "/fclib_local/vectors/mu", 0, -0.5);
  expectRefused(solve(path), "-0.5");
  path = localFile();
  shorten(path, "/fclib_local/vectors/q");
  expectRefused(solve(path), "/fclib_local/vectors/q");
  path = globalFile();
  setEntry(path, "/fclib_global/vectors/f", 0, NOT_A_NUMBER);
  expectRefused(solve(path), "nan");
  path = globalFile();
  shorten(path, "/fclib_global/vectors/w");
  expectRefused(solve(path), "/fclib_global/vectors/w");
}

TEST_F(FclibSolveTest, ASingularMassMatrixIsBadInput)
{
  IncrementalProblem problem =
      denseProblem(Eigen::Vector3d(1, 1, 0).asDiagonal(), Eigen::Vector3d(0, 1, 0), Eigen::Matrix3d::Identity(),
                   Eigen::Vector3d::Zero(), {{LawType::COULOMB_3D, 0.5}});
  writeFclib(file("singular.hdf5"), problem, {});
  expectRefused(solve(file("singular.hdf5")), "M is not positive definite");
}

TEST_F(FclibSolveTest, AnUnsymmetricWIsSolvedWithAWarning)
{
  Eigen::Matrix3d W = Eigen::Matrix3d::Identity();
  W(0, 1) = 0.01;
  writeFclib(file("w.hdf5"), localProblem(W, Eigen::Vector3d(-1, -2, 0), {{LawType::COULOMB_3D, 0.5}}), {});
  const CommandResult result = solve(file("w.hdf5") + " --json");
  EXPECT_EQ(result.code, 0);
  EXPECT_NE(result.errors.find("warning"), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("not symmetric"), std::string::npos) << result.errors;
  EXPECT_EQ(nlohmann::json::parse(result.output)["status"], "CONVERGED");
}

TEST_F(FclibSolveTest, ZeroContactsAreAProblemToo)
{
  RandomProblemOptions options;
  options.contacts = 0;
  options.bilaterals = 2;
  writeFclib(file("free.hdf5"), randomProblem(options, 4), {});
  const CommandResult result = solve(file("free.hdf5") + " --json");
  EXPECT_EQ(result.code, 0) << result.errors;
  const nlohmann::json answer = nlohmann::json::parse(result.output);
  EXPECT_EQ(answer["contacts"], 0);
  EXPECT_EQ(answer["status"], "CONVERGED");
}

TEST_F(FclibSolveTest, InfeasibleProblemsEndWithExitCodeOne)
{
  writeFclib(file("disc.hdf5"), squeezedDisc(1.0, 0.5), {});
  const CommandResult result = solve(file("disc.hdf5") + " --json");
  EXPECT_EQ(result.code, 1) << result.output;
  EXPECT_NE(nlohmann::json::parse(result.output)["message"], "");
}

TEST_F(FclibSolveTest, SharedFilesAreSolvedAndTheRollingOneIsRefused)
{
  if (!fs::exists(sharedFolder()))
    std::cout << "shared/fclib is absent: nothing to solve\n";
  for (const char* name : {"Rover3865", "GFC3D_TwoRods1-condensed", "FC2D_SliderCrankLagrangian00000"})
  {
    const fs::path path = sharedFolder() / (std::string(name) + ".hdf5");
    if (fs::exists(path))
    {
      EXPECT_EQ(solve(path.string()).code, 0) << name;
    }
  }
  const fs::path rolling = sharedFolder() / "Chute-ndof-768-nc-4-3.hdf5";
  if (fs::exists(rolling))
    expectRefused(solve(rolling.string()), "rolling");
}
