#pragma once
/**
 * @file orthogonal_rows.h
 * @brief Orthonormal rows of a dense matrix, redundant ones found:   E A = L Q^T.
 *
 * A m x n, E a permutation (largest remainder first), L m x rank lower trapezoidal, Q n x rank with orthonormal
 * columns. Gram-Schmidt, each new row orthogonalised twice ("twice is enough"). No allocation while the sizes stay.
 *
 * Source: Bjorck (1994), "Numerics of Gram-Schmidt orthogonalization", sections 3 and 6; Giraud, Langou, Rozloznik
 * (2005).
 */
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace frictional_contact_sim
{
class OrthogonalRows
{
public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void resize(int rows, int columns);
  /** @brief A, to be filled before compute(). */
  Matrix& matrix() { return matrix_; }
  /** @brief Factors; rows whose remainder is below `tolerance` times the largest row are combinations of the others. */
  void compute(double tolerance);

  int rank() const { return rank_; }
  /** @brief Q^T, rank x n. */
  auto basis() const { return matrix_.topRows(rank_); }
  /** @brief The y with L_1 y = (E b)_1, so that A Q y = b when b is consistent. */
  void coordinates(const Eigen::VectorXd& b, Eigen::VectorXd& y) const;
  /** @brief The least-norm x with A^T x = Q c; c is overwritten. */
  void leastNorm(Eigen::VectorXd& c, Eigen::VectorXd& x);

private:
  int pivot(int k) const;

  int rank_ = 0;
  Matrix matrix_;  ///< A, then Q^T in its first rows
  Matrix triangle_;  ///< L
  std::vector<int> order_;  ///< row of A that became row k
  Eigen::MatrixXd gram_;  ///< L^T L
  Eigen::LLT<Eigen::MatrixXd> gram_factor_;
};

}  // namespace frictional_contact_sim
