#include "frictional_contact_sim/solver/swept_newton.h"

#include <algorithm>
#include <limits>

#include "frictional_contact_sim/problem/law_functions.h"
#include "frictional_contact_sim/solver/ac_newton.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// The first m is the number of laws by this.
constexpr int LAWS_A_SWEEP = 10;
constexpr double ALPHA_DECREASE = 0.3;
constexpr double ALPHA_INCREASE = 5.0;
constexpr double SWEEPS_DECREASE = 0.7;
constexpr double SWEEPS_INCREASE = 1.5;
constexpr double ALPHA_MIN = 1e-12;
/// Another value than last time, when all between it and the largest have failed.
constexpr double RESTART_DECREASE = 0.1;

GaussSeidelOptions conjugateSweeps(int count)
{
  GaussSeidelOptions options;
  options.conjugate = true;
  options.check_interval = count;  // E only where they end
  return options;
}
}  // namespace

void SweptNewtonOptions::validate() const
{
  requireOption(sweeps >= 1, "swept_newton.sweeps", sweeps, ">= 1");
  requireOption(many_sweeps >= sweeps, "swept_newton.many_sweeps", many_sweeps, ">= sweeps");
  requireOption(max_sweeps >= many_sweeps, "swept_newton.max_sweeps", max_sweeps, ">= many_sweeps");
  requireOption(proximal_start > 0.0, "swept_newton.proximal_start", proximal_start, "> 0");
  requireOption(proximal_max >= proximal_start, "swept_newton.proximal_max", proximal_max, ">= proximal_start");
  requireOption(proximal_restart > 0.0, "swept_newton.proximal_restart", proximal_restart, "> 0");
  requireOption(sufficient > 0.0 && sufficient < 1.0, "swept_newton.sufficient", sufficient, "in (0, 1)");
  requireOption(worst >= 1.0, "swept_newton.worst", worst, ">= 1");
}

SweptNewton::SweptNewton(const SweptNewtonOptions& options)
  : SemismoothNewton("ac_newton+gauss_seidel", alartCurnierMap(RadiusRule::AUGMENTED))
  , options_(options)
  , gauss_seidel_(conjugateSweeps(options.max_sweeps))
{
  options_.validate();
}

std::unique_ptr<Solver> SweptNewton::sibling() const
{
  return std::make_unique<SweptNewton>(options_);
}

/** Sweeps from r + step_. @return E where they end, swept_.solution.r */
double SweptNewton::sweptStep(const DelassusProblem& problem, const SolveContext& context, const Eigen::VectorXd& r)
{
  swept_.solution.r = r + step_;
  for (int i = 0; i < problem.W.blocks(); ++i)
    projectImpulse(problem.laws[static_cast<size_t>(i)], &swept_.solution.r[problem.W.offset(i)]);
  swept_.residual = UNKNOWN_RESIDUAL;
  SolveContext sweeps = context;
  sweeps.max_iterations = static_cast<int>(sweeps_);
  sweeps.history = nullptr;  // sweeps are no iterations of this method
  delegate(gauss_seidel_, problem, sweeps, swept_);
  return swept_.residual;
}

void SweptNewton::adapt(bool sufficient)
{
  if (sufficient)
  {
    alpha_ = std::max(ALPHA_DECREASE * alpha_, ALPHA_MIN);
    sweeps_ = std::max<double>(SWEEPS_DECREASE * sweeps_, first_sweeps_);
    return;
  }
  alpha_ *= ALPHA_INCREASE;
  sweeps_ = std::min<double>(SWEEPS_INCREASE * sweeps_, options_.max_sweeps);
  if (alpha_ <= options_.proximal_max)
    return;
  alpha_ = restart_;
  restart_ = std::max(RESTART_DECREASE * restart_, ALPHA_MIN);
}

void SweptNewton::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  prepare(problem, context);
  rho_normal_ = rho_tangential_ = context.step_lengths;
  Eigen::VectorXd& r = result.solution.r;
  problem.W.apply(r, u_);
  u_ += problem.q;
  double value = context.residual(problem, u_, r);
  context.note(0, value);
  double best = value;
  best_r_ = r;
  alpha_ = options_.proximal_start;
  restart_ = options_.proximal_restart;
  sweeps_ = first_sweeps_ = std::clamp(problem.W.blocks() / LAWS_A_SWEEP, options_.sweeps, options_.many_sweeps);
  while (best > context.tolerance && result.iterations < context.max_iterations && !context.timeIsUp())
  {
    ++result.iterations;
    evaluate(problem, u_, r, true);
    const bool regular = direction(problem);
    context.spend(stepWork(problem));
    const double found = regular ? sweptStep(problem, context, r) : std::numeric_limits<double>::infinity();
    adapt(found <= options_.sufficient * value);
    if (!(found <= options_.worst * value))
      continue;
    value = found;
    context.note(result.iterations, value);
    r.swap(swept_.solution.r);
    problem.W.apply(r, u_);
    u_ += problem.q;
    if (value < best)
    {
      best = value;
      best_r_ = r;
    }
  }
  r = best_r_;
  result.residual = best;
  result.status = best <= context.tolerance ? SolverStatus::CONVERGED
                  : context.timeIsUp()      ? SolverStatus::TIME_LIMIT
                                            : SolverStatus::MAX_ITERATIONS;
  result.message = best <= context.tolerance ? ""
                   : context.timeIsUp()      ? "time limit reached"
                                             : "Newton iterations exhausted";
}

}  // namespace frictional_contact_sim
