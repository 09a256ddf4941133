#include "frictional_contact_sim/solver/convex/convex_admm.h"

#include <cmath>

#include "../options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// Residuals may differ by this ratio before rho follows.
constexpr double BALANCE = 5.0;
}  // namespace

void ConvexAdmmOptions::validate() const
{
  requireOption(max_iterations >= 1, "convex_admm.max_iterations", max_iterations, ">= 1");
  requireOption(penalty > 0.0, "convex_admm.penalty", penalty, "> 0");
  requireOption(relaxation > 0.0 && relaxation < 2.0, "convex_admm.relaxation", relaxation, "in (0, 2)");
  requireOption(balance_interval >= 1, "convex_admm.balance_interval", balance_interval, ">= 1");
}

ConvexAdmm::ConvexAdmm(const ConvexAdmmOptions& options) : ConvexSolver("convex_admm"), options_(options)
{
  options_.validate();
}

ConvexResult ConvexAdmm::doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                                 Eigen::VectorXd& u)
{
  fillMetric(problem, Metric::BLOCK, metric_);
  factor_.setOperator(*problem.W);
  double penalty = options_.penalty;
  ConvexResult result;
  result.error = optimalityError(problem, u, r);
  y_ = r;
  velocity_ = u;
  x_ = (-1.0 / penalty) * metric_.cwiseProduct(u);
  bool factored = factor_.factor(penalty * metric_.cwiseInverse());
  for (int k = 1; k <= options_.max_iterations; ++k)
  {
    if (!factored || !y_.allFinite())
    {
      result.status = ConvexStatus::FAILED;
      return result;
    }
    result.iterations = k;
    // In the form of a step from y: the factor holds the symmetric part of W only, velocity_ the product with W itself.
    r_ = -(velocity_ + penalty * x_.cwiseQuotient(metric_));
    factor_.solve(r_, r_);
    r_ += y_;
    y_old_ = y_;
    x_ += options_.relaxation * r_ + (1.0 - options_.relaxation) * y_;
    y_ = x_;
    projectOntoSets(problem, y_);
    x_ -= y_;
    problem.W->apply(y_, velocity_);
    velocity_ += problem.c;
    const double error = optimalityError(problem, velocity_, y_);
    if (error < result.error)
    {
      result.error = error;
      r = y_;
      u = velocity_;
    }
    if (result.error <= budget.tolerance)
      return result;
    if (interrupted(budget))
    {
      result.status = ConvexStatus::INTERRUPTED;
      return result;
    }
    if (k % options_.balance_interval != 0)
      continue;
    const double primal = (r_ - y_).cwiseQuotient(metric_).norm();
    const double dual = penalty * (y_ - y_old_).cwiseQuotient(metric_).norm();
    if (primal > 0.0 && dual > 0.0 && (primal > BALANCE * dual || dual > BALANCE * primal))
    {
      const double factor_of_change = std::sqrt(primal / dual);
      penalty *= factor_of_change;
      x_ /= factor_of_change;
      factored = factor_.factor(penalty * metric_.cwiseInverse());
    }
  }
  return result;
}

}  // namespace frictional_contact_sim
