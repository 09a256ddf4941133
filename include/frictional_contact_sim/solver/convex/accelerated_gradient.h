#pragma once
/**
 * @file accelerated_gradient.h
 * @brief Accelerated projected gradient (FISTA) with backtracking and adaptive restart.
 *
 *   r_k+1 = P(y_k - t D (W y_k + c)),   d^T W d <= d^T D^-1 d / t   with d = r_k+1 - y_k   (else t <- t/2)
 *   theta_k+1 = (1 + sqrt(1 + 4 theta_k^2)) / 2,   y_k+1 = r_k+1 + (theta_k - 1)/theta_k+1 (r_k+1 - r_k)
 *   restart (theta = 1, y = r) when (y_k - r_k+1)^T D^-1 (r_k+1 - r_k) > 0
 * t grows by step_growth after each iteration: Delassus matrices are much flatter along the iterates than their norm.
 * Operator: products W x only, one a trial (W y follows from W r by linearity).
 *
 * Source: Beck, Teboulle (2009); restart: O'Donoghue, Candes (2015), gradient scheme; growing step: Mazhar, Heyn,
 * Negrut, Tasora (2015) for cone problems of contact. The best iterate is kept: the method is not monotone.
 */
#include "frictional_contact_sim/solver/convex/convex_solver.h"

namespace frictional_contact_sim
{
struct AcceleratedGradientOptions
{
  int max_iterations = 2000;  ///< >= 1
  double initial_step = 1.0;  ///< t0: [-] with Metric::BLOCK, [kg] with Metric::UNIT, > 0
  double step_growth = 1.1;  ///< factor on t after an iteration [-], >= 1
  Metric metric = Metric::BLOCK;

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class AcceleratedGradient : public ConvexSolver
{
public:
  explicit AcceleratedGradient(const AcceleratedGradientOptions& options = {});
  OperatorUse operatorUse() const override { return OperatorUse::PRODUCTS; }

protected:
  ConvexResult doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                       Eigen::VectorXd& u) override;

private:
  bool gradientStep(const ConvexProblem& problem, double& step);

  AcceleratedGradientOptions options_;
  Eigen::VectorXd metric_;
  Eigen::VectorXd y_, y_velocity_;  ///< extrapolated point and W y + c
  Eigen::VectorXd next_, next_velocity_, change_, change_velocity_;
  Eigen::VectorXd current_, current_velocity_;
};

}  // namespace frictional_contact_sim
