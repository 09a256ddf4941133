#pragma once
/**
 * @file shifted_factor.h
 * @brief Cholesky factor of  S = (W + W^T)/2 + blockdiag(B_1 .. B_n)  for many shifts B of one W.
 *
 * Dense when W is stored dense, or when the sparse factor would cost more than the dense one; sparse otherwise, with
 * an approximate minimum degree ordering found once (Eigen's SimplicialLLT). Sizes: rows x rows, B_i as law i.
 */
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/problem/delassus_operator.h"

namespace frictional_contact_sim
{
class ShiftedFactor
{
public:
  /// Values of B kept for each block, row-major D x D at the front.
  static constexpr int BLOCK_STRIDE = 9;

  ShiftedFactor();
  ~ShiftedFactor();

  /** @brief Copies the symmetric part of W; the ordering is kept while the pattern stays. */
  void setOperator(const DelassusOperator& W);
  /** @brief Factors S; blocks holds BLOCK_STRIDE values a law, symmetric. @return false when S is not positive. */
  bool factor(const std::vector<double>& blocks);
  /** @brief x = S^-1 b; b and x may be the same vector. */
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

private:
  void addBlocks(const std::vector<double>& blocks);
  void useDense(const DelassusOperator& W);

  struct Sparse;
  std::unique_ptr<Sparse> sparse_;
  bool is_dense_ = true;
  std::vector<int> offsets_;
  Eigen::MatrixXd operator_;  ///< symmetric part, dense case
  Eigen::MatrixXd shifted_;
  Eigen::LLT<Eigen::MatrixXd> dense_factor_;
};

}  // namespace frictional_contact_sim
