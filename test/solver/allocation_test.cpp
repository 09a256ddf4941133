/**
 * @file allocation_test.cpp
 * @brief Methods that run in every step allocate nothing once they know the problem's shape.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/solver/portfolio.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/allocation_counter.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
StoppingOptions stopping()
{
  StoppingOptions options;
  options.max_iterations = 60;
  return options;
}

/// Allocations of the second solve of a shape; the second problem's contacts open and close otherwise.
template <typename Problem>
long allocations(Solver& solver, const Problem& first, const Problem& second)
{
  solver.setStopping(stopping());
  SolverResult result;
  solver.solve(first, nullptr, result);
  solver.solve(second, nullptr, result);
  const AllocationCounter counter;
  solver.solve(first, nullptr, result);
  EXPECT_GT(result.iterations, 0) << solver.name();
  return counter.count();
}

template <typename Problem>
long allocations(const std::string& name, const Problem& first, const Problem& second)
{
  return allocations(*createSolver(name), first, second);
}

DelassusProblem reversed(const DelassusProblem& problem)
{
  DelassusProblem result = problem;
  result.q *= -0.7;
  return result;
}

/// A chain of bodies, one contact between neighbours: one island, block-sparse, more rows than any dense limit.
IncrementalProblem chain(int bodies)
{
  RandomProblemOptions options;
  options.bodies = bodies;
  options.contacts = bodies - 1;
  IncrementalProblem problem = randomProblem(options, 5);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(problem.rows(), problem.velocities());
  std::srand(5);
  for (int i = 0; i + 1 < bodies; ++i)
    H.block<3, 12>(3 * i, 6 * i).setRandom();
  problem.H = sparse(H);
  return problem;
}

constexpr const char* EVERY_STEP[] = {"gauss_seidel", "ac_newton", "portfolio"};
/// Not asked for, but true where W is dense; the others factor with Eigen or build their inner problem anew.
constexpr const char* ALSO[] = {"ds_newton", "ds_fixed_point", "ac_fixed_point", "fb_newton", "fb_bfgs",
                                "haslinger", "cadoux_newton",  "interior_point", "admm"};

template <typename Problem>
void expectNoneWhereDense(const Problem& first, const Problem& second)
{
  for (const char* name : EVERY_STEP)
    EXPECT_EQ(allocations(name, first, second), 0) << name;
  for (const char* name : ALSO)
    EXPECT_EQ(allocations(name, first, second), 0) << name;
}
}  // namespace

TEST(AllocationTest, DenseLocalProblems)
{
  const DelassusProblem problem = reduce(randomProblem({}, 1));
  ASSERT_TRUE(problem.W.isDense());
  expectNoneWhereDense(problem, reversed(problem));
}

TEST(AllocationTest, SparseLocalProblems)
{
  const DelassusProblem problem = reduce(chain(60));
  ASSERT_FALSE(problem.W.isDense());
  ASSERT_GT(problem.W.rows(), 150);
  for (const char* name : EVERY_STEP)
    EXPECT_EQ(allocations(name, problem, reversed(problem)), 0) << name;
}

TEST(AllocationTest, PortfolioThatBeginsWithHaslingerAndSweeps)
{
  PortfolioOptions options;
  options.newton_first_rows = options.newton_try_rows = 0;
  Portfolio portfolio(options);
  const DelassusProblem problem = reduce(chain(60));
  EXPECT_EQ(allocations(portfolio, problem, reversed(problem)), 0);
}

TEST(AllocationTest, GlobalProblemsWithBilaterals)
{
  RandomProblemOptions options;
  options.bilaterals = 3;
  const IncrementalProblem problem = randomProblem(options, 1);
  IncrementalProblem other = problem;
  other.f *= -0.7;
  expectNoneWhereDense(problem, other);
}
