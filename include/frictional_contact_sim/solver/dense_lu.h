#pragma once
/**
 * @file dense_lu.h
 * @brief LU with partial pivoting for small dense systems of changing size, without allocation: P A = L U, n x n.
 *
 * The active set of a Newton iteration changes its size from step to step; Eigen's PartialPivLU would allocate each
 * time. Right-looking, two pivots at a time so that the trailing matrix is read and written half as often; columns
 * contiguous. Source: Golub, Van Loan (2013), algorithm 3.4.1.
 */
#include <Eigen/Core>
#include <vector>

namespace frictional_contact_sim
{
class DenseLu
{
public:
  /** @brief Room for systems up to size rows. */
  void reserve(int size);
  /** @brief An n x n matrix of zeros to be filled; n must be within what was reserved. */
  Eigen::Map<Eigen::MatrixXd> start(int size);
  /** @brief Factors the filled matrix in place. @return false when a pivot is zero or not finite */
  bool factor();
  /** @brief x <- A^-1 x. */
  void solve(Eigen::Ref<Eigen::VectorXd> x) const;

private:
  int size_ = 0;
  std::vector<double> values_;
  std::vector<int> pivots_;
};

}  // namespace frictional_contact_sim
