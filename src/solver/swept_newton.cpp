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
constexpr double STEP_LENGTHS[] = {1.0, 0.3, 0.1, 0.03};
constexpr double ALPHA_DECREASE = 0.3;
constexpr double ALPHA_INCREASE = 5.0;
constexpr double ALPHA_MIN = 1e-12;
/// Another value than last time, when all between it and the largest have failed.
constexpr double RESTART_DECREASE = 0.1;

GaussSeidelOptions conjugateSweeps(int count)
{
  GaussSeidelOptions options;
  options.conjugate = true;
  options.check_interval = count;
  return options;
}
}  // namespace

void SweptNewtonOptions::validate() const
{
  requireOption(sweeps >= 1, "swept_newton.sweeps", sweeps, ">= 1");
  requireOption(proximal_start > 0.0, "swept_newton.proximal_start", proximal_start, "> 0");
  requireOption(proximal_max >= proximal_start, "swept_newton.proximal_max", proximal_max, ">= proximal_start");
  requireOption(proximal_restart > 0.0, "swept_newton.proximal_restart", proximal_restart, "> 0");
  requireOption(sufficient > 0.0 && sufficient < 1.0, "swept_newton.sufficient", sufficient, "in (0, 1)");
  requireOption(worst >= 1.0, "swept_newton.worst", worst, ">= 1");
}

SweptNewton::SweptNewton(const SweptNewtonOptions& options)
  : SemismoothNewton("ac_newton+gauss_seidel", alartCurnierMap(RadiusRule::AUGMENTED))
  , options_(options)
  , gauss_seidel_(conjugateSweeps(options.sweeps))
{
  options_.validate();
}

std::unique_ptr<Solver> SweptNewton::sibling() const
{
  return std::make_unique<SweptNewton>(options_);
}

/** Sweeps from r + t step_. @return E where they end, swept_.solution.r */
double SweptNewton::trial(const DelassusProblem& problem, const Eigen::VectorXd& r, double t)
{
  swept_.solution.r = r + t * step_;
  for (int i = 0; i < problem.W.blocks(); ++i)
    projectImpulse(problem.laws[static_cast<std::size_t>(i)], &swept_.solution.r[problem.W.offset(i)]);
  delegate(gauss_seidel_, problem, stopping().tolerance, options_.sweeps, swept_);
  return swept_.residual;
}

/** The first sufficient trial, or the best one, in found_. @return its E */
double SweptNewton::search(const DelassusProblem& problem, const Eigen::VectorXd& r, double value, double& length)
{
  double best = std::numeric_limits<double>::infinity();
  for (const double t : STEP_LENGTHS)
  {
    const double tried = trial(problem, r, t);
    if (tried < best)
    {
      best = tried;
      length = t;
      found_.swap(swept_.solution.r);
    }
    if (best <= options_.sufficient * value || timeIsUp())
      break;
  }
  return best;
}

void SweptNewton::adaptAlpha(bool sufficient, bool full)
{
  if (!sufficient)
    alpha_ *= ALPHA_INCREASE;
  else if (full)
    alpha_ = std::max(ALPHA_DECREASE * alpha_, ALPHA_MIN);
  if (alpha_ <= options_.proximal_max)
    return;
  alpha_ = restart_;
  restart_ = std::max(RESTART_DECREASE * restart_, ALPHA_MIN);
}

void SweptNewton::doSolve(const DelassusProblem& problem, SolverResult& result)
{
  prepare(problem);
  Eigen::VectorXd& r = result.solution.r;
  problem.W.apply(r, u_);
  u_ += problem.q;
  double value = residual(problem, u_, r);
  double best = value;
  best_r_ = r;
  alpha_ = options_.proximal_start;
  restart_ = options_.proximal_restart;
  while (best > stopping().tolerance && result.iterations < stopping().max_iterations && !timeIsUp())
  {
    ++result.iterations;
    evaluate(problem, u_, r, true);
    double length = 0.0;
    const double found = direction(problem) ? search(problem, r, value, length)  //
                                            : std::numeric_limits<double>::infinity();
    adaptAlpha(found <= options_.sufficient * value, length == 1.0);
    if (!(found <= options_.worst * value))
      continue;
    value = found;
    r.swap(found_);
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
  result.status = best <= stopping().tolerance ? SolverStatus::CONVERGED
                  : timeIsUp()                 ? SolverStatus::TIME_LIMIT
                                               : SolverStatus::MAX_ITERATIONS;
  result.message = best <= stopping().tolerance ? ""
                   : timeIsUp()                 ? "time limit reached"
                                                : "Newton iterations exhausted";
}

}  // namespace frictional_contact_sim
