#include "frictional_contact_sim/solver/haslinger.h"

#include <algorithm>

#include "frictional_contact_sim/solver/convex/slip_map.h"
#include "frictional_contact_sim/solver/outer_loop.h"

namespace frictional_contact_sim
{
const OptionTable<HaslingerOptions>& HaslingerOptions::table()
{
  static const OptionTable<HaslingerOptions> table(
      "haslinger", {
                       {"inner_accuracy", &HaslingerOptions::inner_accuracy, inside(0.0, 1.0), "-",
                        "inner tolerance relative to the outer error"},
                       {"relaxation", &HaslingerOptions::relaxation, NumberRange{0.0, 1.0, true}, "-",
                        "s <- s + relaxation (mu r_N - s)"},
                       {"slowest", &HaslingerOptions::slowest, aboveOrInfinite(0.0), "-",
                        "share of the residual that an outer iteration may leave"},
                       {"stall_window", &HaslingerOptions::stall_window, atLeast(2), "iterations",
                        "without the residual falling by a tenth before giving up"},
                       {"inner", &HaslingerOptions::inner, innerSolverNames(), "method of the inner convex problems"},
                   });
  return table;
}

void HaslingerOptions::validate() const
{
  table().validate(*this);
}

Haslinger::Haslinger(const HaslingerOptions& options, std::unique_ptr<ConvexSolver> inner)
  : Solver("haslinger")
  , options_(options)
  , inner_(inner != nullptr ? std::move(inner) : createInnerSolver(options.inner))
{
  options_.validate();
}

void Haslinger::updateThresholds(const DelassusProblem& problem, double relaxation)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    if (!law.isCoulomb())
      continue;
    const double target = law.coefficient * std::max(0.0, r_[problem.W.offset(i)]);
    thresholds_[i] += relaxation * (target - thresholds_[i]);
    convex_.sets[static_cast<size_t>(i)].parameter = thresholds_[i];
  }
}

void Haslinger::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  const bool frictional = std::any_of(problem.laws.begin(), problem.laws.end(),
                                      [](const Law& law) { return law.isCoulomb() && law.coefficient > 0.0; });
  r_ = result.solution.r;
  thresholds_.setZero(problem.W.blocks());
  makeCylinderProblem(problem, context.metric.step_lengths, thresholds_, convex_);
  updateThresholds(problem, 1.0);
  projectOntoSets(convex_, r_);
  problem.W.apply(r_, u_);
  u_ += problem.q;
  OuterLoop loop(context, result, options_.stall_window);
  double value = context.residual(problem, u_, r_);
  if (loop.record(value, r_))
    return;
  ConvexBudget budget;
  budget.interrupted = [&context] { return context.spend(1.0); };  // a product an inner iteration
  while (!loop.outOfBudget("outer iterations exhausted"))
  {
    budget.tolerance = loop.innerTolerance(options_.inner_accuracy, frictional) * context.smallestScale();
    inner_->solve(convex_, budget, r_, u_);
    ++result.iterations;
    const double before = value;
    value = context.residual(problem, u_, r_);
    if (loop.record(value, r_))
      return;
    if (value > options_.slowest * before)
    {
      loop.stop(SolverStatus::STAGNATED, "the residual falls too slowly");
      return;
    }
    updateThresholds(problem, options_.relaxation);
  }
}

}  // namespace frictional_contact_sim
