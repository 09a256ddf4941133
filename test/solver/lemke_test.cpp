/**
 * @file lemke_test.cpp
 * @brief Pivoting on linear complementarity problems, and contacts written as one.
 */
#include <gtest/gtest.h>

#include <random>

#include "frictional_contact_sim/solver/lcp_lemke.h"
#include "frictional_contact_sim/solver/lemke.h"
#include "method_test_support.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
Eigen::MatrixXd randomMatrix(int n, std::mt19937& engine)
{
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(n, n, [&]() { return normal(engine); });
}
}  // namespace

TEST(LemkeTest, TextbookProblem)
{
  // M = [2 1; 1 2], b = (-5, -6): x = (4/3, 7/3), y = 0.
  Eigen::Matrix2d M;
  M << 2, 1, 1, 2;
  const LcpResult result = solveLemke(M, Eigen::Vector2d(-5, -6));
  ASSERT_EQ(result.status, LcpStatus::SOLVED);
  EXPECT_NEAR(result.x[0], 4.0 / 3.0, 1e-15);
  EXPECT_NEAR(result.x[1], 7.0 / 3.0, 1e-15);
}

TEST(LemkeTest, FirstPivotBringsTheArtificialVariableInAtTheSmallestEntry)
{
  // One pivot only: t enters, y_2 leaves, nothing else is basic yet.
  LcpOptions options;
  options.max_pivots = 1;
  Eigen::Matrix2d M;
  M << 2, 1, 1, 2;
  const LcpResult result = solveLemke(M, Eigen::Vector2d(-5, -6), options);
  EXPECT_EQ(result.status, LcpStatus::MAX_PIVOTS);
  EXPECT_EQ(result.pivots, 1);
  EXPECT_EQ(result.x.norm(), 0.0);
}

TEST(LemkeTest, InfeasibleProblemEndsOnARay)
{
  // y = -x - 1 < 0 for all x >= 0.
  const LcpResult result = solveLemke(-Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, -1.0));
  EXPECT_EQ(result.status, LcpStatus::RAY);
}

TEST(LemkeTest, DegenerateProblemsDoNotCycle)
{
  // Equal entries everywhere: every ratio test ties. Copositive, so that a solution is found.
  const int n = 30;
  const Eigen::MatrixXd M = Eigen::MatrixXd::Ones(n, n) + 0.0 * Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd b = -Eigen::VectorXd::Ones(n);
  const LcpResult result = solveLemke(M, b);
  ASSERT_EQ(result.status, LcpStatus::SOLVED);
  EXPECT_LT(lcpResidual(M, b, result.x), 1e-14);
  EXPECT_LE(result.pivots, 2 * n);
}

TEST(LemkeTest, RandomProblemsOfManyKinds)
{
  std::mt19937 engine(3);
  for (int n : {5, 20, 60, 150})
  {
    const Eigen::MatrixXd A = randomMatrix(n, engine);
    const Eigen::VectorXd b = randomMatrix(n, engine).col(0);
    // Nonsymmetric positive definite: one solution.
    const Eigen::MatrixXd M = A * A.transpose() / n + 0.1 * Eigen::MatrixXd::Identity(n, n) + (A - A.transpose());
    const LcpResult lemke = solveLemke(M, b);
    ASSERT_EQ(lemke.status, LcpStatus::SOLVED) << n;
    EXPECT_LT(lcpResidual(M, b, lemke.x), 1e-11) << n;  // round-off times a condition of 1e4
    const LcpResult principal = solvePrincipalPivoting(M, b);
    ASSERT_EQ(principal.status, LcpStatus::SOLVED) << n;
    EXPECT_LT((principal.x - lemke.x).lpNorm<Eigen::Infinity>(), 1e-9) << n;
  }
}

