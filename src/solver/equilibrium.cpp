#include "frictional_contact_sim/solver/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/convex/convex_problem.h"
#include "frictional_contact_sim/solver/convex/convex_solver.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double CERTIFICATE = 1e-6;  ///< of the largest velocity: how far outside L* round-off may leave v

/** How far inside L* the velocities are; see Equilibrium::reach. */
double reachOf(const IncrementalProblem& problem, const Eigen::VectorXd& u)
{
  double least = 0.0;
  Eigen::Index row = 0;
  for (const Law& law : problem.laws)
  {
    const int size = law.dimension();
    if (law.isCoulomb())
      least = std::min(least, u[row] - law.coefficient * u.segment(row + 1, size - 1).norm());
    else if (law.isOneSided())
      least = std::min(least, u[row]);
    row += size;
  }
  const double largest = maxAbs(u);
  return largest > 0.0 ? least / largest : 0.0;
}
}  // namespace

Equilibrium findEquilibrium(const IncrementalProblem& problem, double tolerance)
{
  IncrementalProblem still = problem;
  still.w.setZero();
  still.b.setZero();
  DelassusReduction reduction;
  reduction.compute(still);
  const DelassusProblem& local = reduction.problem();
  Equilibrium result;
  result.solution.r.setZero(still.rows());
  result.solution.lambda.setZero(still.bilaterals());
  const double load = std::sqrt(2.0 * reduction.freeEnergy());
  if (still.rows() > 0 && load > 0.0)
  {
    ConvexProblem convex;
    makeConeProblem(local, reduction.stepLengths(), convex);
    Eigen::VectorXd u;
    ConvexBudget budget;
    budget.tolerance = std::max(1e-3 * tolerance, 1e-13) * std::max(maxAbs(local.q), 1e-300);
    double best = std::numeric_limits<double>::infinity();
    for (const char* const method : {"convex_interior_point", "accelerated_gradient"})
    {
      Eigen::VectorXd r = result.solution.r;
      const ConvexResult solved = createConvexSolver(method)->solve(convex, budget, r, u);
      result.iterations += solved.iterations;
      if (solved.error < best)
      {
        best = solved.error;
        result.solution.r = r;
      }
      if (solved.status == ConvexStatus::CONVERGED)
        break;
    }
  }
  reduction.recover(still, result.solution);
  const Eigen::VectorXd& v = result.solution.v;
  const double left = std::sqrt(std::max(0.0, v.dot(still.M * v)));
  result.share = load > 0.0 ? left / load : 0.0;
  result.exists = result.share <= tolerance;
  if (result.exists)
  {
    result.solution.v.setZero();
    result.solution.u.setZero();
    result.residual = evaluateResidual(still, result.solution).value();
    return result;
  }
  result.reach = reachOf(still, result.solution.u);
  result.is_proven = result.reach >= -CERTIFICATE && still.f.dot(v) < 0.0 &&
                     (still.bilaterals() == 0 || maxAbs(still.G * v) <= CERTIFICATE * maxAbs(v));
  return result;
}

}  // namespace frictional_contact_sim
