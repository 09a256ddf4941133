#pragma once
/**
 * @file judgement.h
 * @brief How the tests judge any solver's answer: CONVERGED is believed only when the independent validator agrees.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/solver/registry.h"
#include "support/validator.h"

namespace frictional_contact_sim
{
namespace test_support
{
constexpr double TOLERANCE = 1e-8;
/// Two evaluations of one residual agree but for round-off, magnified by the condition of the problem.
constexpr double CONFIRMED = 1.001 * TOLERANCE;
inline StoppingOptions budget(int iterations, double seconds = 0.0, double tolerance = TOLERANCE)
{
  StoppingOptions options;
  options.tolerance = tolerance;
  options.max_iterations = iterations;
  options.time_limit = seconds;
  return options;
}

inline void expectConfirmed(const Verdict& verdict, const SolverResult& result, const std::string& where)
{
  EXPECT_TRUE(result.solution.r.allFinite() && result.solution.v.allFinite() && result.solution.u.allFinite()) << where;
  EXPECT_TRUE(std::isfinite(result.residual)) << where;
  EXPECT_NE(result.status, SolverStatus::NOT_RUN) << where;
  if (result.status != SolverStatus::CONVERGED)
  {
    EXPECT_FALSE(result.message.empty()) << where;
    return;
  }
  EXPECT_LE(verdict.worst(), CONFIRMED) << where;
}

inline void expectConfirmed(const IncrementalProblem& problem, const SolverResult& result, const std::string& where)
{
  expectConfirmed(validateAnswer(problem, result.solution.v, result.solution.r, result.solution.lambda), result, where);
}

inline void expectConfirmed(const DelassusProblem& problem, const SolverResult& result, const std::string& where)
{
  expectConfirmed(validateAnswer(problem, result.solution.r), result, where);
}

/** @brief One solver on one problem, judged. */
inline SolverResult solveAndJudge(const SolverEntry& entry, const IncrementalProblem& problem, const std::string& what,
                                  const Solution* guess = nullptr, int iterations = 2000)
{
  const std::unique_ptr<Solver> solver = entry.create();
  solver->setStopping(budget(iterations));
  SolverResult result;
  solver->solve(problem, guess, result);
  expectConfirmed(problem, result, std::string(entry.name) + " on " + what + ": " + toString(result.status));
  return result;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
