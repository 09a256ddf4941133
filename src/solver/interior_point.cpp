#include "frictional_contact_sim/solver/interior_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/solver/convex/slip_map.h"
#include "frictional_contact_sim/solver/outer_loop.h"

namespace frictional_contact_sim
{
namespace
{
/// A step this short no longer moves anything.
constexpr double SHORTEST_STEP = 1e-10;
}  // namespace

const OptionTable<InteriorPointOptions>& InteriorPointOptions::table()
{
  static const OptionTable<InteriorPointOptions> table =
      OptionTable<InteriorPointOptions>(
          "interior_point",
          {
              {"slip_centring", &InteriorPointOptions::slip_centring, inside(0.0, 1.0), "-",
               "lower bound of sigma m relative to rho e^2"},
              {"warm_shift", &InteriorPointOptions::warm_shift, notNegative(), "-",
               "distance of a warm start from the boundary relative to its error, 0 = always cold"},
              {"stall_window", &InteriorPointOptions::stall_window, atLeast(2), "iterations",
               "without the residual falling by a tenth before a restart"},
              {"restarts", &InteriorPointOptions::restarts, atLeast(0), "restarts", "before giving up"},
          })
          .include(&InteriorPointOptions::step, PrimalDualOptions::table());
  return table;
}

void InteriorPointOptions::validate() const
{
  table().validate(*this);
}

InteriorPoint::InteriorPoint(const InteriorPointOptions& options)
  : Solver("interior_point"), options_(options), iteration_(options.step)
{
  options_.validate();
}

void InteriorPoint::updateSlip(const DelassusProblem& problem)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    if (!law.isCoulomb() || law.coefficient == 0.0)
      continue;
    const int row = problem.W.offset(i);
    convex_.c[row] = problem.q[row] + law.coefficient * u_.segment(row + 1, law.dimension() - 1).norm();
  }
}

bool InteriorPoint::run(const DelassusProblem& problem, const SolveContext& context, double shift, double slip_centring,
                        OuterLoop& loop, SolverResult& result)
{
  const double mean_step = std::exp(context.metric.step_lengths.array().log().mean());
  problem.W.apply(guess_, u_);
  u_ += problem.q;
  updateSlip(problem);
  u_ += convex_.c - problem.q;
  iteration_.start(convex_, guess_, u_, shift);
  double centring = 0.0;
  const double work = SolveContext::factorization(problem, problem.W.rows());
  while (!loop.outOfBudget("iterations exhausted", work))
  {
    const double length = iteration_.step(convex_, centring);
    if (length < SHORTEST_STEP)
      return loop.stop(SolverStatus::STAGNATED, "the step length fell to zero");
    ++result.iterations;
    u_ = iteration_.u() - convex_.c + problem.q;
    const double value = context.residual(problem, u_, iteration_.r());
    if (loop.record(value, iteration_.r()))
      return true;
    if (frictional_)
    {
      const double error = value * context.smallestScale();
      centring = slip_centring * mean_step * error * error;
    }
    updateSlip(problem);
  }
  return true;
}

void InteriorPoint::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  makeConeProblem(problem, context.metric.step_lengths, convex_);
  frictional_ = std::any_of(problem.laws.begin(), problem.laws.end(),
                            [](const Law& law) { return law.isCoulomb() && law.coefficient > 0.0; });
  guess_ = result.solution.r;
  projectOntoSets(convex_, guess_);
  problem.W.apply(guess_, u_);
  u_ += problem.q;
  OuterLoop loop(context, result, options_.stall_window);
  const double first = context.residual(problem, u_, guess_);
  if (loop.record(first, guess_))
    return;
  double shift = std::numeric_limits<double>::infinity();
  if (options_.warm_shift > 0.0 && !guess_.isZero(0.0))
    shift = options_.warm_shift * first * context.smallestScale();
  double slip_centring = options_.slip_centring;
  for (int attempt = 0; attempt <= options_.restarts; ++attempt)
  {
    loop.restart();
    run(problem, context, shift, slip_centring, loop, result);
    if (result.status != SolverStatus::STAGNATED)
      return;
    shift = std::numeric_limits<double>::infinity();
    slip_centring *= 0.1;
    guess_.setZero();
  }
}

}  // namespace frictional_contact_sim
