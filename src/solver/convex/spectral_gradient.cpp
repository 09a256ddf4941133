#include "frictional_contact_sim/solver/convex/spectral_gradient.h"

#include <algorithm>
#include <cmath>

#include "../options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// u is updated by a W d; recomputed this often so that round-off does not pile up.
constexpr int REFRESH = 50;
}  // namespace

void SpectralGradientOptions::validate() const
{
  requireOption(max_iterations >= 1, "spectral_gradient.max_iterations", max_iterations, ">= 1");
  requireOption(memory >= 1 && memory <= 32, "spectral_gradient.memory", memory, "in [1, 32]");
  requireOption(sufficient_decrease > 0.0 && sufficient_decrease < 1.0, "spectral_gradient.sufficient_decrease",
                sufficient_decrease, "in (0, 1)");
  requireOption(step_min > 0.0, "spectral_gradient.step_min", step_min, "> 0");
  requireOption(step_max >= step_min, "spectral_gradient.step_max", step_max, ">= step_min");
}

SpectralGradient::SpectralGradient(const SpectralGradientOptions& options)
  : ConvexSolver("spectral_gradient"), options_(options)
{
  options_.validate();
}

double SpectralGradient::spectralStep(int iteration) const
{
  const double curvature = change_.dot(change_velocity_);
  if (!(curvature > 0.0))
    return options_.step_max;
  const double step = iteration % 2 == 0 ? change_.cwiseQuotient(metric_).dot(change_) / curvature
                                         : curvature / change_velocity_.cwiseProduct(metric_).dot(change_velocity_);
  return std::clamp(step, options_.step_min, options_.step_max);
}

ConvexResult SpectralGradient::doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                                       Eigen::VectorXd& u)
{
  fillMetric(problem, options_.metric, metric_);
  ConvexResult result;
  result.error = optimalityError(problem, u, r);
  r_ = r;
  u_ = u;
  double step = 1.0;
  double value = 0.0;  // f(r_k) - f(r_0)
  std::fill(values_, values_ + options_.memory, value);
  for (int k = 1; k <= options_.max_iterations; ++k)
  {
    result.iterations = k;
    change_ = r_ - step * metric_.cwiseProduct(u_);
    projectOntoSets(problem, change_);
    change_ -= r_;
    problem.W->apply(change_, change_velocity_);
    const double slope = u_.dot(change_);
    const double curvature = change_.dot(change_velocity_);
    if (change_.isZero(0.0) || !std::isfinite(slope) || !std::isfinite(curvature))
    {
      result.status = std::isfinite(slope) ? ConvexStatus::STAGNATED : ConvexStatus::FAILED;
      return result;
    }
    const double reference = *std::max_element(values_, values_ + options_.memory);
    double length = 1.0;
    if (value + slope + 0.5 * curvature > reference + options_.sufficient_decrease * slope && curvature > 0.0)
      length = std::clamp(-slope / curvature, 1e-3, 1.0);
    value += length * slope + 0.5 * length * length * curvature;
    values_[k % options_.memory] = value;
    r_ += length * change_;
    u_ += length * change_velocity_;
    if (k % REFRESH == 0)
    {
      problem.W->apply(r_, u_);
      u_ += problem.c;
    }
    const double error = optimalityError(problem, u_, r_);
    if (error < result.error)
    {
      result.error = error;
      r = r_;
      u = u_;
    }
    if (result.error <= budget.tolerance)
      return result;
    if (interrupted(budget))
    {
      result.status = ConvexStatus::INTERRUPTED;
      return result;
    }
    step = spectralStep(k);
  }
  return result;
}

}  // namespace frictional_contact_sim
