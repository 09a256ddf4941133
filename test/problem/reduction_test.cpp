#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/mass_factor.h"
#include "support/allocation_counter.h"
#include "support/hand_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
/// Condition of the random M is below 1e3; products of a few dozen terms.
constexpr double ROUND_OFF = 1e-11;

IncrementalProblem mixedProblem(std::uint32_t seed, int bilaterals, int contacts = 6)
{
  RandomProblemOptions options;
  options.contacts = contacts;
  options.planar_contacts = 2;
  options.unilateral = 2;
  options.dry = 1;
  options.bilaterals = bilaterals;
  options.moving_externals = true;
  return randomProblem(options, seed);
}

/** Solves the saddle-point system for v and lambda at a given r, by a dense decomposition that allows redundant rows.
 */
VectorXd saddleVelocity(const IncrementalProblem& problem, const VectorXd& r)
{
  const MatrixXd M = problem.M, G = problem.G, H = problem.H;
  const Eigen::Index nv = M.rows(), nb = G.rows();
  MatrixXd K = MatrixXd::Zero(nv + nb, nv + nb);
  K.topLeftCorner(nv, nv) = M;
  K.topRightCorner(nv, nb) = -G.transpose();
  K.bottomLeftCorner(nb, nv) = G;
  VectorXd rhs(nv + nb);
  rhs << H.transpose() * r - problem.f, -problem.b;
  return K.completeOrthogonalDecomposition().solve(rhs).head(nv);
}
}  // namespace

TEST(MassFactorTest, FactorsABranchedTreeWithoutFill)
{
  // A root of 6 velocities with four chains of 3: the pattern of a quadruped's mass matrix.
  MatrixXd M = MatrixXd::Zero(18, 18);
  M.topLeftCorner(6, 6).setConstant(0.1);
  for (int leg = 0; leg < 4; ++leg)
  {
    M.block(6 + 3 * leg, 6 + 3 * leg, 3, 3).setConstant(0.1);
    M.block(6 + 3 * leg, 0, 3, 6).setConstant(0.05);
    M.block(0, 6 + 3 * leg, 6, 3).setConstant(0.05);
  }
  M.diagonal().array() += 2.0;
  MassFactor factor;
  EXPECT_TRUE(factor.compute(sparse(M)));
  EXPECT_FALSE(factor.compute(sparse(2.0 * M)));
  const int below_diagonal = 15 + 4 * (3 + 18);
  EXPECT_EQ(factor.columnBegin().back(), below_diagonal);
  VectorXd b = VectorXd::LinSpaced(18, -1.0, 2.0), x, v;
  factor.halfSolve(b, x);
  factor.transposedHalfSolve(x, v);
  EXPECT_LT((2.0 * M * v - b).norm(), 1e-13);
}

TEST(MassFactorTest, NamesTheRowWhenNotPositiveDefinite)
{
  MatrixXd M = MatrixXd::Identity(3, 3);
  M(1, 1) = -2.0;
  MassFactor factor;
  try
  {
    factor.compute(sparse(M));
    FAIL() << "an indefinite M was accepted";
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find("row 1"), std::string::npos) << error.what();
  }
}

TEST(DelassusReductionTest, AgreesWithTheDenseFormula)
{
  for (std::uint32_t seed = 1; seed <= 10; ++seed)
  {
    const IncrementalProblem problem = mixedProblem(seed, 0);
    const MatrixXd M = problem.M, H = problem.H;
    const MatrixXd inverse = M.inverse();
    const DelassusProblem local = reduce(problem);
    const MatrixXd expected = H * inverse * H.transpose();
    EXPECT_LT((local.W.toDense() - expected).norm(), ROUND_OFF * expected.norm());
    EXPECT_LT((local.q - (problem.w - H * inverse * problem.f)).norm(), ROUND_OFF * (1.0 + local.q.norm()));
  }
}

TEST(DelassusReductionTest, LargeProblemsGetBlockStorageWithTheSameNumbers)
{
  RandomProblemOptions options;
  options.bodies = 60;
  options.contacts = 90;
  options.planar_contacts = 3;
  options.unilateral = 4;
  const IncrementalProblem problem = randomProblem(options, 4);
  const MatrixXd M = problem.M, H = problem.H;
  const DelassusProblem local = reduce(problem);
  ASSERT_FALSE(local.W.isDense());
  const MatrixXd expected = H * M.ldlt().solve(MatrixXd(H.transpose()));
  EXPECT_LT((local.W.toDense() - expected).norm(), ROUND_OFF * expected.norm());
  const VectorXd x = VectorXd::LinSpaced(local.W.rows(), -1.0, 1.0);
  VectorXd y;
  local.W.apply(x, y);
  EXPECT_LT((y - expected * x).norm(), ROUND_OFF * (expected * x).norm());
  DelassusOperator copy;
  copy.assign(local.W.toSparse(), local.laws);
  EXPECT_FALSE(copy.isDense());
  EXPECT_EQ((copy.toDense() - local.W.toDense()).norm(), 0.0);
}

