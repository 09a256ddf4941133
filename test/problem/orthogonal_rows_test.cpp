#include "frictional_contact_sim/problem/orthogonal_rows.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "support/allocation_counter.h"

using namespace frictional_contact_sim;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
constexpr double RANK_TOLERANCE = 1e-11;
/// A few dozen operations on numbers of order 1.
constexpr double ROUND_OFF = 1e-13;

OrthogonalRows factor(const MatrixXd& A)
{
  OrthogonalRows rows;
  rows.resize(static_cast<int>(A.rows()), static_cast<int>(A.cols()));
  rows.matrix() = A;
  rows.compute(RANK_TOLERANCE);
  return rows;
}
}  // namespace

TEST(OrthogonalRowsTest, TwoRowsByHand)
{
  // (3, 4) is the longer row; (0, 1) leaves (-12, 9)/25 of length 3/5.
  MatrixXd A(2, 2);
  A << 0, 1, 3, 4;
  const OrthogonalRows rows = factor(A);
  ASSERT_EQ(rows.rank(), 2);
  EXPECT_LT((rows.basis().row(0) - Eigen::RowVector2d(0.6, 0.8)).norm(), ROUND_OFF);
  EXPECT_LT((rows.basis().row(1) - Eigen::RowVector2d(-0.8, 0.6)).norm(), ROUND_OFF);
  VectorXd y;
  rows.coordinates(Eigen::Vector2d(1.0, 5.0), y);
  const VectorXd x = rows.basis().transpose() * y;
  EXPECT_LT((A * x - Eigen::Vector2d(1.0, 5.0)).norm(), ROUND_OFF);
}

TEST(OrthogonalRowsTest, NearlyParallelRowsStayOrthogonal)
{
  // Lauchli's matrix: once is not enough. 1e-8 is well above the rank tolerance.
  MatrixXd A = MatrixXd::Zero(3, 4);
  A.col(0).setOnes();
  A.rightCols(3).diagonal().setConstant(1e-8);
  const OrthogonalRows rows = factor(A);
  ASSERT_EQ(rows.rank(), 3);
  EXPECT_LT((rows.basis() * rows.basis().transpose() - MatrixXd::Identity(3, 3)).norm(), 1e-14);
}

TEST(OrthogonalRowsTest, RankAndLeastNormAgreeWithAPivotedQr)
{
  std::srand(3);
  for (const int rank : {1, 3, 5})
  {
    const MatrixXd A = MatrixXd::Random(5, rank) * MatrixXd::Random(rank, 9);
    OrthogonalRows rows = factor(A);
    ASSERT_EQ(rows.rank(), rank);
    const MatrixXd Q = rows.basis().transpose();
    EXPECT_LT((A - A * Q * Q.transpose()).norm(), 1e-12);
    VectorXd c = VectorXd::LinSpaced(rank, 1.0, 2.0), x;
    const VectorXd target = Q * c;
    rows.leastNorm(c, x);
    // The random factors have conditions below 1e2, squared for redundant rows.
    EXPECT_LT((A.transpose() * x - target).norm(), 1e-10);
    const MatrixXd transposed = A.transpose();
    EXPECT_LT((x - transposed.completeOrthogonalDecomposition().solve(target)).norm(), 1e-9 * (1.0 + x.norm()));
  }
}

TEST(OrthogonalRowsTest, ZeroRowsHaveRankZero)
{
  EXPECT_EQ(factor(MatrixXd::Zero(2, 3)).rank(), 0);
  EXPECT_EQ(factor(MatrixXd::Zero(1, 0)).rank(), 0);
}
