#include "frictional_contact_sim/solver/convex/projected_gradient.h"

#include "../options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// u is updated by W d; recomputed this often so that round-off does not pile up.
constexpr int REFRESH = 50;
/// More halvings than double precision can tell apart.
constexpr int MAX_TRIALS = 60;
}  // namespace

ProjectedGradientOptions ProjectedGradientOptions::thesisOptions()
{
  ProjectedGradientOptions options;
  options.max_iterations = 250;
  options.change_tolerance = 1e-10;
  options.metric = Metric::UNIT;
  return options;
}

void ProjectedGradientOptions::validate() const
{
  requireOption(max_iterations >= 1, "projected_gradient.max_iterations", max_iterations, ">= 1");
  requireOption(change_tolerance >= 0.0, "projected_gradient.change_tolerance", change_tolerance, ">= 0");
  requireOption(initial_step > 0.0, "projected_gradient.initial_step", initial_step, "> 0");
  requireOption(sufficient_decrease > 0.0 && sufficient_decrease < 1.0, "projected_gradient.sufficient_decrease",
                sufficient_decrease, "in (0, 1)");
  requireOption(backtracking > 0.0 && backtracking < 1.0, "projected_gradient.backtracking", backtracking, "in (0, 1)");
}

ProjectedGradient::ProjectedGradient(const ProjectedGradientOptions& options)
  : ConvexSolver("projected_gradient"), options_(options)
{
  options_.validate();
}

bool ProjectedGradient::armijoStep(const ConvexProblem& problem, double& step, const Eigen::VectorXd& r,
                                   const Eigen::VectorXd& u)
{
  for (int trial = 0; trial < MAX_TRIALS; ++trial, step *= options_.backtracking)
  {
    trial_ = r - step * metric_.cwiseProduct(u);
    projectOntoSets(problem, trial_);
    change_ = trial_ - r;
    problem.W->apply(change_, change_velocity_);
    // By the projection u.d <= -d.D^-1 d / t, so the second test implies Armijo's. It is what decides near the
    // solution, where u.d is a difference of terms that are larger than itself by 1/epsilon.
    const double curvature = 0.5 * change_.dot(change_velocity_);
    const double length = change_.cwiseQuotient(metric_).dot(change_) / step;
    const double share = 1.0 - options_.sufficient_decrease;
    if (curvature <= -share * u.dot(change_) || curvature <= share * length)
      return true;
  }
  return false;
}

ConvexResult ProjectedGradient::doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                                        Eigen::VectorXd& u)
{
  fillMetric(problem, options_.metric, metric_);
  ConvexResult result;
  result.error = optimalityError(problem, u, r);
  double step = options_.initial_step;
  for (int k = 1; k <= options_.max_iterations; ++k)
  {
    result.iterations = k;
    if (!armijoStep(problem, step, r, u))
    {
      result.status = ConvexStatus::STAGNATED;
      return result;
    }
    r = trial_;
    u += change_velocity_;
    if (k % REFRESH == 0)
    {
      problem.W->apply(r, u);
      u += problem.c;
    }
    result.error = optimalityError(problem, u, r);
    if (result.error <= budget.tolerance)
      return result;
    const double change = change_.norm();
    if (change == 0.0 || change < options_.change_tolerance || interrupted(budget))
    {
      result.status = interrupted(budget) ? ConvexStatus::INTERRUPTED : ConvexStatus::STAGNATED;
      return result;
    }
    step /= options_.backtracking;
  }
  return result;
}

}  // namespace frictional_contact_sim
