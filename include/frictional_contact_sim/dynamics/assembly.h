#pragma once
/**
 * @file assembly.h
 * @brief State + contact points + dt to the incremental problem of one step (Moreau's midpoint scheme).
 *
 *     M = M(q_m) + dt^2/4 K + dt D                              servo stiffness K at the midpoint, damping D at the end
 *     f = -M(q_m) v_k + dt (bias(q_m, v_m) - applied) - c       c: servo offsets, see actuation.h
 *     u = H v + w,   G v + b = 0                                the rows of all row sources (row_source.h)
 *
 * with the predicted v_m = (v_k + v_free)/2, v_free the solution of M v + f = H^T r_last with bias at v_k and the last
 * step's impulses of contacts that persist: second order, and at rest exactly zero. Source: Cadoux (2009),
 * (2.28)-(2.31).
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/dynamics/body.h"
#include "frictional_contact_sim/dynamics/energy_ledger.h"
#include "frictional_contact_sim/dynamics/row_source.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
class StepAssembly
{
public:
  /** @brief Sizes everything; the bodies may not change in number afterwards, and outlive this. */
  StepAssembly(std::vector<Body>& bodies, std::vector<std::unique_ptr<RowSource>> sources, RowState& state);

  /** @brief Once a step (or impact), before assembleRows. Bodies' middle data are at q_m. Sets context.v_old. */
  void begin(StepContext& context);
  /** @brief Rows H, w, G, b, laws of one step or impact. */
  void assembleRows(const StepContext& context);
  /** @brief v at the start, impulses of the last step. */
  void makeGuess(const StepContext& context, Solution& guess) const;
  /**
   * @brief M and f, after assembleRows; in an impact M v - M v_k = H^T r.
   * @param guess its impulses give the predicted midpoint velocity
   * @return index of a body whose mass matrix is not positive definite, else -1
   */
  int assembleDynamics(const StepContext& context, const Solution& guess);
  /** @brief A problem without rows and forces, in place of one that could not be assembled. */
  void clear();

  /** @brief Whether rows want the step solved again. @param converged the solve's verdict */
  Again again(const StepContext& context, const Solution& solution, bool converged);
  /** @brief Name of the rows that said anything but NO last. */
  const char* unsatisfied() const { return unsatisfied_; }
  /** @brief Sets the bodies' v_middle to the mean of old and new velocity. */
  void setMeanVelocity(const Solution& solution);
  /** @brief Books the work of every impulse of a solved step; needs setMeanVelocity, the state still the old one. */
  void book(const StepContext& context, const Solution& solution, EnergyLedger& ledger) const;
  /** @brief Hands the answer of the step to all rows. */
  void accept(const StepContext& context, const StepAnswer& answer);

  const IncrementalProblem& problem() const { return problem_; }
  /** @brief Velocities of the bodies, without auxiliary ones. */
  int velocities() const { return velocities_; }
  /** @brief True when a contact or limit closes: an impact has something to solve. */
  bool closing() const { return sink_.closing(); }
  /** @brief Largest position error of bilateral rows at the midpoint [m] or [rad]. */
  double bilateralViolation() const;

private:
  void assembleMass(bool with_implicit);
  void bookRow(const RowBuilder& rows, int row, double impulse, const RowRecord& record, EnergyLedger& ledger) const;

  std::vector<Body>& bodies_;
  std::vector<std::unique_ptr<RowSource>> sources_;
  RowState& state_;
  const char* unsatisfied_ = "";
  int velocities_ = 0;
  Eigen::VectorXd v_old_;  ///< velocities_: at the start of the step
  Eigen::VectorXd v_mean_;  ///< of the bodies, 0 for auxiliary columns
  Eigen::VectorXd impulse_;  ///< generalized impulse of the guess
  Eigen::VectorXd momentum_;  ///< without bias, body by body
  RowSink sink_;
  RowBuilder rows_m_;
  std::vector<std::vector<int>> mass_columns_;  ///< tree pattern of M, row by row
  IncrementalProblem problem_;
};

}  // namespace frictional_contact_sim
