#include "frictional_contact_sim/problem/fclib.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;

namespace
{
class FclibTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("fclib_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  static std::string errorOf(const std::string& path)
  {
    try
    {
      readFclib(path);
    }
    catch (const std::runtime_error& error)
    {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

Solution solve(const IncrementalProblem& problem)
{
  const std::unique_ptr<Solver> solver = createSolver("ac_newton");
  StoppingOptions stopping;
  stopping.tolerance = 1e-12;
  solver->setStopping(stopping);
  const SolverResult result = solver->solve(problem);
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message;
  return result.solution;
}

IncrementalProblem everyLaw()
{
  RandomProblemOptions options;
  options.planar_contacts = 2;
  options.unilateral = 2;
  options.dry = 2;
  options.bilaterals = 2;
  return randomProblem(options, 8);
}

std::vector<fs::path> sharedFiles()
{
  std::vector<fs::path> files;
  const fs::path folder = fs::path(PROJECT_DIR) / ".." / "shared" / "fclib";
  if (!fs::exists(folder))
    return files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".hdf5")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}
}  // namespace

TEST_F(FclibTest, AGlobalProblemOfContactsComesBackBitForBit)
{
  RandomProblemOptions options;
  options.bilaterals = 3;
  const IncrementalProblem problem = randomProblem(options, 2);
  const Solution solution = solve(problem);
  writeFclib(file("a.hdf5"), problem, {"title", "with shift in w", "random"}, &solution);
  const FclibProblem read = readFclib(file("a.hdf5"));
  EXPECT_EQ(read.kind, FclibKind::GLOBAL);
  EXPECT_EQ(read.dimension, 3);
  EXPECT_EQ(read.info.description, "with shift in w");
  EXPECT_EQ(Eigen::MatrixXd(read.global.M), Eigen::MatrixXd(problem.M));
  EXPECT_EQ(Eigen::MatrixXd(read.global.H), Eigen::MatrixXd(problem.H));
  EXPECT_EQ(Eigen::MatrixXd(read.global.G), Eigen::MatrixXd(problem.G));
  EXPECT_EQ(read.global.f, problem.f);
  EXPECT_EQ(read.global.w, problem.w);
  EXPECT_EQ(read.global.b, problem.b);
  ASSERT_TRUE(read.solution.has_value());
  EXPECT_EQ(read.solution->v, solution.v);
  EXPECT_EQ(read.solution->r, solution.r);
  EXPECT_EQ(read.solution->lambda, solution.lambda);
}

TEST_F(FclibTest, TheEncodingOfEveryLawKeepsTheSolution)
{
  const IncrementalProblem problem = everyLaw();
  const Solution solution = solve(problem);
  writeFclib(file("mixed.hdf5"), problem, {}, &solution);
  const FclibProblem read = readFclib(file("mixed.hdf5"));
  EXPECT_EQ(read.contacts, 6 + 2 + 2 + 2);
  EXPECT_EQ(read.global.velocities(), problem.velocities() + 2);
  // The stored answer solves the encoded problem as well as it solved the original one.
  ASSERT_TRUE(read.solution.has_value());
  EXPECT_LT(evaluateResidual(read.global, *read.solution).value(), 1e-11);
  // And solving the encoded problem gives the original velocities.
  const Solution again = solve(read.global);
  EXPECT_LT((again.v.head(problem.velocities()) - solution.v).norm(), 1e-8);
}

TEST_F(FclibTest, ALocalProblemWithBilateralRowsComesBack)
{
  const Eigen::MatrixXd A =
      (Eigen::MatrixXd(5, 5) << 1, 2, 0, 1, 0, 0, 1, 1, 0, 2, 3, 0, 1, 1, 1, 1, 1, 2, 0, 0, 0, 1, 0, 3, 1).finished();
  const DelassusProblem problem =
      localProblem(A * A.transpose(), Eigen::VectorXd::LinSpaced(5, -2, 1),
                   {{LawType::COULOMB_3D, 0.4}, {LawType::BILATERAL, 0.0}, {LawType::BILATERAL, 0.0}});
  writeFclib(file("local.hdf5"), problem, {});
  const FclibProblem read = readFclib(file("local.hdf5"));
  EXPECT_EQ(read.kind, FclibKind::LOCAL);
  EXPECT_EQ(read.local.W.toDense(), problem.W.toDense());
  EXPECT_EQ(read.local.q, problem.q);
  ASSERT_EQ(read.local.laws.size(), 3u);
  EXPECT_EQ(read.local.laws[2].type, LawType::BILATERAL);
}

TEST_F(FclibTest, AnExistingFileIsReplacedWithItsOldSolution)
{
  const IncrementalProblem problem = randomProblem({}, 2);
  const Solution solution = solve(problem);
  writeFclib(file("a.hdf5"), problem, {}, &solution);
  writeFclib(file("a.hdf5"), problem, {});
  EXPECT_FALSE(readFclib(file("a.hdf5")).solution.has_value());
}

TEST_F(FclibTest, BrokenFilesAreOneLineErrorsNotTheEndOfTheProcess)
{
  EXPECT_NE(errorOf(file("absent.hdf5")).find("no such file"), std::string::npos);
  std::ofstream(file("text.hdf5")) << "not HDF5";
  EXPECT_NE(errorOf(file("text.hdf5")).find("not an HDF5 file"), std::string::npos);
  EXPECT_NE(errorOf(folder_.string()), "");

  // Every truncation of a good file must be refused or read, never crash.
  writeFclib(file("good.hdf5"), randomProblem({}, 2), {});
  std::ifstream input(file("good.hdf5"), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(input)), std::istreambuf_iterator<char>());
  for (const size_t keep : {size_t(100), bytes.size() / 4, bytes.size() / 2, bytes.size() - 10})
  {
    std::ofstream(file("cut.hdf5"), std::ios::binary | std::ios::trunc) << bytes.substr(0, keep);
    const std::string error = errorOf(file("cut.hdf5"));
    EXPECT_NE(error, "");
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST_F(FclibTest, UnwritablePlacesAreOneLineErrors)
{
  EXPECT_THROW(writeFclib(file("no/such/folder/a.hdf5"), randomProblem({}, 2), {}), std::runtime_error);
}

TEST_F(FclibTest, ThreadsWriteAndReadTheirOwnFilesAndOneOfBoth)
{
  const IncrementalProblem problems[2] = {randomProblem({}, 1), randomProblem({}, 2)};
  const std::string shared = file("shared.hdf5");
  const auto work = [&](int k, bool& well)
  {
    const std::string own = file("own" + std::to_string(k) + ".hdf5");
    for (int round = 0; round < 30; ++round)
    {
      writeFclib(own, problems[k], {});
      writeFclib(shared, problems[k], {});
      well = well && readFclib(own).global.f == problems[k].f;
      const Eigen::VectorXd f = readFclib(shared).global.f;
      well = well && (f == problems[0].f || f == problems[1].f);
    }
  };
  bool well[2] = {true, true};
  std::thread first(work, 0, std::ref(well[0])), second(work, 1, std::ref(well[1]));
  first.join();
  second.join();
  EXPECT_TRUE(well[0]);
  EXPECT_TRUE(well[1]);
  // Nothing is left beside the three files.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 3);
}

TEST_F(FclibTest, SharedFilesAreReadAndTheRollingOneRefused)
{
  const std::vector<fs::path> files = sharedFiles();
  if (files.empty())
    std::cout << "shared/fclib is absent: nothing to read\n";
  for (const fs::path& path : files)
  {
    const std::string name = path.filename().string();
    if (name.rfind("Chute", 0) == 0)
    {
      EXPECT_NE(errorOf(path.string()).find("rolling"), std::string::npos);
      continue;
    }
    const FclibProblem problem = readFclib(path.string());
    EXPECT_GT(problem.contacts, 0) << name;
    if (problem.kind == FclibKind::GLOBAL)
      EXPECT_NO_THROW(validate(problem.global)) << name;
    else
      EXPECT_NO_THROW(validate(problem.local)) << name;
  }
}

TEST_F(FclibTest, ScalesOfASimulationComeBackAndBadOnesAreNamed)
{
  RandomProblemOptions options;
  options.unilateral = 2;
  options.dry = 1;
  options.bilaterals = 1;
  IncrementalProblem problem = randomProblem(options, 4);
  for (size_t i = 0; i < problem.laws.size(); ++i)
    problem.scales.push_back(
        {problem.laws[i].isCoulomb() ? VelocityUnit::LENGTH : VelocityUnit::ANGLE, 0.5 + i, 0.01, 3.0});
  problem.bilateral_scales.push_back({VelocityUnit::ANGLE, 0.25, 0.01, 3.0});
  const std::string path = ::testing::TempDir() + "/scales.hdf5";
  writeFclib(path, problem, {});
  const IncrementalProblem read = readFclib(path).global;
  ASSERT_EQ(read.scales.size(), problem.scales.size());
  for (size_t i = 0; i < read.scales.size(); ++i)
  {
    EXPECT_EQ(read.scales[i].reach, problem.scales[i].reach);
    EXPECT_EQ(read.scales[i].speed_change, 0.01);
    EXPECT_EQ(read.scales[i].speed, 3.0);
    const bool threshold = problem.laws[i].type == LawType::DRY_FRICTION;  // written with a velocity of its own
    EXPECT_EQ(read.scales[i].unit, threshold ? VelocityUnit::SLACK : problem.scales[i].unit);
  }
  ASSERT_EQ(read.bilateral_scales.size(), 1u);
  EXPECT_EQ(read.bilateral_scales[0].reach, 0.25);
  problem.scales[0].reach = 0.0;
  EXPECT_THROW(writeFclib(path, problem, {}), std::invalid_argument);
}
