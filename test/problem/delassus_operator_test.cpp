#include "frictional_contact_sim/problem/delassus_operator.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/residual.h"
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

IncrementalProblem everyLaw(std::uint32_t seed, int bilaterals, int bodies = 4)
{
  RandomProblemOptions options;
  options.bodies = bodies;
  options.contacts = 2 * bodies;
  options.planar_contacts = 2;
  options.unilateral = 2;
  options.dry = 1;
  options.bilaterals = bilaterals;
  options.moving_externals = true;
  return randomProblem(options, seed);
}

/** Copies of a problem side by side: separate machines. */
IncrementalProblem sideBySide(const IncrementalProblem& one, int copies)
{
  const auto repeat = [copies](const SparseRows& matrix)
  {
    MatrixXd whole = MatrixXd::Zero(copies * matrix.rows(), copies * matrix.cols());
    for (int k = 0; k < copies; ++k)
      whole.block(k * matrix.rows(), k * matrix.cols(), matrix.rows(), matrix.cols()) = MatrixXd(matrix);
    return sparse(whole);
  };
  IncrementalProblem all;
  all.M = repeat(one.M);
  all.H = repeat(one.H);
  all.G = repeat(one.G);
  all.f = one.f.replicate(copies, 1);
  all.w = one.w.replicate(copies, 1);
  all.b = one.b.replicate(copies, 1);
  for (int k = 0; k < copies; ++k)
    all.laws.insert(all.laws.end(), one.laws.begin(), one.laws.end());
  return all;
}
}  // namespace

TEST(MatrixFreeOperatorTest, ProductsAndDiagonalBlocksAreThoseOfW)
{
  for (std::uint32_t seed = 1; seed <= 6; ++seed)
    for (const int bilaterals : {0, 3})
    {
      const IncrementalProblem problem = everyLaw(seed, bilaterals);
      DelassusReduction with, without;
      with.compute(problem);
      without.compute(problem, OperatorKind::MATRIX_FREE);
      const DelassusOperator& W = with.problem().W;
      const DelassusOperator& Z = without.problem().W;
      ASSERT_TRUE(Z.isMatrixFree());
      ASSERT_FALSE(Z.isDense());
      const VectorXd x = VectorXd::LinSpaced(W.rows(), -1.0, 2.0);
      VectorXd expected, found;
      W.apply(x, expected);
      Z.apply(x, found);
      EXPECT_LT((found - expected).norm(), ROUND_OFF * expected.norm());
      W.applyTransposed(x, expected);
      EXPECT_LT((W.toDense().transpose() * x - expected).norm(), ROUND_OFF * expected.norm());
      Z.applyTransposed(x, found);
      EXPECT_LT((found - expected).norm(), ROUND_OFF * expected.norm());
      EXPECT_LT((without.problem().q - with.problem().q).norm(), ROUND_OFF * (1.0 + with.problem().q.norm()));
      VectorXd rho_with, rho_without;
      computeStepLengths(with.problem(), rho_with);
      computeStepLengths(without.problem(), rho_without);
      EXPECT_LT((rho_with - rho_without).norm(), ROUND_OFF * rho_with.norm());
      EXPECT_LT((Z.diagonalBlock<3>(0) - W.diagonalBlock<3>(0)).norm(), ROUND_OFF * W.diagonalBlock<3>(0).norm());
      Solution a, b;
      a.r = b.r = x;
      with.recover(problem, a);
      without.recover(problem, b);
      EXPECT_LT((a.v - b.v).norm(), ROUND_OFF * a.v.norm());
    }
}

TEST(MatrixFreeOperatorTest, HasNoEntriesAndSaysSo)
{
  DelassusReduction reduction;
  reduction.compute(everyLaw(1, 0), OperatorKind::MATRIX_FREE);
  EXPECT_THROW(reduction.problem().W.toDense(), std::logic_error);
  EXPECT_THROW(reduction.problem().W.toSparse(), std::logic_error);
}

TEST(MatrixFreeOperatorTest, PartsAreRowsAndColumnsOfTheWhole)
{
  DelassusReduction with, without;
  const IncrementalProblem problem = sideBySide(everyLaw(3, 0, 2), 2);
  with.compute(problem, OperatorKind::DENSE);
  without.compute(problem, OperatorKind::MATRIX_FREE);
  const auto half = problem.laws.size() / 2;
  std::vector<int> blocks, position(problem.laws.size(), -1);
  for (size_t i = half; i < problem.laws.size(); ++i)
  {
    position[i] = static_cast<int>(i - half);
    blocks.push_back(static_cast<int>(i));
  }
  const std::vector<Law> laws(problem.laws.begin() + static_cast<std::ptrdiff_t>(half), problem.laws.end());
  DelassusOperator expected, found;
  expected.assignBlocks(with.problem().W, blocks, position, laws);
  for (int round = 0; round < 2; ++round)
    found.assignBlocks(without.problem().W, blocks, position, laws);
  ASSERT_TRUE(found.isMatrixFree());
  EXPECT_LT(found.halfColumns(), without.problem().W.halfColumns()) << "columns of the other part are dropped";
  const VectorXd x = VectorXd::LinSpaced(expected.rows(), -1.0, 2.0);
  VectorXd y, z;
  expected.apply(x, y);
  found.apply(x, z);
  EXPECT_LT((y - z).norm(), ROUND_OFF * y.norm());
}

