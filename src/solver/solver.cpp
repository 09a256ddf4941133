#include "frictional_contact_sim/solver/solver.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "island_workspace.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// Attempts to get the global residual below the tolerance when the local one was and its own was not.
constexpr int REFINEMENTS = 3;

/** A bound on max_i |e_i| at r = 0, u = q [m/s]; the projections involved do not lengthen. */
double restingError(const DelassusProblem& problem)
{
  double worst = 0.0;
  int row = 0;
  for (const Law& law : problem.laws)
  {
    const double velocity = problem.q[row];
    const bool one_sided = law.isCoulomb() || law.type == LawType::UNILATERAL;
    worst = std::max(worst, one_sided ? -velocity : std::abs(velocity));
    row += law.dimension();
  }
  return worst;
}

void checkGuess(const Solution& guess, int rows)
{
  if (guess.r.size() != rows)
    throw std::invalid_argument("guess.r has " + std::to_string(guess.r.size()) + " entries, expected " +
                                std::to_string(rows));
  if (!guess.r.allFinite())
    throw std::invalid_argument("guess.r has an entry that is not finite");
}

void clear(SolverResult& result)
{
  result.status = SolverStatus::NOT_RUN;
  result.iterations = 0;
  result.residual = 0.0;
  result.seconds = 0.0;
  result.work = 0.0;
  result.free_energy = 0.0;
  result.solver.clear();
  result.tried.clear();
  result.message.clear();
  result.history.clear();
}
}  // namespace

const char* toString(SolverStatus status)
{
  switch (status)
  {
    case SolverStatus::NOT_RUN:
      return "NOT_RUN";
    case SolverStatus::CONVERGED:
      return "CONVERGED";
    case SolverStatus::MAX_ITERATIONS:
      return "MAX_ITERATIONS";
    case SolverStatus::TIME_LIMIT:
      return "TIME_LIMIT";
    case SolverStatus::STAGNATED:
      return "STAGNATED";
    case SolverStatus::NUMERICAL_FAILURE:
      return "NUMERICAL_FAILURE";
    case SolverStatus::STOPPED_BY_USER:
      return "STOPPED_BY_USER";
  }
  return "UNKNOWN";
}

void StoppingOptions::validate() const
{
  requireOption(tolerance > 0.0 && std::isfinite(tolerance), "tolerance", tolerance, "a finite number > 0");
  requireOption(max_iterations >= 0, "max_iterations", max_iterations, ">= 0");
  requireOption(work_per_iteration > 0.0, "work_per_iteration", work_per_iteration, "> 0");
  requireOption(time_limit >= 0.0, "time_limit", time_limit, ">= 0");
}

Solver::Solver(std::string name)
  : name_(std::move(name))
  , reduction_(std::make_unique<DelassusReduction>())
  , islands_(std::make_unique<IslandWorkspace>())
{
}

Solver::~Solver() = default;

void Solver::setStopping(const StoppingOptions& stopping)
{
  stopping.validate();
  stopping_ = stopping;
}

void Solver::delegate(Solver& method, const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  method.doSolve(problem, context, result);
}

bool Solver::start(int, const DelassusProblem&, Eigen::VectorXd&, Eigen::VectorXd&)
{
  return false;
}

/** What a solve starts from; the clock runs. */
SolveContext Solver::begin(SolverResult& result)
{
  SolveContext context{step_lengths_};
  context.start = std::chrono::steady_clock::now();
  context.deadline = stopping_.time_limit;
  context.tolerance = stopping_.tolerance;
  context.max_iterations = stopping_.max_iterations;
  work_.spent = 0.0;
  work_.limit = stopping_.work_per_iteration * std::max(stopping_.max_iterations, 1);
  context.work = &work_;
  context.stop = stopping_.stop;
  if (stopping_.record_history)
    context.history = &result.history;
  return context;
}

