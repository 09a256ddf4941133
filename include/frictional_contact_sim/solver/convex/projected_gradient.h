#pragma once
/**
 * @file projected_gradient.h
 * @brief Projected gradient with Armijo's rule along the projection arc, the inner solver of the thesis.
 *
 *   r_k+1 = P(r_k - t D u_k),   u_k = W r_k + c,   t the first of t0, t0 beta, t0 beta^2, ... with
 *   f(r_k+1) - f(r_k) = u_k^T d + 1/2 d^T W d <= sigma u_k^T d,   d = r_k+1 - r_k
 * t0 of the first iteration is initial_step, then the last accepted t / beta. Operator: products W x only, one a trial.
 *
 * Source: Bertsekas (1976), "On the Goldstein-Levitin-Polyak gradient projection method"; Cadoux (2009), 4.7.2 and
 * table 5.6 (250 iterations, stop at |r_k+1 - r_k| < 1e-10): thesisOptions(). Departure of the defaults: the metric
 * D = diag(rho_i), and the stop on the optimality error.
 */
#include "frictional_contact_sim/solver/convex/convex_solver.h"

namespace frictional_contact_sim
{
struct ProjectedGradientOptions
{
  int max_iterations = 2000;  ///< >= 1
  double change_tolerance = 0.0;  ///< stop when |r_k+1 - r_k|_2 is below [N s]; 0 = only when nothing changes
  double initial_step = 1.0;  ///< t0: [-] with Metric::BLOCK, [kg] with Metric::UNIT, > 0
  double sufficient_decrease = 0.1;  ///< sigma [-], in (0, 1)
  double backtracking = 0.5;  ///< beta [-], in (0, 1)
  Metric metric = Metric::BLOCK;

  /** @brief What the experiments of the thesis use (table 5.6). */
  static ProjectedGradientOptions thesisOptions();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class ProjectedGradient : public ConvexSolver
{
public:
  explicit ProjectedGradient(const ProjectedGradientOptions& options = {});
  OperatorUse operatorUse() const override { return OperatorUse::PRODUCTS; }

protected:
  ConvexResult doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                       Eigen::VectorXd& u) override;

private:
  bool armijoStep(const ConvexProblem& problem, double& step, const Eigen::VectorXd& r, const Eigen::VectorXd& u);

  ProjectedGradientOptions options_;
  Eigen::VectorXd metric_, trial_, change_, change_velocity_;
};

}  // namespace frictional_contact_sim
