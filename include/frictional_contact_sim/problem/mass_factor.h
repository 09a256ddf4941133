#pragma once
/**
 * @file mass_factor.h
 * @brief Sparse factor of the mass matrix, M = C C^T with C = P^T L D^(1/2); nv x nv, L unit lower triangular.
 *
 * P is an approximate minimum degree ordering: for the matrix of a kinematic tree it eliminates leaves first and
 * creates no fill, so that the factor costs O(nv depth^2). The symbolic part is kept while the pattern of M stays, and
 * the numbers of each tree of the elimination forest (a body, an elastic mesh) while those of M stay, to the bit.
 *
 * Source: Davis (2005), "Algorithm 849: a concise sparse Cholesky factorization package" (LDL); Amestoy, Davis, Duff
 * (2004), AMD. Featherstone (2008), section 6.5, for the sparsity of tree mass matrices.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
class MassFactor
{
public:
  /**
   * @brief Factors M; allocates only when the pattern differs from the last call's.
   * @return true when the pattern was new (the elimination tree changed)
   * @throws std::invalid_argument when M is not positive definite, naming the row
   */
  bool compute(const SparseRows& M);

  /** @brief Whether the last compute() factored the tree of a permuted index anew. */
  bool hasChanged(int k) const { return changed_[static_cast<size_t>(root_[static_cast<size_t>(k)])] != 0; }

  int size() const { return static_cast<int>(parent_.size()); }
  /** @brief x <- C^-1 x, in the permuted order. */
  void halfSolve(const Eigen::VectorXd& b, Eigen::VectorXd& x) const;
  /** @brief v <- C^-T x, back in the order of M. */
  void transposedHalfSolve(const Eigen::VectorXd& x, Eigen::VectorXd& v) const;

  /// Elimination tree (-1 at roots), permuted indices.
  const std::vector<int>& parent() const { return parent_; }
  /// Permuted index of a row of M.
  int permuted(int row) const { return inverse_permutation_[static_cast<size_t>(row)]; }
  /// Column pointers, row indices and values of L below the diagonal, and D^(-1/2).
  const std::vector<int>& columnBegin() const { return column_begin_; }
  const std::vector<int>& rowIndices() const { return row_indices_; }
  const std::vector<double>& values() const { return values_; }
  const Eigen::VectorXd& inverseRootPivots() const { return inverse_root_pivots_; }

private:
  bool samePattern(const SparseRows& M) const;
  void analyse(const SparseRows& M);
  void findChanges(const SparseRows& M);
  void factorRow(int k);

  std::vector<int> outer_, inner_;  ///< pattern of the last M
  std::vector<double> factored_;  ///< its entries; empty: none yet
  std::vector<int> root_;  ///< of the tree of each permuted index
  std::vector<char> changed_;  ///< by root
  std::vector<int> permutation_, inverse_permutation_;
  std::vector<int> parent_, counts_, flags_, pattern_;
  std::vector<int> column_begin_, row_indices_;
  std::vector<double> values_, pivots_, work_;
  Eigen::VectorXd inverse_root_pivots_;
  mutable Eigen::VectorXd permuted_;
};

}  // namespace frictional_contact_sim
