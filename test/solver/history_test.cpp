/**
 * @file history_test.cpp
 * @brief What a result tells beside the answer, for the whole registry: the history of the residual, the laws' errors.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/law_functions.h"
#include "frictional_contact_sim/solver/registry.h"
#include "frictional_contact_sim/solver/swept_newton.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
StoppingOptions stopping(bool record_history)
{
  StoppingOptions options;
  options.max_iterations = 100;
  options.record_history = record_history;
  return options;
}

std::vector<std::unique_ptr<Solver>> everyMethod()
{
  std::vector<std::unique_ptr<Solver>> methods;
  for (const SolverEntry& entry : solverRegistry())
    methods.push_back(entry.create());
  methods.push_back(std::make_unique<SweptNewton>());
  return methods;
}

/** Six contacts in one island, or in several when there are many bodies. */
IncrementalProblem contacts(int bodies, std::uint32_t seed)
{
  RandomProblemOptions options;
  options.bodies = bodies;
  options.contacts = 6;
  return randomProblem(options, seed);
}

template <typename Problem>
void expectHistory(Solver& solver, const Problem& problem)
{
  SCOPED_TRACE(solver.name());
  solver.setStopping(stopping(true));
  const SolverResult result = solver.solve(problem);
  ASSERT_FALSE(result.history.empty());
  int iteration = 0;
  double seconds = 0.0;
  for (const HistoryEntry& entry : result.history)
  {
    EXPECT_GE(entry.iteration, iteration);
    EXPECT_GE(entry.seconds, seconds);
    iteration = entry.iteration;
    seconds = entry.seconds;
  }
  EXPECT_GE(iteration, result.iterations);
  EXPECT_EQ(result.history.back().residual, result.residual);
  EXPECT_EQ(result.history.back().seconds, result.seconds);
  // Beside the answer there is what the method itself saw.
  if (result.iterations > 0)
  {
    EXPECT_GE(result.history.size(), solver.name() == "enumerate" ? 1u : 2u);
  }

  solver.setStopping(stopping(false));
  const SolverResult without = solver.solve(problem);
  EXPECT_TRUE(without.history.empty());
  EXPECT_EQ(without.solution.r, result.solution.r);
  EXPECT_EQ(without.solution.u, result.solution.u);
  EXPECT_EQ(without.residual, result.residual);
  EXPECT_EQ(without.iterations, result.iterations);
  EXPECT_EQ(without.message, result.message);
}

void expectLawErrors(const std::vector<Law>& laws, const DelassusProblem& local, const SolverResult& result)
{
  Eigen::VectorXd rho;
  computeStepLengths(local, rho);
  ASSERT_EQ(result.law_errors.size(), static_cast<Eigen::Index>(laws.size()));
  int row = 0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const auto index = static_cast<Eigen::Index>(i);
    EXPECT_EQ(result.law_errors[index],
              naturalMapError(laws[i], result.solution.u.data() + row, result.solution.r.data() + row, rho[index]));
    row += laws[i].dimension();
  }
}
}  // namespace

TEST(HistoryTest, EveryMethodTellsItsIteratesAndRecordingChangesNoBit)
{
  for (const std::unique_ptr<Solver>& solver : everyMethod())
    for (const std::uint32_t seed : {2u, 3u})
    {
      expectHistory(*solver, contacts(3, seed));
      expectHistory(*solver, reduce(contacts(3, seed)));
    }
}

TEST(HistoryTest, IslandsFollowEachOther)
{
  for (const std::unique_ptr<Solver>& solver : everyMethod())
    expectHistory(*solver, contacts(24, 4));
}

TEST(HistoryTest, OneEntryAtLeastForEachStepOfNewtonAndTheResidualFalls)
{
  const std::unique_ptr<Solver> solver = createSolver("ac_newton");
  StoppingOptions whole = stopping(true);
  whole.split_islands = false;
  solver->setStopping(whole);
  const SolverResult result = solver->solve(reduce(contacts(3, 2)));
  ASSERT_EQ(result.status, SolverStatus::CONVERGED);
  ASSERT_GT(result.iterations, 1);
  EXPECT_GT(result.history.size(), static_cast<size_t>(result.iterations));
  EXPECT_EQ(result.history.front().iteration, 0);
  EXPECT_GT(result.history.front().residual, 1e-3);
  EXPECT_EQ(result.history.back().iteration, result.iterations);
}

TEST(HistoryTest, AResultUsedAgainTellsTheLastSolveOnly)
{
  const std::unique_ptr<Solver> solver = createSolver("portfolio");
  solver->setStopping(stopping(true));
  SolverResult result;
  solver->solve(contacts(3, 2), nullptr, result);
  const size_t count = result.history.size();
  solver->solve(contacts(3, 2), nullptr, result);
  EXPECT_EQ(result.history.size(), count);
}

TEST(LawErrorsTest, AreTheNaturalMapOfTheReportedAnswerWithTheLocalStepLengths)
{
  for (const char* name : {"portfolio", "gauss_seidel", "admm"})
    for (const int bodies : {3, 24})
    {
      SCOPED_TRACE(name);
      // Few iterations: there must be errors to tell.
      StoppingOptions options = stopping(false);
      options.max_iterations = 2;
      const std::unique_ptr<Solver> solver = createSolver(name);
      solver->setStopping(options);
      const IncrementalProblem problem = contacts(bodies, 2);
      const DelassusProblem local = reduce(problem);
      expectLawErrors(problem.laws, local, solver->solve(problem));
      const SolverResult result = solver->solve(local);
      expectLawErrors(local.laws, local, result);
      EXPECT_GT(result.law_errors.maxCoeff(), 0.0);
    }
}
