#pragma once
/**
 * @file least_norm.h
 * @brief Among all impulses with the same effect those that the loads ask for: the weighted least-norm r.
 *
 *     r = argmin  sum_i |r_i|^2 / rho_i     H^T r + G^T lambda = H^T r* + G^T lambda*,    r_i in P_i
 *
 *   r*, lambda*  the answer of a method; v and u stay [N s]
 *   rho_i        1/lambda_max(W_ii), without bilaterals [kg] (so that impulses and angular impulses add up)
 *   P_i          the law's impulses at u_i; "zero" means up to the threshold of the law [m/s or rad/s]
 *                  Coulomb       u = 0: K_mu      u_T != 0, u_N = 0: the ray of r*_i      u_N > 0: r*_i
 *                  UNILATERAL    u = 0: r >= 0    u > 0: r*_i
 *                  DRY_FRICTION  u = 0: |r| <= c  u != 0: r*_i
 *
 * Nothing of the past enters: r depends on the generalized force and on the laws alone, whatever self-stress r* has.
 *
 * Method. In x = C^T v (problem/delassus_reduction.h) the multipliers are projected away, A_i = sqrt(rho_i) Z_i N, and
 * with s_i = r_i/sqrt(rho_i) the dual is free of constraints, smooth and concave:
 *     s_i = P_i(A_i y),    g(y) = b^T y - sum_i (s_i^T A_i y - |s_i|^2/2),    b = A^T s*
 *     A^T (dP) A d = b - A^T s                       semismooth Newton, Armijo's rule on g (solver/least_norm_dual)
 * It starts at the y of the least-norm s without laws; where that is within the laws, it is the answer. Every 2 g(y) is
 * a lower bound of |s|^2.
 *
 * Island by island (laws that share entries of x), only where the rows that may act are dependent. With up to
 * EXACT_ROWS rows to round-off; larger islands are left alone when |s*|^2 is at most twice a bound. Where r* is the
 * answer already (to 1e-11) its bits are kept. A result that does not give the generalized force to 1e-12 is mixed with
 * r* until it does; nothing is longer than r*, and no r_i is farther outside of P_i.
 *
 * What it does to E: an r_i in K_mu has a natural map error of at most (1 + mu) threshold, one on a ray that of r*_i
 * times |r_i|/|r*_i|. So a threshold of tolerance times S / (1 + mu) keeps an answer an answer.
 *
 * See docs/residuals.md, "Which forces"; Qi and Sun (1993) for semismooth Newton; Rockafellar (1970), section
 * 31, for the dual.
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/math/union_find.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
class DualIsland;

class LeastNorm
{
public:
  /// Islands with at most this many rows that may act get their least-norm impulses to round-off.
  static constexpr int EXACT_ROWS = 400;

  struct Report
  {
    int dependent_islands = 0;  ///< whose rows that may act are dependent
    int changed_islands = 0;  ///< whose impulses are not those of the method any more
    int inexact_islands = 0;  ///< of EXACT_ROWS at most and not brought to the optimum within the budget
    int iterations = 0;  ///< Newton steps, all islands
    double largest_ratio = 1.0;  ///< sqrt(|s*|^2 / |s|^2) of the island where it is largest [-]
  };

  LeastNorm();
  ~LeastNorm();
  LeastNorm(const LeastNorm&) = delete;
  LeastNorm& operator=(const LeastNorm&) = delete;

  /**
   * @brief Replaces solution.r and solution.lambda; v and u are read only. No allocation while the sizes repeat.
   * @param reduction of this very problem (Solver::reduction() after a solve)
   * @param thresholds a law each: |u_i| up to it counts as zero [m/s or rad/s], >= 0
   * @throws std::invalid_argument on wrong shapes
   */
  Report improve(const IncrementalProblem& problem, DelassusReduction& reduction, const Eigen::VectorXd& thresholds,
                 Solution& solution);
  /** @brief The same, reducing the problem first. */
  Report improve(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds, Solution& solution);

private:
  /// A law whose impulse may change.
  struct Member
  {
    int law = 0;
    int row = 0;  ///< its first
    int dimension = 0;  ///< of the law
    int rows = 0;  ///< degrees of freedom of its impulse: dimension, or 1 on a ray
    int kind = 0;  ///< DualSet::Kind
    double bound = 0.0;  ///< mu [-], or c [N s]
    double direction[3] = {1.0, 0.0, 0.0};  ///< of a ray
  };
  static bool makeMember(const Law& law, const double* u, const double* r, double threshold, Member& member);
  void classify(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds, const Solution& solution);
  void findIslands(const DelassusReduction& reduction, int velocities);
  void findVelocities(const DelassusReduction& reduction, size_t first, size_t last);
  static void contract(const Member& mine, const double* value, int stride, double* result);
  bool standsAlone(const DelassusReduction& reduction, const Member& mine) const;
  void forgetVelocities();
  bool isCheap(const DelassusReduction& reduction, size_t first, size_t last, int rows);
  bool isDependent(const DelassusReduction& reduction, size_t first, size_t last);
  void fillGram(const DelassusReduction& reduction, int rows);
  void gather(const DelassusReduction& reduction, size_t first, size_t last, const Solution& solution);
  void scatter(const DelassusReduction& reduction, size_t first, size_t last, Solution& solution) const;
  void improveIsland(const DelassusReduction& reduction, size_t first, size_t last, Solution& solution, Report& report);
  void recoverMultipliers(const IncrementalProblem& problem, DelassusReduction& reduction, Solution& solution);
  const Member& member(size_t k) const { return members_[static_cast<size_t>(order_[k])]; }

  std::vector<Member> members_;
  UnionFind sets_;
  std::vector<int> toucher_;  ///< of an entry of x: a member that touches it, or -1
  std::vector<char> shared_;  ///< of an entry of x: more than one member touches it
  std::vector<int> kept_;  ///< members of the island whose rows may depend on others
  std::vector<int> begin_, order_;  ///< members, island by island
  std::vector<int> island_of_member_;
  std::vector<int> place_;  ///< of an entry of x in the present island, or -1
  std::vector<int> law_member_, law_row_;  ///< of a law in the present island: its member, or -1, and row of gram_
  std::vector<int> used_;  ///< entries of x that an island touches, ascending
  std::vector<char> changed_;  ///< of an entry of x: its island has been changed
  std::vector<double> gram_;  ///< rows x rows of the members kept
  std::unique_ptr<DualIsland> dual_;
  std::unique_ptr<DelassusReduction> reduction_;  ///< for callers without one
  Eigen::VectorXd lambda_;  ///< that of r*
};

}  // namespace frictional_contact_sim