Solver::Verdict Solver::measure(const DelassusProblem& problem, const SolveContext& context, const Solution& solution)
{
  const LawErrors errors =
      measureLaws(problem.laws, context.step_lengths, context.free_velocity, solution.u, solution.r);
  return {errors.residual(), errors.residual(SolveContext::IMPULSE_CAP)};
}

/** Cold starts that already solve the problem; the verdict on the last one tells whether it does. */
Solver::Verdict Solver::solveAtOnce(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  Solution& solution = result.solution;
  solution.r.setZero(problem.W.rows());
  // Without impulses e_i depends on q alone: a scene where everything parts costs no product with W.
  const double at_rest = restingError(problem) / std::max(context.free_velocity, VELOCITY_FLOOR);
  if (at_rest <= context.tolerance)
  {
    solution.u = problem.q;
    return {at_rest, at_rest};
  }
  if (!start(0, problem, solution.r, solution.u))
    solution.u = problem.q;
  Verdict verdict = measure(problem, context, solution);
  for (int attempt = 1; !verdict.within(context.tolerance) && start(attempt, problem, solution.r, solution.u);
       ++attempt)
    verdict = measure(problem, context, solution);
  return verdict;
}

Solver::Verdict Solver::solveLocal(const DelassusProblem& problem, const Solution* guess, SolveContext& context,
                                   SolverResult& result)
{
  computeStepLengths(problem, step_lengths_);
  context.free_velocity = maxAbs(problem.q);
  context.cold_start = guess == nullptr;
  context.iterations_before = context.notedIterations();
  // Without rows there is nothing to do, guess or not.
  if (guess == nullptr || problem.W.rows() == 0)
  {
    const Verdict verdict = solveAtOnce(problem, context, result);
    if (verdict.within(context.tolerance))
      return verdict;
    result.residual = verdict.criterion;
  }
  else
  {
    result.solution.r = guess->r;
    result.residual = UNKNOWN_RESIDUAL;
  }
  if (stopping_.split_islands && islands_->islands.find(problem.W) > 1)
    solveIslands(problem, context, result);
  else
    try
    {
      doSolve(problem, context, result);
    }
    catch (const std::bad_alloc&)
    {
      reportNoMemory(problem, result);
    }
  if (!result.solution.r.allFinite())
  {
    result.solution.r.setZero();
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.message = "an impulse is not finite";
  }
  problem.W.apply(result.solution.r, result.solution.u);
  result.solution.u += problem.q;
  return measure(problem, context, result.solution);
}

void Solver::checkOperator(bool global) const
{
  if (stopping_.operator_kind != OperatorKind::MATRIX_FREE)
    return;
  if (operatorUse() != OperatorUse::PRODUCTS)
    throw std::invalid_argument("operator matrix_free: " + name_ + " uses W as '" + toString(operatorUse()) +
                                "', expected a method that uses 'products'");
  if (!global)
    throw std::invalid_argument(
        "operator matrix_free: a local problem is given by W, expected automatic, dense or "
        "sparse");
}

void Solver::judge(const Verdict& verdict, const SolveContext& context, SolverResult& result) const
{
  const double tolerance = stopping_.tolerance;
  result.residual = verdict.residual;
  if (result.solver.empty())
    result.solver = name_;
  if (result.tried.empty())
    result.tried.push_back(name_);
  if (verdict.within(tolerance))
  {
    result.status = SolverStatus::CONVERGED;
    result.message.clear();
  }
  else if (verdict.residual <= tolerance)
  {
    if (result.status == SolverStatus::CONVERGED || result.status == SolverStatus::NOT_RUN)
      result.status = SolverStatus::STAGNATED;
    result.message = "impulses run away: there may be no solution";
  }
  else if (result.status == SolverStatus::CONVERGED || result.status == SolverStatus::NOT_RUN)
  {
    result.status = SolverStatus::STAGNATED;
    result.message = "the method reported convergence, the residual does not confirm it";
  }
  if (result.status == SolverStatus::CONVERGED)
    return;
  if (context.stopped())
  {
    result.status = SolverStatus::STOPPED_BY_USER;
    result.message = "stopped from outside";
  }
  else if (result.status == SolverStatus::TIME_LIMIT && result.work > work_.limit)
  {
    result.status = SolverStatus::MAX_ITERATIONS;
    result.message = "work exhausted: more than " + std::to_string(static_cast<long>(work_.limit)) +
                     " products with W, inner iterations and factorizations counted";
  }
}

