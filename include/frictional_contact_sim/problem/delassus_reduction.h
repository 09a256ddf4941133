#pragma once
/**
 * @file delassus_reduction.h
 * @brief From the global problem to the local one and back.
 *
 *   M = C C^T,   x = C^T v,   Z = H C^-T (rows x nv),   A = G C^-T (nb x nv),   g = C^-1 f
 *   x = -g + Z^T r + A^T lambda,    u = Z x + w,    A x + b = 0
 * Without bilaterals: W = Z Z^T, q = w - Z g. Each law's rows of Z have the few columns on the elimination-tree paths
 * of its bodies; only those are formed and multiplied. With bilaterals: A^T = Q R E (column-pivoted QR, rank k <= nb;
 * redundant rows are the dependent columns), N = I - Q Q^T x = N (Z^T r - g) + Q y,  R_1^T y = -(E b)_1     so    W =
 * (Z N)(Z N)^T,  q = w + Z (Q y - N g) that is, the Schur complement written without ever squaring the condition of A.
 * lambda is the least-norm one of R E lambda = y + Q^T (g - Z^T r).
 *
 * Sizes: nv velocities, nb bilateral rows. Sources: Cadoux (2009), (1.34), (2.12); the projector form is the null-space
 * method of Benzi, Golub, Liesen (2005), section 6. Inconsistent redundant rows are left to the residual to report.
 */
#include <Eigen/Core>
#include <Eigen/QR>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/problem/mass_factor.h"

namespace frictional_contact_sim
{
class DelassusReduction
{
public:
  /** @brief Reduces; allocates only when a size or a pattern differs from the last call's (with bilaterals also the
   *  small workspaces of Eigen's QR).
   *  @throws std::invalid_argument when M is not positive definite */
  void compute(const IncrementalProblem& problem);

  /** @brief The local problem of the last compute(). */
  const DelassusProblem& problem() const { return local_; }
  /** @brief Fills v, u = H v + w and lambda from solution.r. */
  void recover(const IncrementalProblem& problem, Solution& solution);

  /** @brief Number of independent bilateral rows found. */
  int bilateralRank() const { return rank_; }
  /** @brief rho_i = 1/lambda_max(W_ii) of W = H M^-1 H^T, without the bilaterals; what the residual is measured with.
   */
  const Eigen::VectorXd& stepLengths() const { return step_lengths_; }
  /** @brief Largest entry of w - H M^-1 f, without the bilaterals [m/s]. */
  double freeVelocity() const { return free_velocity_; }
  /** @brief M^-1 f when there are bilaterals, else empty; the free generalized velocity is its opposite. */
  const Eigen::VectorXd& massInverseForce() const { return mass_inverse_force_; }

private:
  struct Pair
  {
    int i, j;  ///< j <= i
    double *lower, *upper;  ///< where W_ij and W_ji go
  };
  bool samePattern(const IncrementalProblem& problem) const;
  void analyse(const IncrementalProblem& problem);
  void collectPattern(const SparseRows& matrix, int first_row, int last_row, int mark);
  void preparePairs();
  void computeHalfRows(const IncrementalProblem& problem);
  void multiplyPairs();
  void eliminateBilaterals(const IncrementalProblem& problem);

  MassFactor factor_;
  DelassusProblem local_;
  std::vector<int> h_outer_, h_inner_;  ///< pattern of the last H
  std::vector<LawType> types_;
  std::vector<int> block_offset_;  ///< laws + 1, first row of each law
  std::vector<int> pattern_begin_;  ///< laws + 1, into pattern_
  std::vector<int> pattern_;  ///< permuted velocities touched by each law, ascending
  std::vector<int> value_begin_;  ///< laws + 1, into half_rows_
  std::vector<double> half_rows_;  ///< Z, d values a touched velocity
  std::vector<Pair> pairs_;
  std::vector<int> flags_;
  std::vector<double> work_;
  Eigen::VectorXd half_force_;  ///< g
  Eigen::VectorXd x_;
  Eigen::VectorXd base_;  ///< x at r = 0
  Eigen::VectorXd step_lengths_;
  Eigen::VectorXd mass_inverse_force_;
  double free_velocity_ = 0.0;
  bool bilateral_ = false;
  int rank_ = 0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::MatrixXd bilateral_rows_;  ///< A^T, nv x nb
  Eigen::MatrixXd basis_;  ///< Q, nv x rank
  Eigen::MatrixXd dense_rows_;  ///< Z N, rows x nv
  Eigen::MatrixXd gram_;  ///< R R^T, rank x rank
  Eigen::MatrixXd coupling_;  ///< Z Q, rows x rank
  Eigen::VectorXd particular_, coefficients_;
};

/** @brief The local problem of a global one, for tools and tests. */
DelassusProblem reduce(const IncrementalProblem& problem);

}  // namespace frictional_contact_sim
