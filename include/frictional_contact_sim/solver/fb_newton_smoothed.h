#pragma once
/**
 * @file fb_newton_smoothed.h
 * @brief fb_newton_smoothed: Newton on the smoothed Fischer-Burmeister system, the smoothing driven to zero.
 *
 *   for alpha = first_smoothing |q|_inf, decrease alpha, ...:   Phi_alpha of solver/fb_system.h
 *     a few steps  J d = -Phi_alpha,  z <- z + t d,  t by backtracking on 1/2 |Phi_alpha|^2,
 *     until |Phi_alpha| <= inner_share alpha sqrt(rows) or inner_iterations
 * When the Newton step is not finite or gives no decrease, the damped least-squares step (J' J + lambda I) d = -J' Phi
 * replaces it, lambda growing (unless least_squares is off). When that gives none either, down to alpha = 0, the run
 * starts anew from the guess with another first alpha (x and / restart_factor, then its square, ...), at most
 * `restarts` times. For alpha > 0 the function is smooth but for |u_T| in De Saxce's shift.
 *
 * Source: Cadoux (2009), 4.2.3 (approach by regularisation); Fukushima, Luo, Tseng (2002); Hayashi, Yamashita,
 * Fukushima (2005). Departure: new starts.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/solver/fb_system.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct FbNewtonSmoothedOptions
{
  double first_smoothing = 0.1;  ///< alpha at the start over the largest free velocity (scaled variables) [-], > 0
  double smoothing_decrease = 0.5;  ///< factor on alpha [-], in (0, 1)
  double inner_share = 0.1;  ///< inner tolerance over alpha, per row [-], > 0
  int inner_iterations = 15;  ///< steps an alpha, >= 1
  bool least_squares = true;  ///< false: a failed Newton step is followed by the next alpha at once
  int restarts = 4;  ///< new starts when no step decreases the merit, >= 0
  double restart_factor = 5.0;  ///< on the first alpha of a new start [-], > 1
  int line_search_steps = 12;  ///< halvings of t, >= 0
  double sufficient_decrease = 1e-4;  ///< Armijo constant [-], in (0, 0.5)

  /** @brief What each is, as data. */
  static const OptionTable<FbNewtonSmoothedOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class FbNewtonSmoothed : public Solver
{
public:
  explicit FbNewtonSmoothed(const FbNewtonSmoothedOptions& options = {});
  void setOptions(const FbNewtonSmoothedOptions& options);

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  bool lineSearch(double alpha, double merit, int halvings);
  bool step(double alpha, double merit);
  bool restart(double largest);
  bool nextSmoothing(double largest, double root_rows, double& merit);

  FbNewtonSmoothedOptions options_;
  FbSystem system_;
  FbSteps steps_;
  Eigen::VectorXd start_, z_, c_, step_, step_velocity_, trial_z_, trial_c_, r_, u_;
  double alpha_ = 0.0;
  int inner_ = 0;  ///< steps since alpha changed
  int restarts_ = 0;
  int factorizations_ = 0;  ///< of the last step
  bool stuck_ = false;  ///< the last step found no decrease
};

}  // namespace frictional_contact_sim
