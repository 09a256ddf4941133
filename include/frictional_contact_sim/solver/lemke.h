#pragma once
/**
 * @file lemke.h
 * @brief Linear complementarity problems by pivoting, on plain dense matrices:  y = M x + b,  0 <= x orthogonal y >= 0.
 *
 * solveLemke: the covering vector d and the artificial variable t,  y = M x + b + d t;  t enters first, then always the
 * complement of the variable that has just left, until t leaves (SOLVED) or nothing blocks (RAY). The ratio test is
 * lexicographic on (b, B^-1), so that degenerate problems cannot cycle. For copositive-plus M a ray proves that the
 * problem is infeasible; for other M it proves nothing. The tableau is condensed (n x n+1, non-basic columns only): a
 * pivot is one rank-one update, n (n + 1) multiplications.
 *
 * solvePrincipalPivoting: Dantzig and Cottle's principal pivoting, symmetric version with 2 x 2 pivots where a diagonal
 * entry vanishes; meant for positive semi-definite and P-matrices, elsewhere it may stop with RAY.
 *
 * At the end the complementary basis is solved again by LU, so that the answer has no drift of the pivots.
 * M need not be symmetric. Sizes: n x n, dense.
 * Source: Lemke (1965); Cottle, Pang, Stone (1992), algorithms 4.4.5 (with 4.9.1 on lexicography) and 4.2.2; Cadoux
 * (2009), 4.1.2.
 */
#include <Eigen/Core>
#include <functional>

#include "frictional_contact_sim/solver/option_table.h"

namespace frictional_contact_sim
{
enum class LcpStatus
{
  SOLVED,
  RAY,  ///< the path ended on an unbounded ray
  MAX_PIVOTS,
  NUMERICAL_FAILURE,  ///< the basis found is singular or its solution is not complementary
  INTERRUPTED
};

struct LcpOptions
{
  int max_pivots = 0;  ///< 0 = 20 n + 100
  double pivot_tolerance = 1e-11;  ///< entries below this share of the column's largest never pivot [-], in (0, 1)
  double tie_tolerance = 1e-12;  ///< ratios this close, relative to the largest ratio seen, are equal [-], in [0, 1)
  Eigen::VectorXd covering;  ///< d > 0, empty = ones
  std::function<bool()> interrupted;  ///< asked every few pivots when set

  /** @brief What each is, as data. */
  static const OptionTable<LcpOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

struct LcpResult
{
  LcpStatus status = LcpStatus::NUMERICAL_FAILURE;
  int pivots = 0;
  Eigen::VectorXd x, y;  ///< y = M x + b; the last complementary guess when not SOLVED
};

/** @throws std::invalid_argument on wrong shapes or entries that are not finite. */
LcpResult solveLemke(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options = {});
LcpResult solvePrincipalPivoting(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options = {});

/** @brief max_i |min(x_i, M x + b)_i|, the natural residual. */
double lcpResidual(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const Eigen::VectorXd& x);

}  // namespace frictional_contact_sim
