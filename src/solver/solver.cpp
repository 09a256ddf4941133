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

/** A bound on E at r = 0, u = q; the projections involved do not lengthen. */
double restingResidual(const DelassusProblem& problem, const ResidualMetric& metric)
{
  double worst = 0.0;
  int row = 0;
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    const Law& law = problem.laws[i];
    const double velocity = problem.q[row];
    const double error = law.isOneSided() ? -velocity : std::abs(velocity);
    const auto index = static_cast<Eigen::Index>(i);
    if (error > metric.round_off[index])
      worst = std::max(worst, error / metric.scales[index]);
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
  SolveContext context{metric_};
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

double Solver::solveAtOnce(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  Solution& solution = result.solution;
  solution.r.setZero(problem.W.rows());
  // Without impulses e_i depends on q alone: a scene where everything parts costs no product with W.
  double residual = restingResidual(problem, context.metric);
  if (residual <= context.tolerance)
  {
    solution.u = problem.q;
    return residual;
  }
  if (!start(0, problem, solution.r, solution.u))
    solution.u = problem.q;
  residual = context.residual(problem, solution.u, solution.r);
  for (int attempt = 1; !(residual <= context.tolerance) && start(attempt, problem, solution.r, solution.u); ++attempt)
    residual = context.residual(problem, solution.u, solution.r);
  return residual;
}

/** Islands and metric are set. Returns E of the answer. */
double Solver::solveLocal(const DelassusProblem& problem, const Solution* guess, SolveContext& context,
                          SolverResult& result)
{
  context.cold_start = guess == nullptr;
  context.iterations_before = context.notedIterations();
  // Without rows there is nothing to do, guess or not.
  if (guess == nullptr || problem.W.rows() == 0)
  {
    const double residual = solveAtOnce(problem, context, result);
    if (residual <= context.tolerance)
      return residual;
    result.residual = residual;
  }
  else
  {
    result.solution.r = guess->r;
    result.residual = UNKNOWN_RESIDUAL;
  }
  if (stopping_.split_islands && islands_->islands.count() > 1)
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
  return context.residual(problem, result.solution.u, result.solution.r);
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

void Solver::judge(double residual, const SolveContext& context, SolverResult& result) const
{
  result.residual = residual;
  if (result.solver.empty())
    result.solver = name_;
  if (result.tried.empty())
    result.tried.push_back(name_);
  if (residual <= stopping_.tolerance)
  {
    result.status = SolverStatus::CONVERGED;
    result.message.clear();
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
void Solver::finish(const std::vector<Law>& laws, const SolveContext& context, double residual, SolverResult& result)
{
  result.work = std::max(result.work, work_.spent);
  judge(residual, context, result);
  lawResidual(laws, context.metric, result.solution.u, result.solution.r, &result.law_errors);
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
  computeStepLengths(*used, metric_.step_lengths);
  islands_->islands.find(used->W);
  metric_.setScales(problem.laws, problem.scales, problem.q, islands_->islands);
  const double residual = solveLocal(*used, guess, context, result);
  finish(problem.laws, context, residual, result);
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
  islands_->islands.find(local.W);
  setMetric(problem, *reduction_, islands_->islands, global_);
  metric_ = global_.metric;
  if (problem.bilaterals() > 0)
    computeStepLengths(local, metric_.step_lengths);

  const double tolerance = stopping_.tolerance;
  double residual = solveLocal(local, guess, context, result);
  reduction_->recover(problem, result.solution);
  GlobalResidual value = globalResidual(problem, global_, result.solution);
  // The global form measures with the unconstrained W_ii and with u from v: ask for a little more when that matters.
  for (int k = 0; k < REFINEMENTS && residual <= context.tolerance && value.law > tolerance; ++k)
  {
    context.tolerance *= std::max(0.3 * tolerance / value.law, 0.01);
    warm_.r = result.solution.r;
    const int iterations = result.iterations;
    result.iterations = 0;
    result.tried.clear();
    result.solver.clear();
    residual = solveLocal(local, &warm_, context, result);
    result.iterations += iterations;
    reduction_->recover(problem, result.solution);
    value = globalResidual(problem, global_, result.solution);
  }
  finish(problem.laws, context, value.value(), result);
}

void Solver::judgeAgain(const IncrementalProblem& problem, SolverResult& result)
{
  result.residual = globalResidual(problem, global_, result.solution).value();
  lawResidual(problem.laws, metric_, result.solution.u, result.solution.r, &result.law_errors);
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
