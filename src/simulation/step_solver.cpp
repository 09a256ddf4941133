#include "step_solver.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "frictional_contact_sim/problem/energy_check.h"
#include "frictional_contact_sim/solver/registry.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double RUNAWAY_SPEED = 1e9;  ///< faster than light [m/s] or [rad/s]: not a motion, a failed step
constexpr double SHARE_OF_TOLERANCE = 0.5;  ///< of E: what other forces of the same effect may add to it
/// Two that answer what the portfolio's shorter turns left in floods of commands, another idea than all of its own,
/// then methods that it has itself, for whoever chose another one.
constexpr const char* FALLBACKS[] = {"interior_point", "fb_newton", "cadoux_fixed_point", "ac_newton", "gauss_seidel"};
/// Share of the iterations where overlaps are pushed out and need not be: an overlap that cannot be pushed out has no
/// answer at all.
constexpr int FIRST_TRY = 10;
/// Of a fallback, in place of StoppingOptions::work_per_iteration where that is more: it succeeds soon or not at all.
constexpr double FALLBACK_WORK = 10.0;

bool contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

void addNew(const std::vector<std::string>& names, std::vector<std::string>& list)
{
  for (const std::string& name : names)
    if (!contains(list, name))
      list.push_back(name);
}

EnergyCheck energyOf(const IncrementalProblem& problem, const SolverResult& result, double tolerance)
{
  return checkEnergy(problem, result.solution, result.free_energy, tolerance);
}

std::string createsEnergy(const EnergyCheck& check)
{
  char text[120];
  std::snprintf(text, sizeof(text), "the answer creates energy: r.u is %.3g J, expected at most %.3g J", check.work,
                check.bound);
  return text;
}
}  // namespace

bool isMotion(const Solution& solution)
{
  return solution.r.allFinite() && solution.v.allFinite() && solution.u.allFinite() && solution.lambda.allFinite() &&
         (solution.v.size() == 0 || solution.v.cwiseAbs().maxCoeff() < RUNAWAY_SPEED);
}

void setNoAnswer(const IncrementalProblem& problem, SolverStatus status, const std::string& message,
                 SolverResult& result)
{
  result.status = status;
  result.message = message;
  result.solver.clear();
  result.tried.clear();
  result.iterations = 0;
  result.seconds = 0.0;
  result.work = 0.0;
  result.free_energy = 0.0;
  result.residual = 1.0;
  result.law_errors.setZero(static_cast<Eigen::Index>(problem.laws.size()));
  result.solution.v.setConstant(problem.velocities(), std::numeric_limits<double>::quiet_NaN());
  result.solution.u.setZero(problem.rows());
  result.solution.r.setZero(problem.rows());
  result.solution.lambda.setZero(problem.bilaterals());
}

StepSolver::StepSolver(std::unique_ptr<Solver> method, const StoppingOptions& stopping, const FailureOptions& options)
  : stopping_(stopping), options_(options)
{
  setMethod(std::move(method));
}

void StepSolver::setMethod(std::unique_ptr<Solver> method)
{
  answered_ = helper_ = nullptr;
  method->setStopping(stopping_);
  method_ = std::move(method);
}

void StepSolver::setOptions(const FailureOptions& options)
{
  answered_ = helper_ = nullptr;
  options_ = options;
  method_->setStopping(stopping_);  // without what was left of a time limit
  others_.clear();
}

void StepSolver::setStopping(const StoppingOptions& stopping)
{
  stopping.validate();
  answered_ = helper_ = nullptr;
  stopping_ = stopping;
  method_->setStopping(stopping_);
  others_.clear();
}

void StepSolver::setStop(const std::atomic<bool>* stop)
{
  StoppingOptions stopping = stopping_;
  stopping.stop = stop;
  setStopping(stopping);
}

void StepSolver::begin()
{
  others_tried_ = false;
  helper_ = nullptr;
  iterations_ = 0;
  seconds_ = 0.0;
  tried_.clear();
  if (options_.time_limit > 0.0)
    start_ = std::chrono::steady_clock::now();
}

/** One method on the problem, its answer checked. @param guess nullptr = cold */
void StepSolver::run(Solver& method, const IncrementalProblem& problem, const Solution* guess, SolverResult& result)
{
  if (options_.time_limit > 0.0)
  {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    StoppingOptions stopping = method.stopping();
    stopping.time_limit = options_.time_limit - seconds;
    if (!(stopping.time_limit > 0.0))
    {
      setNoAnswer(problem, SolverStatus::TIME_LIMIT, "the time limit of the step is over", result);
      return;
    }
    method.setStopping(stopping);
  }
  try
  {
    answered_ = &method;
    method.solve(problem, guess, result);
  }
  catch (const std::exception& error)
  {
    setNoAnswer(problem, SolverStatus::NUMERICAL_FAILURE, error.what(), result);
    result.tried.push_back(method.name());
    return;
  }
  if (!isMotion(result.solution))
  {
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.message = "the answer is not a motion";
    result.residual = 1.0;
    return;
  }
  if (result.status != SolverStatus::CONVERGED)
    return;
  const EnergyCheck check = energyOf(problem, result, stopping_.tolerance);
  if (check.holds())
    return;
  result.status = SolverStatus::STAGNATED;
  result.message = createsEnergy(check);
}

