#include "frictional_contact_sim/solver/convex/convex_interior_point.h"

#include <algorithm>
#include <limits>

#include "../options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// A step this short no longer moves anything.
constexpr double SHORTEST_STEP = 1e-10;
/// Iterations without a better error after which round-off has won.
constexpr int PATIENCE = 10;
}  // namespace

void ConvexInteriorPointOptions::validate() const
{
  requireOption(max_iterations >= 1, "convex_interior_point.max_iterations", max_iterations, ">= 1");
  requireOption(warm_shift >= 0.0, "convex_interior_point.warm_shift", warm_shift, ">= 0");
  step.validate();
}

ConvexInteriorPoint::ConvexInteriorPoint(const ConvexInteriorPointOptions& options)
  : ConvexSolver("convex_interior_point"), options_(options), iteration_(options.step)
{
  options_.validate();
}

ConvexResult ConvexInteriorPoint::doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                                          Eigen::VectorXd& u)
{
  ConvexResult result;
  result.error = optimalityError(problem, u, r);
  if (options_.warm_shift > 0.0 && !r.isZero(0.0))
  {
    run(problem, budget, options_.warm_shift * result.error, r, u, result);
    if (result.error <= budget.tolerance || result.status == ConvexStatus::INTERRUPTED)
      return result;
  }
  run(problem, budget, std::numeric_limits<double>::infinity(), r, u, result);
  return result;
}

void ConvexInteriorPoint::run(const ConvexProblem& problem, const ConvexBudget& budget, double shift,
                              Eigen::VectorXd& r, Eigen::VectorXd& u, ConvexResult& result)
{
  iteration_.start(problem, r, u, shift);
  result.status = ConvexStatus::MAX_ITERATIONS;
  double run_best = std::numeric_limits<double>::infinity();
  int since_better = 0;
  for (int k = 1; k <= options_.max_iterations; ++k)
  {
    const double length = iteration_.step(problem);
    ++result.iterations;
    const double error = length > 0.0 ? optimalityError(problem, iteration_.u(), iteration_.r()) : run_best;
    since_better = error < run_best ? 0 : since_better + 1;
    run_best = std::min(run_best, error);
    if (error < result.error)
    {
      result.error = error;
      r = iteration_.r();
      u = iteration_.u();
    }
    if (result.error <= budget.tolerance)
      return;
    if (length < SHORTEST_STEP || since_better >= PATIENCE)
    {
      result.status = length > 0.0 ? ConvexStatus::STAGNATED : ConvexStatus::FAILED;
      return;
    }
    if (interrupted(budget))
    {
      result.status = ConvexStatus::INTERRUPTED;
      return;
    }
  }
}

}  // namespace frictional_contact_sim
