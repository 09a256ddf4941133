/**
 * @file conformance_test.cpp
 * @brief The whole registry over the problem library: every CONVERGED is confirmed by the independent validator.
 */
#include <gtest/gtest.h>

#include <filesystem>

#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/solver/registry.h"
#include "judgement.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
namespace fs = std::filesystem;

namespace
{
/// The methods every small problem must be solved by.
const std::vector<std::string> MUST_CONVERGE = {"portfolio", "ac_newton", "gauss_seidel"};

bool mustConverge(const std::string& name)
{
  return std::find(MUST_CONVERGE.begin(), MUST_CONVERGE.end(), name) != MUST_CONVERGE.end();
}

struct NamedProblem
{
  std::string name;
  IncrementalProblem problem;
};

std::vector<NamedProblem> smallProblems()
{
  const Eigen::Vector3d gravity(0, 0, -9.81), still(0, 0, 0);
  std::vector<NamedProblem> problems;
  problems.push_back({"resting box", restingBox(10, {0.5, 0.3, 0.2}, 0.5, still, gravity, 1e-3)});
  problems.push_back({"sliding box", restingBox(10, {0.5, 0.3, 0.1}, 0.5, {1, -2, 0}, gravity, 1e-3)});
  problems.push_back({"falling box", restingBox(10, {0.5, 0.3, 0.1}, 0.5, {1, 0.5, -2}, gravity, 1e-3)});
  problems.push_back({"rising box", restingBox(10, {0.5, 0.3, 0.1}, 0.5, {1, 0, 2}, gravity, 1e-3)});
  problems.push_back({"box without friction", restingBox(10, {0.5, 0.3, 0.1}, 0.0, {1, 0, 0}, gravity, 1e-3)});
  problems.push_back({"square on two contacts", squareOnTwoContacts()});
  for (std::uint32_t seed = 1; seed <= 12; ++seed)
  {
    RandomProblemOptions options;
    options.bodies = 3 + static_cast<int>(seed % 3);
    options.contacts = 4 + static_cast<int>(seed % 5);
    options.planar_contacts = static_cast<int>(seed % 3);
    options.unilateral = static_cast<int>(seed % 2);
    options.dry = static_cast<int>(seed % 2);
    options.bilaterals = seed % 4 == 0 ? 3 : 0;
    problems.push_back({"random " + std::to_string(seed), randomProblem(options, seed)});
  }
  return problems;
}

std::vector<fs::path> sharedFiles()
{
  std::vector<fs::path> files;
  const fs::path folder = fs::path(PROJECT_DIR) / ".." / "shared" / "fclib";
  if (!fs::exists(folder))
  {
    std::cout << "shared/fclib is absent: its problems are not run\n";
    return files;
  }
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".hdf5" && entry.path().filename().string().rfind("Chute", 0) != 0)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}
}  // namespace

TEST(ConformanceTest, SmallProblems)
{
  const std::vector<NamedProblem> problems = smallProblems();
  for (const SolverEntry& entry : solverRegistry())
  {
    const std::unique_ptr<Solver> solver = entry.create();
    solver->setStopping(budget(2000, 1.0));
    for (const NamedProblem& item : problems)
    {
      const SolverResult result = solver->solve(item.problem);
      const std::string where = std::string(entry.name) + " on " + item.name + ": " + toString(result.status);
      expectConfirmed(item.problem, result, where);
      if (mustConverge(entry.name))
      {
        EXPECT_EQ(result.status, SolverStatus::CONVERGED) << where << " E = " << result.residual;
      }
    }
  }
}

TEST(ConformanceTest, MethodsAgreeOnTheVelocitiesWhereTheyAreUnique)
{
  // Little friction and a full-rank H: the solution is unique, and velocities agree to the tolerance times the
  // condition.
  RandomProblemOptions options;
  options.contacts = 5;
  for (std::uint32_t seed = 1; seed <= 10; ++seed)
  {
    IncrementalProblem problem = randomProblem(options, seed);
    for (Law& law : problem.laws)
      law.coefficient = 0.02;
    const std::unique_ptr<Solver> reference = createSolver("ac_newton");
    reference->setStopping(budget(1000, 0.0));
    const SolverResult expected = reference->solve(problem);
    ASSERT_EQ(expected.status, SolverStatus::CONVERGED);
    for (const SolverEntry& entry : solverRegistry())
    {
      const std::unique_ptr<Solver> solver = entry.create();
      solver->setStopping(budget(2000, 1.0));
      const SolverResult result = solver->solve(problem);
      if (result.status == SolverStatus::CONVERGED)
      {
        EXPECT_LT((result.solution.v - expected.solution.v).norm(), 1e-5) << entry.name << " seed " << seed;
      }
    }
  }
}

TEST(ConformanceTest, SharedProblemsByEveryMethodWithinASmallBudget)
{
  for (const fs::path& path : sharedFiles())
  {
    const FclibProblem problem = readFclib(path.string());
    for (const SolverEntry& entry : solverRegistry())
    {
      const std::unique_ptr<Solver> solver = entry.create();
      solver->setStopping(budget(300, 0.2));
      const std::string where = std::string(entry.name) + " on " + path.filename().string();
      if (problem.kind == FclibKind::GLOBAL)
        expectConfirmed(problem.global, solver->solve(problem.global), where);
      else
        expectConfirmed(problem.local, solver->solve(problem.local), where);
    }
  }
}

TEST(ConformanceTest, ThePortfolioSolvesEverySharedProblem)
{
  for (const fs::path& path : sharedFiles())
  {
    const FclibProblem problem = readFclib(path.string());
    const std::unique_ptr<Solver> solver = createSolver("portfolio");
    solver->setStopping(budget(5000, 0.0));
    SolverResult result;
    if (problem.kind == FclibKind::GLOBAL)
    {
      solver->solve(problem.global, nullptr, result);
      expectConfirmed(problem.global, result, path.filename().string());
    }
    else
    {
      solver->solve(problem.local, nullptr, result);
      expectConfirmed(problem.local, result, path.filename().string());
    }
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << path.filename() << " E = " << result.residual;
  }
}