TEST(DelassusOperatorTest, StorageFollowsTheChoice)
{
  const IncrementalProblem problem = everyLaw(2, 0);
  MatrixXd expected;
  for (const OperatorKind kind : {OperatorKind::DENSE, OperatorKind::SPARSE, OperatorKind::AUTOMATIC})
  {
    DelassusReduction reduction;
    // The choice may change between calls: the pattern is analysed again.
    reduction.compute(problem, OperatorKind::MATRIX_FREE);
    reduction.compute(problem, kind);
    const DelassusOperator& W = reduction.problem().W;
    EXPECT_EQ(W.isDense(), kind != OperatorKind::SPARSE);
    EXPECT_FALSE(W.isMatrixFree());
    if (expected.size() == 0)
      expected = W.toDense();
    EXPECT_EQ((W.toDense() - expected).norm(), 0.0);
    DelassusOperator copy;
    copy.assign(W.toSparse(), problem.laws, kind);
    EXPECT_EQ(copy.isDense(), kind != OperatorKind::SPARSE);
    EXPECT_EQ((copy.toDense() - expected).norm(), 0.0);
  }
}

TEST(DelassusReductionTest, SeparateMachinesWithLoopsStaySeparateInW)
{
  // Eight machines with bilateral rows, one of them redundant: W couples laws of one machine only, and is stored so.
  IncrementalProblem one = everyLaw(5, 4);
  MatrixXd G = one.G;
  G.row(3) = G.row(0) - 0.5 * G.row(2);
  one.G = sparse(G);
  one.b[3] = one.b[0] - 0.5 * one.b[2];
  const IncrementalProblem all = sideBySide(one, 8);
  DelassusReduction alone, together;
  alone.compute(one);
  together.compute(all);
  EXPECT_EQ(alone.bilateralRank(), 3);
  EXPECT_EQ(together.bilateralRank(), 24);
  ASSERT_FALSE(together.problem().W.isDense());
  const MatrixXd W = together.problem().W.toDense();
  const Eigen::Index rows = one.rows();
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
    {
      const MatrixXd block = W.block(i * rows, j * rows, rows, rows);
      if (i == j)
        EXPECT_LT((block - alone.problem().W.toDense()).norm(), ROUND_OFF * block.norm());
      else
        EXPECT_EQ(block.norm(), 0.0);
    }
  Solution a, b;
  a.r = VectorXd::LinSpaced(rows, -1.0, 1.0);
  b.r = a.r.replicate(8, 1);
  alone.recover(one, a);
  together.recover(all, b);
  EXPECT_LT((b.v - a.v.replicate(8, 1)).norm(), ROUND_OFF * b.v.norm());
  EXPECT_LT((b.lambda - a.lambda.replicate(8, 1)).norm(), ROUND_OFF * b.lambda.norm());
}

TEST(DelassusReductionTest, AllocatesNothingWithBilateralsEither)
{
  for (const bool redundant : {false, true})
    for (const OperatorKind kind : {OperatorKind::AUTOMATIC, OperatorKind::SPARSE, OperatorKind::MATRIX_FREE})
    {
      IncrementalProblem problem = everyLaw(1, 3);
      if (redundant)
      {
        MatrixXd G = problem.G;
        G.row(2) = 3.0 * G.row(1);
        problem.G = sparse(G);
        problem.b[2] = 3.0 * problem.b[1];
      }
      DelassusReduction reduction;
      Solution solution;
      solution.r = VectorXd::Ones(problem.rows());
      reduction.compute(problem, kind);
      reduction.recover(problem, solution);
      problem.f *= 1.5;
      const AllocationCounter counter;
      reduction.compute(problem, kind);
      reduction.recover(problem, solution);
      EXPECT_EQ(counter.count(), 0) << toString(kind);
    }
}

TEST(DelassusReductionTest, ABilateralRowWithoutEntriesTakesNoPart)
{
  IncrementalProblem problem = everyLaw(2, 2);
  MatrixXd G = problem.G;
  G.row(1).setZero();
  problem.G = sparse(G);
  problem.b[1] = 0.0;
  DelassusReduction reduction;
  reduction.compute(problem);
  EXPECT_EQ(reduction.bilateralRank(), 1);
  Solution solution;
  solution.r = VectorXd::Ones(problem.rows());
  reduction.recover(problem, solution);
  EXPECT_EQ(solution.lambda[1], 0.0);
  EXPECT_LT((problem.G * solution.v + problem.b).norm(), ROUND_OFF * (1.0 + solution.v.norm()));
}
