#include "frictional_contact_sim/solver/cadoux_fixed_point.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/solver/convex/spectral_gradient.h"
#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// Halvings of the step when the iterations cycle.
constexpr int MAX_HALVINGS = 3;
}  // namespace

void CadouxOptions::validate() const
{
  requireOption(inner_accuracy > 0.0 && inner_accuracy < 1.0, "cadoux.inner_accuracy", inner_accuracy, "in (0, 1)");
  requireOption(relaxation > 0.0 && relaxation <= 1.0, "cadoux.relaxation", relaxation, "in (0, 1]");
  requireOption(cycle_window >= 1, "cadoux.cycle_window", cycle_window, ">= 1");
  requireOption(stall_window >= 2, "cadoux.stall_window", stall_window, ">= 2");
}

CadouxFixedPoint::CadouxFixedPoint(const CadouxOptions& options, std::unique_ptr<ConvexSolver> inner)
  : Solver("cadoux_fixed_point")
  , options_(options)
  , map_(inner != nullptr ? std::move(inner) : std::make_unique<SpectralGradient>())
{
  options_.validate();
}

void CadouxFixedPoint::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  map_.setProblem(problem, context.step_lengths);
  map_.setGuess(result.solution.r);
  s_ = map_.value();
  if (options_.initial_slip == InitialSlip::ZERO)
    s_.setZero();
  OuterLoop loop(context, result, options_.stall_window);
  const double first_residual = context.residual(problem, map_.u(), map_.r());
  if (loop.record(first_residual, map_.r()))
    return;
  ConvexBudget budget;
  budget.interrupted = [&context] { return context.spend(1.0); };  // a product an inner iteration
  bool raised = false;
  while (!loop.outOfBudget("outer iterations exhausted"))
  {
    const ConvexResult inner = map_.evaluate(s_, loop.innerTolerance(options_.inner_accuracy, map_.size() > 0), budget);
    ++result.iterations;
    if (!raised && map_.size() > 0 && inner.status != ConvexStatus::CONVERGED &&
        isUnqualified(map_.convexProblem(), map_.shiftedVelocity(), map_.r()))
    {
      raised = true;
      s_.array() += problem.q.lpNorm<Eigen::Infinity>();
      map_.setGuess(Eigen::VectorXd::Zero(problem.W.rows()));
      continue;
    }
    if (loop.record(context.residual(problem, map_.u(), map_.r()), map_.r()))
      return;
    // A cycle of F is broken by averaging: half the step after each cycle_window iterations without progress.
    const int halvings = std::min(loop.sinceProgress() / options_.cycle_window, MAX_HALVINGS);
    s_ += std::ldexp(options_.relaxation, -halvings) * (map_.value() - s_);
  }
}

}  // namespace frictional_contact_sim
