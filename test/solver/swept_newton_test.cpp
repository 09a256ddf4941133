/**
 * @file swept_newton_test.cpp
 * @brief Newton steps followed by sweeps, on packings of balls.
 */
#include "frictional_contact_sim/solver/swept_newton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/rigid_families.h"
#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/portfolio.h"

using namespace frictional_contact_sim;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace
{
DelassusProblem packing(int contacts, std::uint64_t seed)
{
  RigidFamilyOptions options;
  options.seed = seed;
  return reduce(granularProblem(contacts, 0, options));
}

StoppingOptions steps(int count)
{
  StoppingOptions stopping;
  stopping.tolerance = 1e-8;
  stopping.max_iterations = count;
  return stopping;
}
}  // namespace

TEST(SweptNewtonTest, APackingTakesFewerFactorizationsThanTheLineSearch)
{
  // One factorization an iteration. In the portfolio, on 3 seeds: 6 to 11 with sweeps, 84 and more with the line
  // search.
  const DelassusProblem problem = packing(1000, 2);
  SweptNewton swept;
  swept.setStopping(steps(60));
  AcNewton plain;
  plain.setStopping(steps(60));
  const SolverResult result = swept.solve(problem);
  EXPECT_EQ(result.status, SolverStatus::CONVERGED);
  EXPECT_LT(result.iterations, plain.solve(problem).iterations);
}

TEST(SweptNewtonTest, SolvesAPackingWhoseFactorIsDissected)
{
  // More than 5000 active rows, where the ordering changes.
  SweptNewton swept;
  swept.setStopping(steps(60));
  const DelassusProblem problem = packing(2500, 1);
  const SolverResult first = swept.solve(problem);
  EXPECT_LT(first.residual, 1e-5);
  // One thread of BLAS: the same bits again.
  EXPECT_EQ(swept.solve(problem).solution.r, first.solution.r);
}

TEST(SweptNewtonTest, ReturnsTheBestIterateWhenStepsEnd)
{
  const DelassusProblem problem = packing(300, 1);
  SweptNewton swept;
  double last = 1.0;
  for (const int count : {0, 1, 2, 4, 8})
  {
    swept.setStopping(steps(count));
    const SolverResult result = swept.solve(problem);
    EXPECT_LE(result.iterations, count);
    // More steps repeat the same way and go on: the best of them can only be better.
    EXPECT_LE(result.residual, last);
    last = result.residual;
  }
}

TEST(SweptNewtonTest, OptionsNameTheFieldAndItsValue)
{
  SweptNewtonOptions options;
  options.sweeps = 0;
  EXPECT_THAT([&] { SweptNewton{options}; },
              ThrowsMessage<std::invalid_argument>(HasSubstr("swept_newton.sweeps is 0")));
  options = {};
  options.worst = 0.5;
  EXPECT_THAT([&] { SweptNewton{options}; },
              ThrowsMessage<std::invalid_argument>(HasSubstr("swept_newton.worst is 0.5")));
}

TEST(PortfolioTest, PackingsOfThousandContactsTakeAtMostTwoHundredIterations)
{
  // Sweeps and Newton steps together: 66 to 71; without Newton with sweeps the second was unsolved after 549.
  for (const std::uint64_t seed : {1, 2, 3})
  {
    Portfolio portfolio;
    portfolio.setStopping(steps(200));
    const SolverResult result = portfolio.solve(packing(1000, seed));
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << "seed " << seed << ": " << result.message;
    EXPECT_LE(result.residual, 1e-8) << "seed " << seed;
  }
}
