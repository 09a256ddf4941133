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
/// As in problem/residual.h [m/s].
constexpr double VELOCITY_FLOOR = 1e-12;
/// Attempts to get the global residual below the tolerance when the local one was and its own was not.
constexpr int REFINEMENTS = 3;

double maxAbs(const Eigen::VectorXd& x)
{
  return x.size() == 0 ? 0.0 : x.lpNorm<Eigen::Infinity>();
}

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

/// Puts a value back when the scope is left, by an exception too.
struct RestoreOnExit
{
  double& place;
  const double value;
  ~RestoreOnExit() { place = value; }
};

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
  result.solver.clear();
  result.tried.clear();
  result.message.clear();
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

double Solver::secondsSinceStart() const
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

bool Solver::timeIsUp() const
{
  return deadline_ > 0.0 && secondsSinceStart() > deadline_;
}

double Solver::residual(const DelassusProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r) const
{
  return lawResidual(problem.laws, step_lengths_, free_velocity_, u, r, nullptr, 0.0, IMPULSE_CAP);
}

void Solver::delegate(Solver& method, const DelassusProblem& problem, double tolerance, int max_iterations,
                      SolverResult& result) const
{
  method.stopping_ = stopping_;
  method.stopping_.tolerance = tolerance;
  method.stopping_.max_iterations = max_iterations;
  method.start_ = start_;
  method.deadline_ = deadline_;
  method.cold_start_ = cold_start_;
  method.step_lengths_ = step_lengths_;
  method.free_velocity_ = free_velocity_;
  method.doSolve(problem, result);
}

bool Solver::start(int, const DelassusProblem&, Eigen::VectorXd&, Eigen::VectorXd&)
{
  return false;
}

/** E at (u, r) and the stopping criterion there. */
double Solver::measure(const DelassusProblem& problem, const Solution& solution)
{
  const LawErrors errors = measureLaws(problem.laws, step_lengths_, free_velocity_, solution.u, solution.r);
  criterion_ = errors.residual(IMPULSE_CAP);
  return errors.residual();
}

/** Cold starts that already solve the problem. @return E there; larger than the tolerance when they do not. */
double Solver::solveAtOnce(const DelassusProblem& problem, SolverResult& result)
{
  Solution& solution = result.solution;
  solution.r.setZero(problem.W.rows());
  // Without impulses e_i depends on q alone: a scene where everything parts costs no product with W.
  criterion_ = restingError(problem) / std::max(free_velocity_, VELOCITY_FLOOR);
  if (criterion_ <= stopping_.tolerance)
  {
    solution.u = problem.q;
    return criterion_;
  }
  if (!start(0, problem, solution.r, solution.u))
    solution.u = problem.q;
  double value = measure(problem, solution);
  for (int attempt = 1; !(value <= stopping_.tolerance && criterion_ <= stopping_.tolerance) &&
                        start(attempt, problem, solution.r, solution.u);
       ++attempt)
    value = measure(problem, solution);
  return value;
}

double Solver::solveLocal(const DelassusProblem& problem, const Solution* guess, SolverResult& result)
{
  computeStepLengths(problem, step_lengths_);
  free_velocity_ = maxAbs(problem.q);
  deadline_ = stopping_.time_limit;
  // Without rows there is nothing to do, guess or not.
  if (guess == nullptr || problem.W.rows() == 0)
  {
    const double value = solveAtOnce(problem, result);
    if (value <= stopping_.tolerance && criterion_ <= stopping_.tolerance)
      return value;
    result.residual = criterion_;
  }
  else
  {
    result.solution.r = guess->r;
    result.residual = UNKNOWN_RESIDUAL;
  }
  cold_start_ = guess == nullptr;
  if (stopping_.split_islands && islands_->islands.find(problem.W) > 1)
    solveIslands(problem, result);
  else
    try
    {
      doSolve(problem, result);
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
  return measure(problem, result.solution);
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

void Solver::judge(double residual, double tolerance, SolverResult& result) const
{
  result.residual = residual;
  if (result.solver.empty())
    result.solver = name_;
  if (result.tried.empty())
    result.tried.push_back(name_);
  if (residual <= tolerance && criterion_ <= tolerance)
  {
    result.status = SolverStatus::CONVERGED;
    result.message.clear();
  }
  else if (residual <= tolerance)
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
  result.seconds = secondsSinceStart();
}

void Solver::solve(const DelassusProblem& problem, const Solution* guess, SolverResult& result)
{
  start_ = std::chrono::steady_clock::now();
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
  const double value = solveLocal(*used, guess, result);
  judge(value, stopping_.tolerance, result);
}

void Solver::solve(const IncrementalProblem& problem, const Solution* guess, SolverResult& result)
{
  start_ = std::chrono::steady_clock::now();
  validate(problem);
  if (guess != nullptr)
    checkGuess(*guess, problem.rows());
  clear(result);
  checkOperator(true);
  reduction_->compute(problem, stopping_.operator_kind);
  const DelassusProblem& local = reduction_->problem();
  global_.step_lengths = reduction_->stepLengths();
  global_.free_velocity = reduction_->freeVelocity();
  global_.mass_inverse_force = reduction_->massInverseForce();

  const double tolerance = stopping_.tolerance;
  const RestoreOnExit restore{stopping_.tolerance, tolerance};
  double local_value = solveLocal(local, guess, result);
  reduction_->recover(problem, result.solution);
  GlobalResidual value = globalResidual(problem, global_, result.solution);
  // The global form measures with the unconstrained W_ii and with u from v: ask for a little more when that matters.
  for (int k = 0; k < REFINEMENTS && local_value <= stopping_.tolerance && value.law > tolerance; ++k)
  {
    stopping_.tolerance *= std::max(0.3 * tolerance / value.law, 0.01);
    warm_.r = result.solution.r;
    const int iterations = result.iterations;
    result.iterations = 0;
    result.tried.clear();
    result.solver.clear();
    local_value = solveLocal(local, &warm_, result);
    result.iterations += iterations;
    reduction_->recover(problem, result.solution);
    value = globalResidual(problem, global_, result.solution);
  }
  judge(value.value(), tolerance, result);
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
