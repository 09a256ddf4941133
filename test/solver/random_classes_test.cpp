/**
 * @file random_classes_test.cpp
 * @brief Classes of random problems with fixed seeds by every method. CONVERGED only where
 * the independent validator confirms it; the portfolio has to solve the classes it is meant for.
 */
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "judgement.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
constexpr std::uint32_t SEEDS = 4;
constexpr int CONTACTS = 8;
constexpr int ITERATIONS = 400;

struct Gaussian
{
  std::mt19937 engine;
  std::normal_distribution<double> normal;
  explicit Gaussian(std::uint32_t seed) : engine(seed) {}
  MatrixXd operator()(Eigen::Index rows, Eigen::Index columns)
  {
    return MatrixXd::NullaryExpr(rows, columns, [this]() { return normal(engine); });
  }
};

std::vector<Law> contacts(int count, double friction)
{
  return std::vector<Law>(static_cast<size_t>(count), Law{LawType::COULOMB_3D, friction});
}

/// H with 3 n_c rows of rank 3 n_c / ratio, w = 0: solvable always (Cadoux 2009, chapter 3).
IncrementalProblem rankDeficient(int ratio, std::uint32_t seed)
{
  Gaussian gaussian(seed);
  const int velocities = 3 * CONTACTS / ratio;
  const MatrixXd A = gaussian(velocities, velocities);
  return denseProblem(A * A.transpose() + MatrixXd::Identity(velocities, velocities), gaussian(velocities, 1),
                      gaussian(3 * CONTACTS, velocities), VectorXd::Zero(3 * CONTACTS), contacts(CONTACTS, 0.4));
}

/// M with eigenvalues from 1 to `condition` in equal ratios, in random axes.
IncrementalProblem conditioned(double condition, double friction, std::uint32_t seed)
{
  Gaussian gaussian(seed);
  const Eigen::Index size = 3 * CONTACTS;
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(gaussian(size, size)).householderQ();
  const VectorXd eigenvalues = VectorXd::LinSpaced(size, 0.0, std::log(condition)).array().exp();
  const MatrixXd M = Q * eigenvalues.asDiagonal() * Q.transpose();
  return denseProblem(0.5 * (M + M.transpose()), M * gaussian(size, 1), gaussian(size, size), VectorXd::Zero(size),
                      contacts(CONTACTS, friction));
}

/// Free bodies a million times heavier than their neighbours.
IncrementalProblem massRatio(double ratio, std::uint32_t seed)
{
  IncrementalProblem problem = randomProblem({}, seed);
  MatrixXd M = problem.M;
  for (Eigen::Index body = 0; body < M.rows() / 6; body += 2)
  {
    M.block<6, 6>(6 * body, 6 * body) *= ratio;
    problem.f.segment<6>(6 * body) *= ratio;
  }
  problem.M = sparse(M);
  return problem;
}

IncrementalProblem withFriction(double friction, std::uint32_t seed)
{
  RandomProblemOptions options;
  options.moving_externals = true;
  IncrementalProblem problem = randomProblem(options, seed);
  for (Law& law : problem.laws)
    law.coefficient = friction;
  return problem;
}

/// A last contact opposite to the first, approaching: u_N and -u_N - 1 cannot both be >= 0.
IncrementalProblem infeasible(std::uint32_t seed)
{
  IncrementalProblem problem = randomProblem({}, seed);
  const MatrixXd H = problem.H;
  MatrixXd rows(H.rows() + 3, H.cols());
  rows << H, -H.topRows(3);
  VectorXd w = VectorXd::Zero(rows.rows());
  w[H.rows()] = -1.0;
  problem.H = sparse(rows);
  problem.w = w;
  problem.laws.push_back(problem.laws.front());
  return problem;
}