bool StepSolver::mayTryOthers(const SolverResult& result) const
{
  return options_.fallback && !others_tried_ && result.status != SolverStatus::CONVERGED &&
         result.status != SolverStatus::STOPPED_BY_USER && result.status != SolverStatus::TIME_LIMIT;
}

/** What ACCEPT would rather take: an iterate that creates no energy, then the smaller residual. */
bool StepSolver::betterThan(const IncrementalProblem& problem, const SolverResult& a, const SolverResult& b) const
{
  const auto rank = [&](const SolverResult& result)
  {
    if (!isMotion(result.solution))
      return 0;
    return energyOf(problem, result, stopping_.tolerance).holds() ? 2 : 1;
  };
  const int rank_a = rank(a);
  const int rank_b = rank(b);
  return rank_a != rank_b ? rank_a > rank_b : a.residual < b.residual;
}

void StepSolver::tryOthers(const IncrementalProblem& problem, SolverResult& result)
{
  others_tried_ = true;
  if (others_.empty())
    for (const char* name : FALLBACKS)
    {
      others_.push_back(createSolver(name));
      StoppingOptions stopping = stopping_;
      stopping.work_per_iteration = std::min(stopping.work_per_iteration, FALLBACK_WORK);
      others_.back()->setStopping(stopping);
    }
  std::vector<std::string> tried = result.tried;
  int iterations = result.iterations;
  double seconds = result.seconds;
  for (const std::unique_ptr<Solver>& other : others_)
  {
    if (other->name() == method_->name())
      continue;
    // What has had a turn in the portfolio starts anew, and with a budget of its own. An iterate that creates energy (a
    // self-stress, say) is no start either.
    const bool warm = !contains(tried, other->name()) && isMotion(result.solution) &&
                      energyOf(problem, result, stopping_.tolerance).holds();
    run(*other, problem, warm ? &result.solution : nullptr, attempt_);
    addNew(attempt_.tried, tried);
    iterations += attempt_.iterations;
    seconds += attempt_.seconds;
    const bool over = attempt_.status == SolverStatus::CONVERGED || attempt_.status == SolverStatus::STOPPED_BY_USER ||
                      attempt_.status == SolverStatus::TIME_LIMIT;
    if (attempt_.status == SolverStatus::CONVERGED || betterThan(problem, attempt_, result))
      std::swap(result, attempt_);
    else if (over)
    {
      result.status = attempt_.status;
      result.message = attempt_.message;
    }
    if (attempt_.status == SolverStatus::CONVERGED || result.status == SolverStatus::CONVERGED)
      helper_ = other.get();  // later rounds of this step start with it
    if (over)
      break;
  }
  result.tried = tried;
  result.iterations = iterations;
  result.seconds = seconds;
}

void StepSolver::solve(const IncrementalProblem& problem, const Solution& guess, bool is_last_resort, bool is_doubtful,
                       SolverResult& result)
{
  // A state that has run away overflows here; it must not reach the solver as a NaN.
  if (!problem.f.allFinite() || !problem.w.allFinite() || !guess.r.allFinite())
  {
    setNoAnswer(problem, SolverStatus::NUMERICAL_FAILURE, "forces or velocities have run away", result);
    return;
  }
  Solver& method = helper_ != nullptr ? *helper_ : *method_;
  const int iterations = is_doubtful ? stopping_.max_iterations / FIRST_TRY : stopping_.max_iterations;
  if (method.stopping().max_iterations != iterations)
  {
    StoppingOptions stopping = method.stopping();
    stopping.max_iterations = iterations;
    method.setStopping(stopping);
  }
  run(method, problem, &guess, result);
  if (is_last_resort && mayTryOthers(result))
    tryOthers(problem, result);
  // A step may take several solves: what it says is of all of them.
  iterations_ += result.iterations;
  seconds_ += result.seconds;
  addNew(result.tried, tried_);
  result.iterations = iterations_;
  result.seconds = seconds_;
  result.tried = tried_;
}

void StepSolver::takeLeastNorm(const IncrementalProblem& problem, SolverResult& result)
{
  if (result.status != SolverStatus::CONVERGED || problem.rows() == 0)
    return;
  // Within these an answer stays one, see least_norm.h.
  const Eigen::VectorXd& scales = answered_->metric().scales;
  thresholds_.resize(scales.size());
  for (Eigen::Index i = 0; i < scales.size(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    thresholds_[i] =
        SHARE_OF_TOLERANCE * stopping_.tolerance * scales[i] / (law.isCoulomb() ? 1.0 + law.coefficient : 1.0);
  }
  attempt_.solution.r = result.solution.r;
  attempt_.solution.lambda = result.solution.lambda;
  attempt_.law_errors = result.law_errors;
  attempt_.residual = result.residual;
  const LeastNorm::Report report = least_norm_.improve(problem, answered_->reduction(), thresholds_, result.solution);
  if (report.changed_islands == 0)
    return;
  answered_->judgeAgain(problem, result);
  if (result.residual <= stopping_.tolerance && energyOf(problem, result, stopping_.tolerance).holds())
    return;
  result.solution.r = attempt_.solution.r;
  result.solution.lambda = attempt_.solution.lambda;
  result.law_errors = attempt_.law_errors;
  result.residual = attempt_.residual;
}

}  // namespace frictional_contact_sim
