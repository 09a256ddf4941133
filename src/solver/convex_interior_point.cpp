#include "frictional_contact_sim/solver/convex/convex_interior_point.h"

#include <limits>

#include "options_check.h"

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
  const bool warm = options_.warm_shift > 0.0 && !r.isZero(0.0);
  iteration_.start(problem, r, u, warm ? options_.warm_shift * result.error : std::numeric_limits<double>::infinity());
  int since_better = 0;
  for (int k = 1; k <= options_.max_iterations; ++k)
  {
    const double length = iteration_.step(problem);
    result.iterations = k;
    const double error = length > 0.0 ? optimalityError(problem, iteration_.u(), iteration_.r()) : result.error;
    ++since_better;
    if (error < result.error)
    {
      since_better = 0;
      result.error = error;
      r = iteration_.r();
      u = iteration_.u();
    }
    if (result.error <= budget.tolerance)
      return result;
    if (length < SHORTEST_STEP || since_better >= PATIENCE)
    {
      result.status = length > 0.0 ? ConvexStatus::STAGNATED : ConvexStatus::FAILED;
      return result;
    }
    if (interrupted(budget))
    {
      result.status = ConvexStatus::INTERRUPTED;
      return result;
    }
  }
  return result;
}

}  // namespace frictional_contact_sim