TEST(PrincipalPivotingTest, VanishingDiagonalNeedsTheTwoByTwoPivot)
{
  // Positive semi-definite and skew: y = (x_2 - 1, -x_1 + 2): x = (2, 1).
  Eigen::Matrix2d M;
  M << 0, 1, -1, 0;
  const LcpResult result = solvePrincipalPivoting(M, Eigen::Vector2d(-1, 2));
  ASSERT_EQ(result.status, LcpStatus::SOLVED);
  EXPECT_LT(lcpResidual(M, Eigen::Vector2d(-1, 2), result.x), 1e-15);
}

TEST(LcpLemkeTest, MatrixIsThatOfTheThesis)
{
  // One contact: A of solver/lcp_lemke.h.
  Eigen::Matrix2d W;
  W << 2.0, 0.5, 0.5, 3.0;
  const DelassusProblem problem = localProblem(W, Eigen::Vector2d(-1, 4), {{LawType::COULOMB_2D, 0.4}});
  const ContactLcp lcp = makeContactLcp(problem, 8, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1));
  Eigen::Matrix3d expected;
  expected << 2.0 - 0.5 * 0.4, 1.0, 0.0, 0.5 - 3.0 * 0.4, 6.0, 1.0, 0.4, -1.0, 0.0;
  EXPECT_LT((lcp.A - expected).norm(), 1e-15);
  EXPECT_LT((lcp.b - Eigen::Vector3d(-1, 4, 0)).norm(), 1e-15);
}

TEST(LcpLemkeTest, PlanarProblemsAreSolvedToRoundOffInOneSolve)
{
  for (std::uint32_t seed = 1; seed <= 8; ++seed)
  {
    RandomProblemOptions options;
    options.contacts = 0;
    options.planar_contacts = 6;
    options.unilateral = static_cast<int>(seed % 3);
    options.dry = static_cast<int>(seed % 2);
    options.bilaterals = seed > 4 ? 2 : 0;
    LcpLemke solver;
    solver.setStopping(stopAfter(1, 1e-12));
    const SolverResult result = solver.solve(randomProblem(options, seed));
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << seed << " " << result.message << " " << result.residual;
    EXPECT_EQ(result.iterations, 1);
  }
}

TEST(LcpLemkeTest, BilateralRowsOfALocalProblemAreEliminated)
{
  // A contact beside a free row with W = [[2, .3, .1], [.3, 1, .2], [.1, .2, 1]]: agrees with Gauss-Seidel.
  Eigen::Matrix3d W;
  W << 2.0, 0.3, 0.1, 0.3, 1.0, 0.2, 0.1, 0.2, 1.0;
  const DelassusProblem problem =
      localProblem(W, Eigen::Vector3d(-1, 0.5, 0.7), {{LawType::COULOMB_2D, 0.6}, {LawType::BILATERAL, 0.0}});
  LcpLemke solver;
  solver.setStopping(stopAfter(1, 1e-13));
  EXPECT_EQ(solver.solve(problem).status, SolverStatus::CONVERGED);
}

TEST(LcpLemkeTest, SpatialConeIsReportedByItsExactResidual)
{
  // Sliding between two of eight directions, isotropic W: without alignment the answer is off and said to be.
  const DelassusProblem problem =
      localProblem(Eigen::Matrix3d::Identity(), Eigen::Vector3d(-1, -2, -0.8), {{LawType::COULOMB_3D, 0.5}});
  LcpLemkeOptions plain;
  plain.alignments = 0;
  LcpLemke crude(plain);
  const SolverResult result = crude.solve(problem);
  EXPECT_EQ(result.status, SolverStatus::STAGNATED);
  EXPECT_GT(result.residual, 1e-3);
  EXPECT_NE(result.message.find("8 directions"), std::string::npos);
  LcpLemke aligned;
  EXPECT_EQ(aligned.solve(problem).status, SolverStatus::CONVERGED);
}

TEST(LcpLemkeTest, HonestWhereThereIsNoSolution)
{
  expectHonestWithoutSolution("lcp_lemke");
}

TEST(LcpLemkeTest, ExampleD2IsExact)
{
  expectConvergenceFromExampleD2("lcp_lemke", 1);
}
