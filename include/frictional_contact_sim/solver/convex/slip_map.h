#pragma once
/**
 * @file slip_map.h
 * @brief Cadoux's fixed-point function F, evaluated by an inner convex solver.
 *
 *   r(s) in argmin { 1/2 r^T W r + (q + E s)^T r : r in L }                  (3.13), E s = mu_i s_i on normal rows
 *   u~(s) = W r(s) + q + E s,    F_i(s) = |u~_T,i(s)| = |u_T,i(s)| [m/s]      (3.16)
 * A fixed point with a dual solution r solves the incremental problem. s has one entry for each Coulomb contact with
 * mu > 0 and no other: frictionless contacts and one-dimensional laws never enter it (remark 4.18).
 *
 * Unqualified fixed points (example 3.21): C(s) has no interior, the minimum over r is not attained and r runs to
 * infinity along a direction d with W d = 0, (q + E s).d <= 0. isUnqualified() recognises that direction.
 * Source: Cadoux (2009), sections 3.2.2, 4.7.
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/solver/convex/convex_solver.h"
#include "frictional_contact_sim/solver/solve_context.h"

namespace frictional_contact_sim
{
/** @brief True when r is, numerically, a direction along which the convex problem does not grow (huge, W r and c.r
 * nearly zero beside it): the answer of a run that has nothing to converge to. u = W r + c. */
bool isUnqualified(const ConvexProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r);

class SlipMap
{
public:
  explicit SlipMap(std::unique_ptr<ConvexSolver> inner);
  ~SlipMap();
  /** @brief What the inner solver needs of W. */
  OperatorUse operatorUse() const;

  /** @brief Makes the cone problem; sizes s() to the frictional contacts. */
  void setProblem(const DelassusProblem& problem, const SolveContext& context);
  /** @brief r and s = |u_T(r)| from a guess of the impulses. */
  void setGuess(const Eigen::VectorXd& r);
  /** @brief Evaluates F at s from the present r. */
  ConvexResult evaluate(const Eigen::VectorXd& s, const ConvexBudget& budget);
  /** @brief The same, to a tolerance relative to the smallest scale of E; sets budget.tolerance. */
  ConvexResult evaluate(const Eigen::VectorXd& s, double relative_tolerance, ConvexBudget& budget);

  int size() const { return static_cast<int>(contacts_.size()); }
  /** @brief Law index of entry k of s. */
  int contact(int k) const { return contacts_[static_cast<size_t>(k)]; }
  const Eigen::VectorXd& value() const { return value_; }
  const Eigen::VectorXd& r() const { return r_; }
  /** @brief W r + q, without the shift E s. */
  const Eigen::VectorXd& u() const { return u_; }
  const Eigen::VectorXd& shiftedVelocity() const { return shifted_; }
  const ConvexProblem& convexProblem() const { return convex_; }

private:
  void slip();

  std::unique_ptr<ConvexSolver> inner_;
  const DelassusProblem* problem_ = nullptr;
  ConvexProblem convex_;
  double velocity_scale_ = 0.0;  ///< [m/s]
  std::vector<int> contacts_;
  Eigen::VectorXd value_, r_, u_, shifted_;
};

}  // namespace frictional_contact_sim
