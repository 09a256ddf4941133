#include "frictional_contact_sim/solver/fb_newton_smoothed.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/solver/outer_loop.h"

namespace frictional_contact_sim
{
namespace
{
/// Smoothing relative to its start below which it is nothing but the plain function.
constexpr double SMALLEST_SMOOTHING = 1e-14;
/// Damping of the first least-squares step (J' J has entries of order one) and its growth.
constexpr double FIRST_LAMBDA = 1e-8;
constexpr double LAMBDA_GROWTH = 100.0;
constexpr double LARGEST_LAMBDA = 1e8;
}  // namespace

const OptionTable<FbNewtonSmoothedOptions>& FbNewtonSmoothedOptions::table()
{
  static const OptionTable<FbNewtonSmoothedOptions> table(
      "fb_newton_smoothed",
      {
          {"first_smoothing", &FbNewtonSmoothedOptions::first_smoothing, above(0.0), "-",
           "alpha at the start over the largest free velocity, in scaled variables"},
          {"smoothing_decrease", &FbNewtonSmoothedOptions::smoothing_decrease, inside(0.0, 1.0), "-",
           "factor on alpha"},
          {"inner_share", &FbNewtonSmoothedOptions::inner_share, above(0.0), "-",
           "inner tolerance over alpha, per row"},
          {"inner_iterations", &FbNewtonSmoothedOptions::inner_iterations, atLeast(1), "iterations", "an alpha"},
          {"least_squares", &FbNewtonSmoothedOptions::least_squares,
           "a damped step where Newton's fails; else the next alpha follows at once"},
          {"restarts", &FbNewtonSmoothedOptions::restarts, atLeast(0), "starts",
           "anew when no step decreases the merit"},
          {"restart_factor", &FbNewtonSmoothedOptions::restart_factor, above(1.0), "-",
           "on the first alpha of a new start"},
          {"line_search_steps", &FbNewtonSmoothedOptions::line_search_steps, atLeast(0), "halvings", "of the step"},
          {"sufficient_decrease", &FbNewtonSmoothedOptions::sufficient_decrease, inside(0.0, 0.5), "-",
           "Armijo constant"},
      });
  return table;
}

void FbNewtonSmoothedOptions::validate() const
{
  table().validate(*this);
}

FbNewtonSmoothed::FbNewtonSmoothed(const FbNewtonSmoothedOptions& options)
  : Solver("fb_newton_smoothed"), options_(options)
{
  options_.validate();
}

void FbNewtonSmoothed::setOptions(const FbNewtonSmoothedOptions& options)
{
  options.validate();
  options_ = options;
}

bool FbNewtonSmoothed::lineSearch(double alpha, double merit, int halvings)
{
  system_.contacts().apply(step_, step_velocity_);
  double t = 1.0;
  for (int k = 0; k <= halvings; ++k, t *= 0.5)
  {
    trial_z_ = z_ + t * step_;
    trial_c_ = c_ + t * step_velocity_;
    if (system_.evaluate(trial_c_, trial_z_, alpha, false) <= (1.0 - 2.0 * options_.sufficient_decrease * t) * merit)
    {
      z_.swap(trial_z_);
      return true;
    }
  }
  return false;
}

bool FbNewtonSmoothed::step(double alpha, double merit)
{
  steps_.assemble(system_);
  factorizations_ = 1;
  if (steps_.newton(system_, step_) && lineSearch(alpha, merit, options_.line_search_steps))
    return true;
  if (!options_.least_squares)
    return false;
  for (double lambda = FIRST_LAMBDA; lambda <= LARGEST_LAMBDA; lambda *= LAMBDA_GROWTH)
  {
    double predicted = 0.0;
    factorizations_ += 2;  // J' J and its factor
    system_.evaluate(c_, z_, alpha, false);
    if (steps_.leastSquares(system_, lambda, step_, predicted) && lineSearch(alpha, merit, 1))
      return true;
  }
  return false;
}

bool FbNewtonSmoothed::restart(double largest)
{
  if (restarts_ >= options_.restarts)
    return false;
  const double power = std::pow(options_.restart_factor, 1 + restarts_ / 2);
  alpha_ = restarts_ % 2 == 0 ? largest * power : largest / power;
  ++restarts_;
  inner_ = 0;
  stuck_ = false;
  z_ = start_;
  system_.velocity(z_, c_);
  return true;
}

bool FbNewtonSmoothed::nextSmoothing(double largest, double root_rows, double& merit)
{
  const double smallest = SMALLEST_SMOOTHING * largest;
  if (stuck_ && alpha_ <= smallest)
  {
    if (!restart(largest))
      return false;
    merit = system_.evaluate(c_, z_, alpha_, true);
  }
  while (alpha_ > 0.0 && (stuck_ || inner_ >= options_.inner_iterations ||
                          std::sqrt(2.0 * merit) <= options_.inner_share * alpha_ * root_rows))
  {
    alpha_ = alpha_ <= smallest ? 0.0 : options_.smoothing_decrease * alpha_;
    inner_ = 0;
    stuck_ = false;
    merit = system_.evaluate(c_, z_, alpha_, true);
  }
  return true;
}

void FbNewtonSmoothed::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  system_.set(problem, context.metric.step_lengths);
  ScaledContacts& contacts = system_.contacts();
  contacts.scaleImpulse(result.solution.r, z_);
  start_ = z_;
  const double largest = options_.first_smoothing * contacts.freeVelocity().lpNorm<Eigen::Infinity>();
  const double root_rows = std::sqrt(static_cast<double>(system_.rows()));
  const double work = SolveContext::factorization(problem, problem.W.rows());
  OuterLoop loop(context, result);
  alpha_ = largest;
  inner_ = restarts_ = factorizations_ = 0;
  stuck_ = false;
  for (result.iterations = 0;; ++result.iterations)
  {
    contacts.velocity(z_, c_);
    contacts.unscaleImpulse(z_, r_);
    contacts.unscaleVelocity(c_, u_);
    if (loop.record(context.residual(problem, u_, r_), r_))
      return;
    if (loop.outOfBudget("Newton iterations exhausted", factorizations_ * work))
      return;
    double merit = system_.evaluate(c_, z_, alpha_, true);
    if (!nextSmoothing(largest, root_rows, merit) || !std::isfinite(merit))
    {
      result.status = std::isfinite(merit) ? SolverStatus::STAGNATED : SolverStatus::NUMERICAL_FAILURE;
      result.message = std::isfinite(merit) ? "no step decreases the smoothed function" : "the function is not finite";
      return;
    }
    stuck_ = !step(alpha_, merit);
    ++inner_;
  }
}

}  // namespace frictional_contact_sim
