#include "frictional_contact_sim/solver/portfolio.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/convex/spectral_gradient.h"
#include "frictional_contact_sim/solver/ds_newton.h"
#include "frictional_contact_sim/solver/enumeration/enumerate.h"
#include "frictional_contact_sim/solver/fb_newton.h"
#include "frictional_contact_sim/solver/fb_newton_smoothed.h"
#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/haslinger.h"
#include "frictional_contact_sim/solver/interior_point.h"
#include "frictional_contact_sim/solver/swept_newton.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// Sweeps after which Gauss-Seidel must have halved the residual to go on.
constexpr int STALL_WINDOW = 20;
/// Budget of each of the other Newton methods on few rows: they take longer, where they have an answer at all.
constexpr int OTHER_NEWTON_STEPS = 70;
/// Above Newton's first proximal parameter, below its restart.
constexpr double WATCHDOG_MIN = 1e-5;
/// With a guess a problem is one of a series, as a rule. Newton on a small one then takes one more step unless it is
/// this far below the tolerance: that costs little, and a scene at rest stays within the tolerance for many steps
/// instead of drifting out of it at once.
constexpr double SERIES_MARGIN = 1e-4;

/// Haslinger's first turn ends with an outer iteration that leaves more than this share of the residual...
constexpr double HASLINGER_SLOWEST = 0.2;
/// ... or whose convex problem takes more steps than this.
constexpr int HASLINGER_INNER_STEPS = 100;
/// Impulses of the interior point are a self-stress where they are so many times those of every law alone.
constexpr double LARGEST_IMPULSES = 20.0;
/// It takes its turn where the budget is so many times its own: the others are to have theirs.
constexpr int INTERIOR_RESERVE = 4;
/// What a first turn reached is a better start for the others when it is below this share of the residual before it.
constexpr double WORTH_KEEPING = 1e-3;

/// Newton from the start of a problem: far from a solution a first failure should cost one step, not a whole excursion;
/// near one it is the other way round.
SemismoothNewtonOptions firstNewton(bool restarts)
{
  SemismoothNewtonOptions options;
  options.watchdog_min = WATCHDOG_MIN;
  options.restarts = restarts;
  return options;
}

std::unique_ptr<Haslinger> quickHaslinger()
{
  HaslingerOptions options;
  options.slowest = HASLINGER_SLOWEST;
  SpectralGradientOptions inner;
  inner.max_iterations = HASLINGER_INNER_STEPS;
  return std::make_unique<Haslinger>(options, std::make_unique<SpectralGradient>(inner));
}
}  // namespace

const OptionTable<PortfolioOptions>& PortfolioOptions::table()
{
  static const OptionTable<PortfolioOptions> table(
      "portfolio", {
                       {"newton_first_rows", &PortfolioOptions::newton_first_rows, atLeast(0), "rows",
                        "up to which Newton goes first"},
                       {"newton_first_steps", &PortfolioOptions::newton_first_steps, atLeast(1), "iterations",
                        "its budget in that place"},
                       {"interior_rows", &PortfolioOptions::interior_rows, atLeast(0), "rows",
                        "from which on the interior point is next where that has failed"},
                       {"interior_steps", &PortfolioOptions::interior_steps, atLeast(1), "iterations", "its budget"},
                       {"newton_try_rows", &PortfolioOptions::newton_try_rows, atLeast(0), "rows",
                        "up to which it goes first too, for newton_try_steps at most"},
                       {"newton_try_steps", &PortfolioOptions::newton_try_steps, atLeast(1), "iterations",
                        "and only as long as no step fails"},
                       {"haslinger_steps", &PortfolioOptions::haslinger_steps, atLeast(1), "iterations",
                        "of Haslinger's fixed point on more rows, as long as it is quick"},
                       {"newton_last_rows", &PortfolioOptions::newton_last_rows, atLeast(0), "rows",
                        "above which Newton alone takes too many factorizations, >= newton_first_rows"},
                       {"swept_first_rows", &PortfolioOptions::swept_first_rows, atLeast(0), "rows",
                        "from which on Newton with sweeps goes before Newton alone"},
                       {"swept_last_rows", &PortfolioOptions::swept_last_rows, atLeast(0), "rows",
                        "above which nothing is factored, >= swept_first_rows"},
                       {"swept_steps", &PortfolioOptions::swept_steps, atLeast(1), "iterations",
                        "budget of Newton with sweeps, doubled every round"},
                       {"first_sweeps", &PortfolioOptions::first_sweeps, atLeast(0), "sweeps",
                        "of Gauss-Seidel before Newton on larger problems"},
                       {"newton_steps", &PortfolioOptions::newton_steps, atLeast(1), "iterations",
                        "Newton's budget after sweeps, doubled every round"},
                       {"later_sweeps", &PortfolioOptions::later_sweeps, atLeast(1), "sweeps",
                        "of the later rounds, doubled every round"},
                       {"max_rounds", &PortfolioOptions::max_rounds, atLeast(0), "rounds", "of sweeps and Newton"},
                       {"enumerate_rows", &PortfolioOptions::enumerate_rows, atLeast(0), "rows",
                        "up to which the complete search ends it where all else has failed"},
                       {"enumerate_nodes", &PortfolioOptions::enumerate_nodes, atLeast(1), "nodes",
                        "its budget, beside that of iterations"},
                   });
  return table;
}