/** The answer as it is reported, its u given. */
void Solver::finish(const std::vector<Law>& laws, const SolveContext& context, const Verdict& verdict,
                    SolverResult& result)
{
  result.work = std::max(result.work, work_.spent);
  judge(verdict, context, result);
  measureLaws(laws, context.step_lengths, context.free_velocity, result.solution.u, result.solution.r,
              &result.law_errors);
  result.seconds = context.seconds();
  if (context.history != nullptr)
    result.history.push_back({std::max(result.iterations, context.notedIterations()), result.seconds, result.residual});
}

void Solver::solve(const DelassusProblem& problem, const Solution* guess, SolverResult& result)
{
  SolveContext context = begin(result);
  validate(problem);
  if (guess != nullptr)
    checkGuess(*guess, problem.W.rows());
  clear(result);
  result.solution.v.resize(0);
  result.solution.lambda.resize(0);
  checkOperator(false);
  const DelassusProblem* used = &problem;
  const bool dense = stopping_.operator_kind == OperatorKind::DENSE;
  if (stopping_.operator_kind != OperatorKind::AUTOMATIC && problem.W.isDense() != dense)
  {
    converted_.laws = problem.laws;
    converted_.q = problem.q;
    converted_.W.assign(problem.W.toSparse(), problem.laws, stopping_.operator_kind);
    used = &converted_;
  }
  const Verdict verdict = solveLocal(*used, guess, context, result);
  finish(problem.laws, context, verdict, result);
}

void Solver::solve(const IncrementalProblem& problem, const Solution* guess, SolverResult& result)
{
  SolveContext context = begin(result);
  validate(problem);
  if (guess != nullptr)
    checkGuess(*guess, problem.rows());
  clear(result);
  checkOperator(true);
  reduction_->compute(problem, stopping_.operator_kind);
  const DelassusProblem& local = reduction_->problem();
  result.free_energy = reduction_->freeEnergy();
  global_.step_lengths = reduction_->stepLengths();
  global_.free_velocity = reduction_->freeVelocity();
  global_.mass_inverse_force = reduction_->massInverseForce();

  const double tolerance = stopping_.tolerance;
  Verdict verdict = solveLocal(local, guess, context, result);
  reduction_->recover(problem, result.solution);
  GlobalResidual value = globalResidual(problem, global_, result.solution);
  // The global form measures with the unconstrained W_ii and with u from v: ask for a little more when that matters.
  for (int k = 0; k < REFINEMENTS && verdict.residual <= context.tolerance && value.law > tolerance; ++k)
  {
    context.tolerance *= std::max(0.3 * tolerance / value.law, 0.01);
    warm_.r = result.solution.r;
    const int iterations = result.iterations;
    result.iterations = 0;
    result.tried.clear();
    result.solver.clear();
    verdict = solveLocal(local, &warm_, context, result);
    result.iterations += iterations;
    reduction_->recover(problem, result.solution);
    value = globalResidual(problem, global_, result.solution);
  }
  verdict.residual = value.value();
  finish(problem.laws, context, verdict, result);
}

SolverResult Solver::solve(const DelassusProblem& problem, const Solution* guess)
{
  SolverResult result;
  solve(problem, guess, result);
  return result;
}

SolverResult Solver::solve(const IncrementalProblem& problem, const Solution* guess)
{
  SolverResult result;
  solve(problem, guess, result);
  return result;
}

}  // namespace frictional_contact_sim
