#pragma once
/**
 * @file shifted_factor.h
 * @brief Cholesky factor of  S = (W + W^T)/2 + T^-T D T^-1,  T block-diagonal, D diagonal and positive, for many (T, D)
 * of one W.
 *
 * Formed and factored as T^T W T + D: a shift that is huge in one direction of a block and tiny in another (interior
 * points near the end) then is a diagonal scaling, which costs no digits; added to W entry by entry it would drown W.
 * Dense when W is stored dense, or when the sparse factor would cost more than the dense one; sparse otherwise, with
 * an approximate minimum degree ordering found once (Eigen's SimplicialLLT). Sizes: rows x rows, T_i as law i.
 */
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/math/cone.h"
#include "frictional_contact_sim/problem/delassus_operator.h"

namespace frictional_contact_sim
{
class ShiftedFactor
{
public:
  ShiftedFactor();
  ~ShiftedFactor();

  /** @brief Copies the symmetric part of W; the ordering is kept while the pattern stays. */
  void setOperator(const DelassusOperator& W);
  /** @brief Factors W + D. @param shift D, one entry a row. @return false when not positive definite. */
  bool factor(const Eigen::VectorXd& shift);
  /** @brief The same in the bases T_i, whose D x D values are at the front of bases[i]. */
  bool factor(const std::vector<SquareMatrix<3>>& bases, const Eigen::VectorXd& shift);
  /** @brief x = S^-1 b; b and x may be the same vector. */
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

private:
  bool factorShifted(const Eigen::VectorXd& shift);
  void useDense(const DelassusOperator& W);
  void setSparse(const DelassusOperator& W);
  void transformDense(const std::vector<SquareMatrix<3>>& bases);
  void transformSparse(const std::vector<SquareMatrix<3>>& bases);
  void toBasis(Eigen::VectorXd& x, bool transposed) const;

  struct Sparse;
  std::unique_ptr<Sparse> sparse_;
  bool is_dense_ = true;
  std::vector<int> offsets_;
  std::vector<SquareMatrix<3>> bases_;  ///< empty: T = I
  Eigen::MatrixXd operator_;  ///< symmetric part, dense case
  Eigen::MatrixXd shifted_;
  Eigen::LLT<Eigen::MatrixXd> dense_factor_;
};

}  // namespace frictional_contact_sim