void PortfolioOptions::validate() const
{
  table().validate(*this);
  requireOption(newton_last_rows >= newton_first_rows, "portfolio.newton_last_rows", newton_last_rows,
                ">= newton_first_rows");
  requireOption(swept_last_rows >= swept_first_rows, "portfolio.swept_last_rows", swept_last_rows,
                ">= swept_first_rows");
}

Portfolio::Portfolio(const PortfolioOptions& options)
  : Solver("portfolio")
  , options_(options)
  , gauss_seidel_(std::make_unique<GaussSeidel>())
  , newton_(std::make_unique<AcNewton>())
  , first_newton_(std::make_unique<AcNewton>(firstNewton(true)))
  , newton_trial_(std::make_unique<AcNewton>(firstNewton(false)))
  , interior_point_(std::make_unique<InteriorPoint>())
  , haslinger_(quickHaslinger())
  , swept_newton_(std::make_unique<SweptNewton>())
  , enumerate_(std::make_unique<Enumerate>())
{
  options_.validate();
  GaussSeidelOptions sweeps;
  sweeps.stall_window = STALL_WINDOW;
  sweeps.conjugate = true;
  gauss_seidel_->setOptions(sweeps);
  other_newtons_.push_back(std::make_unique<FbNewton>());
  other_newtons_.push_back(std::make_unique<DsNewton>());
  FbNewtonSmoothedOptions quick;
  quick.least_squares = false;
  last_resort_.push_back(std::make_unique<FbNewtonSmoothed>(quick));
  last_resort_.push_back(std::make_unique<DsNewton>());
  last_resort_.push_back(std::make_unique<FbNewtonSmoothed>());
  without_factors_.push_back(std::make_unique<Haslinger>());
}

Portfolio::~Portfolio() = default;

void Portfolio::setOptions(const PortfolioOptions& options)
{
  options.validate();
  options_ = options;
  dropSiblings();
}

std::unique_ptr<Solver> Portfolio::sibling() const
{
  return std::make_unique<Portfolio>(options_);
}

double Portfolio::criterion(const DelassusProblem& problem, const SolveContext& context, const Eigen::VectorXd& r)
{
  problem.W.apply(r, velocity_);
  velocity_ += problem.q;
  return context.residual(problem, velocity_, r);
}

bool Portfolio::run(Solver& method, const DelassusProblem& problem, const SolveContext& context, int budget,
                    SolverResult& result, double margin)
{
  budget = std::min(budget, context.max_iterations - used_);
  if (budget <= 0)
    return false;
  result.tried.push_back(method.name());
  result.iterations = 0;
  SolveContext own = context;
  own.tolerance *= margin;
  own.max_iterations = budget;
  own.iterations_before += used_;
  delegate(method, problem, own, result);
  used_ += result.iterations;
  result.iterations = used_;
  const double value = result.residual >= 0.0 ? result.residual : criterion(problem, context, result.solution.r);
  if (value < best_value_)
  {
    best_value_ = value;
    best_r_ = result.solution.r;
    result.solver = method.name();
  }
  else
    result.solution.r = best_r_;
  result.residual = UNKNOWN_RESIDUAL;  // result.solution.u is not W r + q of this r
  return best_value_ <= context.tolerance;
}

/** Newton from the start, and in a series of problems a step more than asked for. */
bool Portfolio::tryNewton(AcNewton& newton, const DelassusProblem& problem, const SolveContext& context, int steps,
                          SolverResult& result)
{
  const bool done = run(newton, problem, context, steps, result);
  if (done && !context.cold_start && best_value_ > SERIES_MARGIN * context.tolerance)
    run(newton, problem, context, 1, result, SERIES_MARGIN);
  return done;
}

/** Newton without the guess, which may be what it failed on. */
bool Portfolio::tryWithoutGuess(Solver& newton, const DelassusProblem& problem, const SolveContext& context, int steps,
                                SolverResult& result)
{
  if (context.cold_start || context.max_iterations <= used_)
    return false;
  result.residual = solveAtOnce(problem, context, result);
  return run(newton, problem, context, steps, result);
}

/** Newton on another function, from where the first began: near the best iterate is where that one went in circles. */
bool Portfolio::tryOtherNewton(Solver& newton, const DelassusProblem& problem, const SolveContext& context,
                               SolverResult& result)
{
  result.solution.r = guess_r_;
  return run(newton, problem, context, OTHER_NEWTON_STEPS, result) ||
         tryWithoutGuess(newton, problem, context, OTHER_NEWTON_STEPS, result);
}

/** Haslinger's fixed point, given up when it is slow: then the others start as if it had not been. */
bool Portfolio::tryHaslinger(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  const double value = best_value_;
  first_r_ = result.solution.r;
  const bool done = run(*haslinger_, problem, context, options_.haslinger_steps, result);
  if (best_value_ > WORTH_KEEPING * value)
    result.solution.r = first_r_;
  return done;
}

