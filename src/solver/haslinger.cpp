#include "frictional_contact_sim/solver/haslinger.h"

#include <algorithm>

#include "frictional_contact_sim/solver/convex/slip_map.h"
#include "frictional_contact_sim/solver/convex/spectral_gradient.h"
#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
void HaslingerOptions::validate() const
{
  requireOption(inner_accuracy > 0.0 && inner_accuracy < 1.0, "haslinger.inner_accuracy", inner_accuracy, "in (0, 1)");
  requireOption(relaxation > 0.0 && relaxation <= 1.0, "haslinger.relaxation", relaxation, "in (0, 1]");
  requireOption(slowest > 0.0, "haslinger.slowest", slowest, "> 0");
  requireOption(stall_window >= 2, "haslinger.stall_window", stall_window, ">= 2");
}

Haslinger::Haslinger(const HaslingerOptions& options, std::unique_ptr<ConvexSolver> inner)
  : Solver("haslinger")
  , options_(options)
  , inner_(inner != nullptr ? std::move(inner) : std::make_unique<SpectralGradient>())
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
  makeCylinderProblem(problem, context.step_lengths, thresholds_, convex_);
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
    budget.tolerance = loop.innerTolerance(options_.inner_accuracy, frictional) *
                       velocityScale(problem.q, u_, r_, context.step_lengths, problem.W);
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
