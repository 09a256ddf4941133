/**
 * @file planar_theory_test.cpp
 * @brief What theory promises in 2D: Lemke's path on Stewart's copositive form never fails when nothing outside moves
 * (theorem 4.6), and Newton on F(s) = s ends after finitely many steps, whatever the tolerance (4.7.7).
 */
#include <gtest/gtest.h>

#include <random>

#include "frictional_contact_sim/math/matrix_classes.h"
#include "frictional_contact_sim/solver/lcp_lemke.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/** Planar contacts and one-dimensional laws, w = 0; the contact rows have at most the given rank (0: any). */
DelassusProblem planarProblem(int contacts, int rank, std::uint32_t seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> friction(0.0, 2.0);
  std::vector<Law> laws;
  for (int i = 0; i < contacts; ++i)
    laws.push_back({LawType::COULOMB_2D, friction(random)});
  if (seed % 3 == 1)
    laws.push_back({LawType::UNILATERAL, 0.0});
  if (seed % 3 == 2)
    laws.push_back({LawType::DRY_FRICTION, 0.5});
  const int rows = rowCount(laws);
  const int columns = rank > 0 ? rank : rows + 2;
  const auto gauss = [&](int n, int m)
  { return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, m, [&](auto, auto) { return normal(random); })); };
  const Eigen::MatrixXd H = gauss(rows, columns);
  return localProblem(H * H.transpose(), H * gauss(columns, 1), laws);  // q = -H M^-1 f
}
}  // namespace

TEST(StewartFormTest, LemkeNeverFailsWhenNothingOutsideMoves)
{
  for (std::uint32_t seed = 1; seed <= 300; ++seed)
  {
    const int contacts = 1 + static_cast<int>(seed % 8);
    const int rank = seed % 2 == 0 ? 0 : 1 + static_cast<int>(seed % 5);
    const DelassusProblem problem = planarProblem(contacts, rank, seed);
    const SolverResult result = createSolver("lcp_lemke", {{"form", "stewart"}})->solve(problem);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED)
        << "seed " << seed << ", " << contacts << " contacts, rank " << rank << ": " << result.message;
  }
}

TEST(StewartFormTest, ItsMatrixIsCopositiveAndThatOfTheReducedFormIsNot)
{
  int not_copositive = 0;
  for (std::uint32_t seed = 3; seed <= 30; seed += 3)
  {
    const DelassusProblem problem = planarProblem(2, 2, seed);
    const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(2), ones = Eigen::VectorXd::Ones(2);
    const Eigen::MatrixXd stewart = makeContactLcp(problem, 4, zeros, ones, LcpForm::STEWART).A;
    const Eigen::MatrixXd reduced = makeContactLcp(problem, 4, zeros, ones).A;
    EXPECT_EQ(stewart.rows(), 8);
    EXPECT_EQ(checkCopositivity(stewart).copositive, MatrixVerdict::YES) << seed;
    not_copositive += checkCopositivity(reduced).copositive == MatrixVerdict::NO;
    EXPECT_EQ(checkPMatrix(reduced).verdict, MatrixVerdict::NO);  // its last diagonal block is zero
  }
  EXPECT_GT(not_copositive, 5);
}

TEST(PlanarNewtonTest, EndsAfterAFewStepsForAnyTolerance)
{
  int solved = 0, most = 0;
  for (std::uint32_t seed = 1; seed <= 60; ++seed)
  {
    const DelassusProblem problem = planarProblem(1 + static_cast<int>(seed % 6), seed % 2 == 0 ? 0 : 3, 1000 + seed);
    int iterations = -1;
    for (const double tolerance : {1e-6, 1e-9, 1e-12})
    {
      StoppingOptions stopping;
      stopping.tolerance = tolerance;
      const std::unique_ptr<Solver> newton = createSolver("cadoux_newton");
      newton->setStopping(stopping);
      const SolverResult result = newton->solve(problem);
      if (result.status != SolverStatus::CONVERGED)
        break;  // Newton need not find the right piece at all
      if (iterations >= 0)
      {
        EXPECT_LE(result.iterations, 2 * iterations + 3) << "seed " << seed << ", tolerance " << tolerance;
      }
      iterations = std::max(iterations, result.iterations);
      most = std::max(most, result.iterations);
      solved += tolerance == 1e-12;
    }
  }
  EXPECT_GE(solved, 54);
  EXPECT_LE(most, 40);
}
