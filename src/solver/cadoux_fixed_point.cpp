#include "frictional_contact_sim/solver/cadoux_fixed_point.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/solver/outer_loop.h"

namespace frictional_contact_sim
{
namespace
{
/// Halvings of the step when the iterations cycle.
constexpr int MAX_HALVINGS = 3;
}  // namespace

const OptionTable<CadouxOptions>& CadouxOptions::table()
{
  static const OptionTable<CadouxOptions> table(
      "cadoux_fixed_point",
      {
          {"inner_accuracy", &CadouxOptions::inner_accuracy, inside(0.0, 1.0), "-",
           "inner tolerance relative to the outer error"},
          {"relaxation", &CadouxOptions::relaxation, NumberRange{0.0, 1.0, true}, "-",
           "s <- s + relaxation (F(s) - s)"},
          {"initial_slip", &CadouxOptions::initial_slip, {"zero", "guess"}, "first s: 0, or |u_T| of the guess"},
          {"cycle_window", &CadouxOptions::cycle_window, atLeast(1), "iterations",
           "without progress that halve the step, up to three times"},
          {"stall_window", &CadouxOptions::stall_window, atLeast(2), "iterations",
           "without the residual falling by a tenth before giving up"},
          {"inner", &CadouxOptions::inner, innerSolverNames(), "method of the inner convex problems"},
      });
  return table;
}

void CadouxOptions::validate() const
{
  table().validate(*this);
}

CadouxFixedPoint::CadouxFixedPoint(const CadouxOptions& options, std::unique_ptr<ConvexSolver> inner)
  : Solver("cadoux_fixed_point")
  , options_(options)
  , map_(inner != nullptr ? std::move(inner) : createInnerSolver(options.inner))
{
  options_.validate();
}

void CadouxFixedPoint::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  map_.setProblem(problem, context);
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
