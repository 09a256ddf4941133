#pragma once
/**
 * @file delassus_reduction.h
 * @brief From the global problem to the local one and back.
 *
 *   M = C C^T,   x = C^T v,   Z = H C^-T (rows x nv),   A = G C^-T (nb x nv),   g = C^-1 f
 *   x = -g + Z^T r + A^T lambda,    u = Z x + w,    A x + b = 0
 * Without bilaterals: W = Z Z^T, q = w - Z g. Each law's rows of Z have the few columns on the elimination-tree paths
 * of its bodies; only those are formed and multiplied, and only when W is wanted (see OperatorKind). With bilaterals: E
 * A = L Q^T (orthogonal_rows.h, rank k <= nb; redundant rows are the dependent ones), N = I - Q Q^T, x = N (Z^T r - g)
 * + Q y,   L_1 y = -(E b)_1     so    W = (Z N)(Z N)^T,   q = w + Z (Q y - N g) that is, the Schur complement written
 * without ever squaring the condition of A. lambda is the least-norm one of A^T lambda = Q (y + Q^T (g - Z^T r)). Q is
 * found loop by loop: bilateral rows that share no velocity in A have factors of their own, and a law touches all
 * velocities of the loops it touches, no others.
 *
 * Sizes: nv velocities, nb bilateral rows. Sources: Cadoux (2009), (1.34), (2.12); the projector form is the null-space
 * method of Benzi, Golub, Liesen (2005), section 6. Inconsistent redundant rows are left to the residual to report.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/problem/mass_factor.h"
#include "frictional_contact_sim/problem/orthogonal_rows.h"

namespace frictional_contact_sim
{
class DelassusReduction
{
public:
  /**
   * @brief Reduces; allocates only when a size or a pattern differs from the last call's.
   * @param kind how W is kept; MATRIX_FREE never forms it
   * @throws std::invalid_argument when M is not positive definite
   */
  void compute(const IncrementalProblem& problem, OperatorKind kind = OperatorKind::AUTOMATIC);

  /** @brief The local problem of the last compute(). */
  const DelassusProblem& problem() const { return local_; }
  /** @brief Fills v, u = H v + w and lambda from solution.r. */
  void recover(const IncrementalProblem& problem, Solution& solution);

  /** @brief The least-norm lambda of solution.r alone; v and u are left as they are. Part of recover(). */
  void recoverMultipliers(const IncrementalProblem& problem, Solution& solution);
  /** @brief Index in x of a velocity of the problem. */
  int permuted(int velocity) const { return factor_.permuted(velocity); }
  /** @brief Velocities in x that a law's rows of Z N touch, ascending, and their values, dimension() a velocity. */
  const int* halfRowBegin(int law) const { return pattern_.data() + pattern_begin_[static_cast<size_t>(law)]; }
  const int* halfRowEnd(int law) const { return pattern_.data() + pattern_begin_[static_cast<size_t>(law) + 1]; }
  const double* halfRowValues(int law) const { return half_rows_.data() + value_begin_[static_cast<size_t>(law)]; }

  /** @brief Number of independent bilateral rows found. */
  int bilateralRank() const { return rank_; }
  /** @brief rho_i = 1/lambda_max(W_ii) of W = H M^-1 H^T, without the bilaterals; what the residual is measured with.
   */
  const Eigen::VectorXd& stepLengths() const { return step_lengths_; }
  /** @brief w - H M^-1 f, without the bilaterals [m/s]. */
  const Eigen::VectorXd& freeVelocity() const { return loop_of_.empty() ? local_.q : free_velocity_; }
  /** @brief 1/2 f' M^-1 f, the kinetic energy of the free motion [J]. */
  double freeEnergy() const { return 0.5 * half_force_.squaredNorm(); }
  /** @brief M^-1 f when there are bilaterals, else empty; the free generalized velocity is its opposite. */
  const Eigen::VectorXd& massInverseForce() const { return mass_inverse_force_; }

private:
  struct Pair
  {
    int i, j;  ///< j <= i
    bool same;  ///< both laws touch the same velocities
    double *lower, *upper;  ///< where W_ij and W_ji go
  };
  /// Bilateral rows that share velocities, and those velocities (permuted, ascending).
  struct Loop
  {
    std::vector<int> rows, velocities;
    OrthogonalRows factor;
    Eigen::VectorXd particular;  ///< y
    Eigen::VectorXd b, part, coordinates;  ///< workspace
  };
  bool samePattern(const IncrementalProblem& problem) const;
  void analyse(const IncrementalProblem& problem);
  void findLoops(const SparseRows& G);
  void collectPattern(const SparseRows& matrix, int first_row, int last_row, int mark);
  void addLoops(size_t law, int mark);
  void preparePairs();
  bool sameVelocities(int i, int j) const;
  void findFresh(const IncrementalProblem& problem);
  void computeHalfRows(const IncrementalProblem& problem);
  void multiplyHalfRows(const Eigen::VectorXd& x, Eigen::VectorXd& rows) const;
  void multiplyPairs();
  void factorLoops(const IncrementalProblem& problem);
  void projectHalfRows();

  MassFactor factor_;
  DelassusProblem local_;
  OperatorKind kind_ = OperatorKind::AUTOMATIC;
  std::vector<int> h_outer_, h_inner_, g_outer_, g_inner_;  ///< patterns of the last H and G
  std::vector<double> h_values_;  ///< of the last H; empty after analyse()
  /// Laws whose half rows are to be formed, and with them their part of W: those are kept while neither their rows of H
  /// nor the factor of what they touch change, as those of an elastic body at rest. (With bilaterals Z N is in place.)
  std::vector<char> is_fresh_;
  std::vector<LawType> types_;
  std::vector<int> block_offset_;  ///< laws + 1, first row of each law
  std::vector<int> pattern_begin_;  ///< laws + 1, into pattern_
  std::vector<int> pattern_;  ///< permuted velocities touched by each law, ascending
  std::vector<int> value_begin_;  ///< laws + 1, into half_rows_
  std::vector<double> half_rows_;  ///< Z, with bilaterals Z N; d values a touched velocity
  std::vector<Pair> pairs_;
  std::vector<Loop> loops_;
  std::vector<int> loop_of_;  ///< nv, the loop a permuted velocity is in, or -1; empty without bilaterals
  std::vector<int> law_loop_begin_, law_loops_;  ///< loops each law touches
  std::vector<int> flags_;
  std::vector<int> root_begin_, root_laws_;  ///< laws of each root of the elimination tree
  std::vector<int> meeting_begin_, meeting_;  ///< laws that share one with each law, itself too, ascending
  std::vector<int> mark_;
  std::vector<double> work_;
  Eigen::VectorXd half_force_;  ///< g
  Eigen::VectorXd x_;
  Eigen::VectorXd base_;  ///< x at r = 0
  Eigen::VectorXd momentum_;
  Eigen::VectorXd step_lengths_;
  Eigen::VectorXd mass_inverse_force_;
  Eigen::VectorXd free_velocity_;  ///< with bilaterals only
  DelassusOperator unconstrained_;  ///< Z Z^T, with bilaterals only
  Eigen::MatrixXd gathered_, coupling_;  ///< columns of one law's Z in one loop, and their product with Q
  int rank_ = 0;
};

/** @brief The local problem of a global one, for tools and tests. */
DelassusProblem reduce(const IncrementalProblem& problem);

}  // namespace frictional_contact_sim