/// Every method on the problems of a class; the number the portfolio solved.
template <typename Maker>
int portfolioSolves(const std::string& what, Maker make)
{
  int solved = 0;
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    const IncrementalProblem problem = make(seed);
    for (const SolverEntry& entry : solverRegistry())
    {
      const SolverResult result =
          solveAndJudge(entry, problem, what + ", seed " + std::to_string(seed), nullptr, ITERATIONS);
      solved += std::string(entry.name) == "portfolio" && result.status == SolverStatus::CONVERGED;
    }
  }
  return solved;
}
}  // namespace

TEST(RandomClassTest, RankDeficient)
{
  for (const int ratio : {1, 2, 4, 8})
    EXPECT_EQ(portfolioSolves("3 n_c / rank = " + std::to_string(ratio),
                              [&](std::uint32_t seed) { return rankDeficient(ratio, seed); }),
              static_cast<int>(SEEDS))
        << ratio;
}

TEST(RandomClassTest, IllConditioned)
{
  for (const double condition : {1e3, 1e6, 1e9, 1e12})
  {
    const int solved = portfolioSolves("condition " + std::to_string(condition),
                                       [&](std::uint32_t seed) { return conditioned(condition, 0.1, seed); });
    // From 1e9 on u = W r + q has lost the digits that 1e-8 asks for: honesty is all that is required.
    if (condition < 1e8)
    {
      EXPECT_EQ(solved, static_cast<int>(SEEDS)) << condition;
    }
  }
}

TEST(RandomClassTest, MassRatioOfAMillion)
{
  EXPECT_EQ(portfolioSolves("mass ratio 1e6", [](std::uint32_t seed) { return massRatio(1e6, seed); }),
            static_cast<int>(SEEDS));
}

TEST(RandomClassTest, FrictionFromNothingToTen)
{
  for (const double friction : {0.0, 1e-6, 0.1, 1.0, 10.0})
  {
    const int solved = portfolioSolves("mu = " + std::to_string(friction),
                                       [&](std::uint32_t seed) { return withFriction(friction, seed); });
    // Above 1 the moving surroundings may wedge: existence is not certain.
    EXPECT_GE(solved, friction <= 1.0 ? static_cast<int>(SEEDS) : 2) << friction;
  }
}

TEST(RandomClassTest, SlightlyUnsymmetric)
{
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    const DelassusProblem symmetric = reduce(randomProblem({}, seed));
    MatrixXd W = symmetric.W.toDense();
    Gaussian gaussian(seed + 100);
    W += 1e-5 * W.norm() / static_cast<double>(W.rows()) * gaussian(W.rows(), W.cols());
    const DelassusProblem problem = localProblem(W, symmetric.q, symmetric.laws);
    for (const SolverEntry& entry : solverRegistry())
    {
      const std::unique_ptr<Solver> solver = entry.create();
      solver->setStopping(budget(ITERATIONS));
      const SolverResult result = solver->solve(problem);
      const std::string where = std::string(entry.name) + " on an unsymmetric W, seed " + std::to_string(seed);
      expectConfirmed(problem, result, where);
      if (std::string(entry.name) == "portfolio" || std::string(entry.name) == "gauss_seidel")
      {
        EXPECT_EQ(result.status, SolverStatus::CONVERGED) << where;
      }
    }
  }
}

TEST(RandomClassTest, InfeasibleProblemsAreReportedWithTheBestIterate)
{
  for (std::uint32_t seed = 1; seed <= SEEDS; ++seed)
  {
    const IncrementalProblem problem = infeasible(seed);
    Solution nothing;
    nothing.r.setZero(problem.rows());
    nothing.v = -MatrixXd(problem.M).ldlt().solve(problem.f);
    const double before = evaluateResidual(problem, nothing).value();
    for (const SolverEntry& entry : solverRegistry())
    {
      const SolverResult result = solveAndJudge(entry, problem, "an infeasible problem", nullptr, ITERATIONS);
      EXPECT_NE(result.status, SolverStatus::CONVERGED) << entry.name;
      EXPECT_LE(result.residual, before * (1.0 + 1e-12)) << entry.name << ": worse than doing nothing";
    }
  }
}