TEST(DelassusReductionTest, BilateralRowsAgreeWithTheSaddlePointSystemAndMayBeRedundant)
{
  for (std::uint32_t seed = 1; seed <= 10; ++seed)
    for (const bool redundant : {false, true})
    {
      IncrementalProblem problem = mixedProblem(seed, 4);
      problem.b = VectorXd::LinSpaced(4, -0.3, 0.5);
      if (redundant)
      {
        MatrixXd G = problem.G;
        G.row(3) = 2.0 * G.row(1) - G.row(0);
        problem.G = sparse(G);
        problem.b[3] = 2.0 * problem.b[1] - problem.b[0];
      }
      DelassusReduction reduction;
      reduction.compute(problem);
      EXPECT_EQ(reduction.bilateralRank(), redundant ? 3 : 4);
      std::srand(seed);
      Solution solution;
      solution.r = VectorXd::Random(problem.rows());
      reduction.recover(problem, solution);
      const VectorXd v = saddleVelocity(problem, solution.r);
      EXPECT_LT((solution.v - v).norm(), ROUND_OFF * (1.0 + v.norm()));
      VectorXd u;
      reduction.problem().W.apply(solution.r, u);
      u += reduction.problem().q;
      EXPECT_LT((u - solution.u).norm(), ROUND_OFF * (1.0 + u.norm()));
      const VectorXd defect = problem.M * solution.v + problem.f - problem.H.transpose() * solution.r -
                              problem.G.transpose() * solution.lambda;
      EXPECT_LT(defect.norm(), ROUND_OFF * (1.0 + problem.f.norm()));
      EXPECT_LT((problem.G * solution.v + problem.b).norm(), ROUND_OFF * (1.0 + v.norm()));
    }
}

TEST(DelassusReductionTest, RedundantBilateralsShareTheLoadEvenly)
{
  // One velocity, the same row three times: G = (1,1,1)^T, f = 3; lambda is (1,1,1), the least-norm one.
  IncrementalProblem problem;
  problem.M = sparse(MatrixXd::Identity(1, 1));
  problem.f = VectorXd::Constant(1, 3.0);
  problem.H.resize(0, 1);
  problem.w.resize(0);
  problem.G = sparse(MatrixXd::Ones(3, 1));
  problem.b.setZero(3);
  DelassusReduction reduction;
  reduction.compute(problem);
  Solution solution;
  solution.r.resize(0);
  reduction.recover(problem, solution);
  EXPECT_LT((solution.lambda - VectorXd::Ones(3)).norm(), 1e-14);
  EXPECT_LT(solution.v.norm(), 1e-14);
}

TEST(DelassusReductionTest, AllocatesNothingWhileThePatternStays)
{
  IncrementalProblem problem = mixedProblem(1, 0);
  DelassusReduction reduction;
  Solution solution;
  solution.r = VectorXd::Ones(problem.rows());
  reduction.compute(problem);
  reduction.recover(problem, solution);
  problem.f *= 1.5;
  const AllocationCounter counter;
  reduction.compute(problem);
  reduction.recover(problem, solution);
  EXPECT_EQ(counter.count(), 0);
}

TEST(ValidateTest, NamesTheFieldWhatWasFoundAndWhatWasExpected)
{
  const IncrementalProblem good = mixedProblem(1, 2);
  EXPECT_NO_THROW(validate(good));
  const auto message = [](const IncrementalProblem& problem)
  {
    try
    {
      validate(problem);
    }
    catch (const std::invalid_argument& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  IncrementalProblem bad = good;
  bad.w.conservativeResize(3);
  EXPECT_NE(message(bad).find("w has 3"), std::string::npos) << message(bad);
  bad = good;
  bad.f[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(bad).find("f entry 2 is"), std::string::npos) << message(bad);
  bad = good;
  bad.laws[1].coefficient = -0.5;
  EXPECT_NE(message(bad).find("laws[1].coefficient is -0.5"), std::string::npos) << message(bad);
  bad = good;
  bad.G = sparse(MatrixXd::Ones(2, 3));
  EXPECT_NE(message(bad).find("G is 2 x 3"), std::string::npos) << message(bad);
}
