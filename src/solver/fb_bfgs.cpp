#include "frictional_contact_sim/solver/fb_bfgs.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double FIRST_STEP = 0.5;
/// Pairs with a smaller cosine between s and y would spoil the approximation.
constexpr double SMALLEST_COSINE = 1e-10;
constexpr double GROWTH = 2.0;
/// Iterations after which c(z), otherwise summed up, is computed anew.
constexpr int REFRESH_INTERVAL = 100;
/// The interpolated point keeps this share of the bracket away from its ends.
constexpr double MARGIN = 0.1;

/// Minimiser of the cubic through two points with slopes, kept inside the bracket.
double interpolate(double t1, double f1, double g1, double t2, double f2, double g2)
{
  const double a = g1 + g2 - 3.0 * (f1 - f2) / (t1 - t2);
  const double root = a * a - g1 * g2;
  double t = 0.5 * (t1 + t2);
  if (root >= 0.0)
  {
    const double b = std::copysign(std::sqrt(root), t2 - t1);
    const double candidate = t2 - (t2 - t1) * (g2 + b - a) / (g2 - g1 + 2.0 * b);
    if (std::isfinite(candidate))
      t = candidate;
  }
  const double low = std::min(t1, t2), high = std::max(t1, t2);
  return std::clamp(t, low + MARGIN * (high - low), high - MARGIN * (high - low));
}
}  // namespace

const OptionTable<FbBfgsOptions>& FbBfgsOptions::table()
{
  static const OptionTable<FbBfgsOptions> table(
      "fb_bfgs",
      {
          {"memory", &FbBfgsOptions::memory, atLeast(1), "pairs", "that are kept"},
          {"sufficient_decrease", &FbBfgsOptions::sufficient_decrease, inside(0.0, 0.5), "-",
           "c1 of Wolfe's conditions"},
          {"curvature", &FbBfgsOptions::curvature, inside(0.0, 1.0), "-",
           "c2 of Wolfe's conditions, > sufficient_decrease"},
          {"line_search_steps", &FbBfgsOptions::line_search_steps, atLeast(1), "evaluations", "a line search"},
      });
  return table;
}

void FbBfgsOptions::validate() const
{
  table().validate(*this);
  requireOption(curvature > sufficient_decrease, "fb_bfgs.curvature", curvature, "> sufficient_decrease");
}

FbBfgs::FbBfgs(const FbBfgsOptions& options) : Solver("fb_bfgs"), options_(options)
{
  options_.validate();
}

void FbBfgs::setOptions(const FbBfgsOptions& options)
{
  options.validate();
  options_ = options;
}

FbBfgs::Point FbBfgs::evaluate(double t)
{
  trial_z_ = z_ + t * step_;
  trial_c_ = c_ + t * step_velocity_;
  Point point;
  point.t = t;
  point.merit = system_.evaluate(trial_c_, trial_z_, 0.0, true);
  system_.gradient(trial_gradient_);
  point.slope = trial_gradient_.dot(step_);
  return point;
}

bool FbBfgs::lineSearch(const Point& start)
{
  // Bracketing and sectioning in one loop; `high` is unset while every tried point goes down and forward.
  Point low = start, high;
  bool bracketed = false;
  double t = 1.0;
  for (int k = 0; k < options_.line_search_steps; ++k)
  {
    const Point point = evaluate(t);
    const bool decreased = point.merit <= start.merit + options_.sufficient_decrease * t * start.slope;
    if (!decreased || !(point.merit < low.merit || low.t == 0.0))
    {
      high = point;
      bracketed = true;
    }
    else
    {
      if (std::abs(point.slope) <= options_.curvature * std::abs(start.slope))
        return true;
      if (bracketed ? point.slope * (high.t - low.t) >= 0.0 : point.slope >= 0.0)
      {
        high = low;
        bracketed = true;
      }
      low = point;
    }
    if (!bracketed)
      t *= GROWTH;
    else if (!std::isfinite(high.merit))
      t = 0.5 * (low.t + high.t);
    else
      t = interpolate(low.t, low.merit, low.slope, high.t, high.merit, high.slope);
  }
  // A kink may leave no point with a small slope: any sufficient decrease will do.
  if (low.t == 0.0)
    return false;
  evaluate(low.t);
  return true;
}

void FbBfgs::direction()
{
  step_ = -gradient_;
  const int memory = options_.memory;
  for (int k = 1; k <= pairs_; ++k)
  {
    const int j = (next_ - k + 2 * memory) % memory;
    weights_[j] = inverse_[j] * moves_.col(j).dot(step_);
    step_ -= weights_[j] * changes_.col(j);
  }
  const int last = (next_ - 1 + memory) % memory;
  step_ *= pairs_ == 0 ? FIRST_STEP : 1.0 / (inverse_[last] * changes_.col(last).squaredNorm());
  for (int k = pairs_; k >= 1; --k)
  {
    const int j = (next_ - k + 2 * memory) % memory;
    step_ += (weights_[j] - inverse_[j] * changes_.col(j).dot(step_)) * moves_.col(j);
  }
}

void FbBfgs::remember()
{
  moves_.col(next_) = trial_z_ - z_;
  changes_.col(next_) = trial_gradient_ - gradient_;
  const double product = moves_.col(next_).dot(changes_.col(next_));
  if (!(product > SMALLEST_COSINE * moves_.col(next_).norm() * changes_.col(next_).norm()))
    return;
  inverse_[next_] = 1.0 / product;
  next_ = (next_ + 1) % options_.memory;
  pairs_ = std::min(pairs_ + 1, options_.memory);
}

void FbBfgs::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  system_.set(problem, context.metric.step_lengths);
  ScaledContacts& contacts = system_.contacts();
  contacts.scaleImpulse(result.solution.r, z_);
  moves_.resize(system_.rows(), options_.memory);
  changes_.resize(system_.rows(), options_.memory);
  inverse_.setZero(options_.memory);
  weights_.setZero(options_.memory);
  pairs_ = next_ = 0;
  contacts.velocity(z_, c_);
  Point current;
  current.merit = system_.evaluate(c_, z_, 0.0, true);
  system_.gradient(gradient_);
  OuterLoop loop(context, result);
  for (result.iterations = 0;; ++result.iterations)
  {
    contacts.unscaleImpulse(z_, r_);
    contacts.unscaleVelocity(c_, u_);
    if (loop.record(context.residual(problem, u_, r_), r_))
      return;
    if (loop.outOfBudget("quasi-Newton iterations exhausted"))
      return;
    bool moved = false;
    for (int attempt = 0; attempt < 2 && !moved; ++attempt)
    {
      direction();
      current.slope = gradient_.dot(step_);
      contacts.apply(step_, step_velocity_);
      moved = current.slope < 0.0 && lineSearch(current);
      if (!moved)
        pairs_ = next_ = 0;
    }
    if (!moved)
    {
      result.status = std::isfinite(current.merit) ? SolverStatus::STAGNATED : SolverStatus::NUMERICAL_FAILURE;
      result.message = "the merit function has no descent left";
      return;
    }
    remember();
    z_.swap(trial_z_);
    gradient_.swap(trial_gradient_);
    c_.swap(trial_c_);
    if ((result.iterations + 1) % REFRESH_INTERVAL == 0)
      contacts.velocity(z_, c_);
    current.merit = 0.5 * system_.value().squaredNorm();
  }
}

}  // namespace frictional_contact_sim
