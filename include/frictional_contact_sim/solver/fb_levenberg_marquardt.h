#pragma once
/**
 * @file fb_levenberg_marquardt.h
 * @brief fb_levenberg_marquardt: minimises 1/2 |Phi|^2 of solver/fb_system.h by damped Gauss-Newton steps.
 *
 *   (J' J + lambda I) d = -J' Phi,   lambda = damping |Phi| / |q|   [-]
 *   gain = (g(z) - g(z + d)) / (1/2 |Phi|^2 - 1/2 |Phi + J d|^2);   accepted when gain > smallest_gain
 *   damping <- damping max(1/3, 1 - (2 gain - 1)^3) after an accepted step, x 2, 4, 8, ... after refused ones
 *
 * J singular does no harm. lambda proportional to |Phi| keeps fast convergence to non-isolated solutions (hyperstatic
 * impulses). A stationary point of the merit that is no solution ends the run as STAGNATED.
 * Source: Cadoux (2009), 4.5.2, (4.14); Nielsen (1999) for the rule; Yamashita, Fukushima (2001), Fan, Yuan (2005), for
 * lambda ~ |Phi|.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/solver/fb_system.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct FbLevenbergMarquardtOptions
{
  double first_damping = 0.1;  ///< [-], > 0
  double smallest_damping = 1e-6;  ///< [-], in (0, first_damping]
  double smallest_gain = 1e-4;  ///< actual over predicted decrease from which a step is accepted [-], in (0, 1)

  /** @brief What each is, as data. */
  static const OptionTable<FbLevenbergMarquardtOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class FbLevenbergMarquardt : public Solver
{
public:
  explicit FbLevenbergMarquardt(const FbLevenbergMarquardtOptions& options = {});
  void setOptions(const FbLevenbergMarquardtOptions& options);

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  bool tryStep(double lambda, double& merit, double& gain);

  FbLevenbergMarquardtOptions options_;
  FbSystem system_;
  FbSteps steps_;
  Eigen::VectorXd z_, c_, step_, trial_z_, trial_c_, r_, u_;
};

}  // namespace frictional_contact_sim
