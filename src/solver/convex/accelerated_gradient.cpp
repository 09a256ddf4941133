#include "frictional_contact_sim/solver/convex/accelerated_gradient.h"

#include <cmath>

#include "../options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// Velocities are combined linearly; recomputed this often so that round-off does not pile up.
constexpr int REFRESH = 50;
constexpr int MAX_TRIALS = 60;
/// Slack of the curvature test: at convergence both sides are round-off.
constexpr double CURVATURE_SLACK = 1.0 + 1e-10;
}  // namespace

void AcceleratedGradientOptions::validate() const
{
  requireOption(max_iterations >= 1, "accelerated_gradient.max_iterations", max_iterations, ">= 1");
  requireOption(initial_step > 0.0, "accelerated_gradient.initial_step", initial_step, "> 0");
  requireOption(step_growth >= 1.0, "accelerated_gradient.step_growth", step_growth, ">= 1");
}

AcceleratedGradient::AcceleratedGradient(const AcceleratedGradientOptions& options)
  : ConvexSolver("accelerated_gradient"), options_(options)
{
  options_.validate();
}

bool AcceleratedGradient::gradientStep(const ConvexProblem& problem, double& step)
{
  for (int trial = 0; trial < MAX_TRIALS; ++trial, step *= 0.5)
  {
    next_ = y_ - step * metric_.cwiseProduct(y_velocity_);
    projectOntoSets(problem, next_);
    change_ = next_ - y_;
    problem.W->apply(change_, change_velocity_);
    const double length = change_.cwiseQuotient(metric_).dot(change_);
    if (step * change_.dot(change_velocity_) <= CURVATURE_SLACK * length)
      return true;
  }
  return false;
}

ConvexResult AcceleratedGradient::doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                                          Eigen::VectorXd& u)
{
  fillMetric(problem, options_.metric, metric_);
  y_ = current_ = r;
  y_velocity_ = current_velocity_ = u;
  ConvexResult result;
  result.error = optimalityError(problem, u, r);
  double step = options_.initial_step;
  double theta = 1.0;
  for (int k = 1; k <= options_.max_iterations; ++k)
  {
    result.iterations = k;
    if (!gradientStep(problem, step))
    {
      result.status = ConvexStatus::FAILED;
      return result;
    }
    next_velocity_ = y_velocity_ + change_velocity_;
    if (k % REFRESH == 0)
    {
      problem.W->apply(next_, next_velocity_);
      next_velocity_ += problem.c;
    }
    const double error = optimalityError(problem, next_velocity_, next_);
    if (error < result.error)
    {
      result.error = error;
      r = next_;
      u = next_velocity_;
    }
    if (result.error <= budget.tolerance)
      return result;
    if (interrupted(budget))
    {
      result.status = ConvexStatus::INTERRUPTED;
      return result;
    }
    current_ = next_ - current_;  // r_k+1 - r_k
    current_velocity_ = next_velocity_ - current_velocity_;
    if (change_.cwiseQuotient(metric_).dot(current_) < 0.0)
      theta = 1.0;
    const double next_theta = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * theta * theta));
    const double momentum = (theta - 1.0) / next_theta;
    theta = next_theta;
    y_ = next_ + momentum * current_;
    y_velocity_ = next_velocity_ + momentum * current_velocity_;
    current_ = next_;
    current_velocity_ = next_velocity_;
    step *= options_.step_growth;
  }
  return result;
}

}  // namespace frictional_contact_sim
