#include "frictional_contact_sim/solver/outer_loop.h"

#include <algorithm>

namespace frictional_contact_sim
{
bool OuterLoop::stop(SolverStatus status, const char* message)
{
  result_.status = status;
  result_.message = message;
  return true;
}

bool OuterLoop::record(double residual, const Eigen::VectorXd& r)
{
  context_.note(result_.iterations, residual);
  last_ = residual;
  if (residual < best_)
  {
    best_ = residual;
    result_.solution.r = r;
  }
  if (best_ <= context_.tolerance)
    return stop(SolverStatus::CONVERGED, "");
  run_best_ = std::min(run_best_, residual);
  if (run_best_ < 0.9 * window_best_)
  {
    window_best_ = run_best_;
    since_ = 0;
  }
  else if (++since_ >= window_)
    return stop(SolverStatus::STAGNATED, "the outer iteration no longer reduces the residual");
  return false;
}

void OuterLoop::restart()
{
  run_best_ = window_best_ = std::numeric_limits<double>::infinity();
  since_ = 0;
}

bool OuterLoop::outOfBudget(const char* exhausted, double products)
{
  if (context_.spend(products))
    return stop(SolverStatus::TIME_LIMIT, "time limit reached");
  return result_.iterations >= context_.max_iterations && stop(SolverStatus::MAX_ITERATIONS, exhausted);
}

double OuterLoop::innerTolerance(double accuracy, bool frictional) const
{
  const double least = 0.1 * context_.tolerance;
  return frictional ? std::max(std::min(accuracy * last_, accuracy), least) : least;
}

}  // namespace frictional_contact_sim
