#include "frictional_contact_sim/problem/orthogonal_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace frictional_contact_sim
{
void OrthogonalRows::resize(int rows, int columns)
{
  matrix_.resize(rows, columns);
  triangle_.resize(rows, std::min(rows, columns));
  order_.resize(static_cast<size_t>(rows));
}

int OrthogonalRows::pivot(int k) const
{
  Eigen::Index best = 0;
  matrix_.bottomRows(matrix_.rows() - k).rowwise().squaredNorm().maxCoeff(&best);
  return k + static_cast<int>(best);
}

void OrthogonalRows::compute(double tolerance)
{
  std::iota(order_.begin(), order_.end(), 0);
  triangle_.setZero();
  double largest = 0.0;
  for (rank_ = 0; rank_ < triangle_.cols(); ++rank_)
  {
    const int k = rank_;
    const int p = pivot(k);
    const double norm = matrix_.row(p).norm();
    largest = std::max(largest, norm);
    if (!(norm > tolerance * largest))
      return;
    if (p != k)
    {
      matrix_.row(k).swap(matrix_.row(p));
      triangle_.row(k).head(k).swap(triangle_.row(p).head(k));
      std::swap(order_[static_cast<size_t>(k)], order_[static_cast<size_t>(p)]);
    }
    matrix_.row(k) /= norm;
    for (int j = 0; j < k; ++j)
    {
      const double rest = matrix_.row(k).dot(matrix_.row(j));
      matrix_.row(k) -= rest * matrix_.row(j);
      triangle_(k, j) += norm * rest;
    }
    const double kept = matrix_.row(k).norm();
    matrix_.row(k) /= kept;
    triangle_(k, k) = norm * kept;
    for (Eigen::Index i = k + 1; i < matrix_.rows(); ++i)
    {
      const double part = matrix_.row(i).dot(matrix_.row(k));
      triangle_(i, k) = part;
      matrix_.row(i) -= part * matrix_.row(k);
    }
  }
}

void OrthogonalRows::coordinates(const Eigen::VectorXd& b, Eigen::VectorXd& y) const
{
  y.resize(rank_);
  for (int k = 0; k < rank_; ++k)
    y[k] = (b[order_[static_cast<size_t>(k)]] - triangle_.row(k).head(k).dot(y.head(k))) / triangle_(k, k);
}

void OrthogonalRows::leastNorm(Eigen::VectorXd& c, Eigen::VectorXd& x)
{
  // E A = L Q^T:  A^T x = Q L^T (E x), so L^T (E x) = c.
  const auto rows = matrix_.rows();
  x.resize(rows);
  const auto L = triangle_.leftCols(rank_);
  if (rank_ == rows)
  {
    for (int k = rank_ - 1; k >= 0; --k)
      c[k] = (c[k] - L.col(k).segment(k + 1, rank_ - 1 - k).dot(c.segment(k + 1, rank_ - 1 - k))) / L(k, k);
    for (int k = 0; k < rank_; ++k)
      x[order_[static_cast<size_t>(k)]] = c[k];
    return;
  }
  gram_.resize(rank_, rank_);
  gram_.noalias() = L.transpose() * L;
  gram_factor_.compute(gram_);
  gram_factor_.solveInPlace(c);
  for (Eigen::Index k = 0; k < rows; ++k)
    x[order_[static_cast<size_t>(k)]] = L.row(k).dot(c);
}

}  // namespace frictional_contact_sim