/**
 * The interior point, its answer not taken where it is a self-stress above all: it ends in the middle of all answers,
 * and where impulses may grow without bound between wedged bodies it has some that are as large as it could make them.
 * Then, and where it has no answer, the others start as if it had not been; it is the last resort.
 */
bool Portfolio::tryInteriorPoint(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  if (problem.W.rows() < options_.interior_rows ||
      context.max_iterations - used_ < INTERIOR_RESERVE * options_.interior_steps)
    return false;
  const double value = best_value_;
  const std::string solver = result.solver;
  first_r_ = best_r_;
  if (run(*interior_point_, problem, context, options_.interior_steps, result))
  {
    solveApart(problem, apart_r_);
    if (best_r_.norm() <= LARGEST_IMPULSES * apart_r_.norm())
      return true;
    stressed_r_ = best_r_;
  }
  best_value_ = value;
  best_r_ = result.solution.r = first_r_;
  result.solver = solver;
  return false;
}

/**
 * The complete search, on few rows, where all else has failed: either it has an answer, or it says that there is none,
 * or why it does not know. Its nodes do not count as iterations: the others have used those up. Who allows fewer
 * iterations than it has nodes is in a hurry, and is not kept.
 */
bool Portfolio::tryEnumerate(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  if (problem.W.rows() > options_.enumerate_rows || context.max_iterations < options_.enumerate_nodes ||
      context.timeIsUp())
    return false;
  const int used = used_;
  SolveContext own = context;
  own.max_iterations = used + options_.enumerate_nodes;
  const bool done = run(*enumerate_, problem, own, options_.enumerate_nodes, result);
  used_ = result.iterations = std::min(used_, std::max(used, context.max_iterations));
  return done;
}

void Portfolio::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  used_ = 0;
  stressed_r_.resize(0);
  best_r_ = result.solution.r;
  if (!(result.residual >= 0.0))
  {
    result.residual = criterion(problem, context, best_r_);
    result.solution.u = velocity_;
  }
  best_value_ = result.residual;
  bool done = best_value_ <= context.tolerance;
  const bool newton_first = problem.W.rows() <= options_.newton_first_rows;
  const bool newton = problem.W.rows() <= options_.newton_last_rows;
  const bool swept = !newton_first && problem.W.rows() <= options_.swept_last_rows;
  if (newton_first)
  {
    if (!done)
      guess_r_ = best_r_;
    done = done || tryNewton(*first_newton_, problem, context, options_.newton_first_steps, result);
    done = done || tryWithoutGuess(*first_newton_, problem, context, options_.newton_first_steps, result);
    done = done || tryInteriorPoint(problem, context, result);
    for (const std::unique_ptr<Solver>& other : other_newtons_)
      done = done || tryOtherNewton(*other, problem, context, result);
  }
  else if (problem.W.rows() <= options_.newton_try_rows)
    done = done || tryNewton(*newton_trial_, problem, context, options_.newton_try_steps, result);
  if (!newton_first)
  {
    done = done || tryHaslinger(problem, context, result);
    done = done || run(*gauss_seidel_, problem, context, options_.first_sweeps, result);
    if (swept && problem.W.rows() >= options_.swept_first_rows)
      done = done || run(*swept_newton_, problem, context, options_.swept_steps, result);
    if (newton)
      done = done || run(*newton_, problem, context, options_.newton_steps, result);
  }
  for (int round = 0; !done && round < options_.max_rounds && used_ < context.max_iterations && !context.timeIsUp();
       ++round)
  {
    done = run(*gauss_seidel_, problem, context, options_.later_sweeps << round, result);
    if (newton)
      done = done || run(*newton_, problem, context, options_.newton_steps << round, result);
    if (swept && !newton)
      done = done || run(*swept_newton_, problem, context, options_.swept_steps << round, result);
    for (std::unique_ptr<Solver>& method : newton ? last_resort_ : without_factors_)
      done = done || run(*method, problem, context, options_.newton_steps << round, result);
    if (swept && newton)
      done = done || run(*swept_newton_, problem, context, options_.swept_steps << round, result);
  }
  if (!done && stressed_r_.size() > 0)
  {
    best_r_ = stressed_r_;
    result.solver = interior_point_->name();
    done = true;
  }
  const bool searched =
      !done && problem.W.rows() <= options_.enumerate_rows && context.max_iterations >= options_.enumerate_nodes;
  done = done || tryEnumerate(problem, context, result);
  result.solution.r = best_r_;
  if (done)
  {
    result.status = SolverStatus::CONVERGED;
    return;
  }
  result.status = context.timeIsUp()                ? SolverStatus::TIME_LIMIT
                  : used_ >= context.max_iterations ? SolverStatus::MAX_ITERATIONS
                                                    : SolverStatus::STAGNATED;
  const std::string why = searched && !result.message.empty() ? "; enumerate: " + result.message : "";
  result.message = "no method of the portfolio reached the tolerance" + why;
}

}  // namespace frictional_contact_sim
