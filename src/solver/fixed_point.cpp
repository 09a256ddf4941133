#include "frictional_contact_sim/solver/fixed_point.h"

#include <cmath>

#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// Smallest and largest theta; beyond, the iteration has lost its sense.
constexpr double SMALLEST_STEP = 1e-12;
constexpr double LARGEST_STEP = 1e12;
}  // namespace

const OptionTable<FixedPointOptions>& FixedPointOptions::table()
{
  static const OptionTable<FixedPointOptions> table(
      "fixed_point", {
                         {"first_step", &FixedPointOptions::first_step, above(0.0), "-", "theta at the start"},
                         {"adapt", &FixedPointOptions::adapt, "theta changes; else it stays at first_step"},
                         {"largest_ratio", &FixedPointOptions::largest_ratio, inside(0.0, 2.0), "-",
                          "accepted theta |F(y) - F(z)| / |y - z|"},
                         {"smallest_ratio", &FixedPointOptions::smallest_ratio, inside(0.0, 2.0), "-",
                          "below it theta grows, < largest_ratio"},
                         {"shrink", &FixedPointOptions::shrink, inside(0.0, 1.0), "-", "factor on theta"},
                     });
  return table;
}

void FixedPointOptions::validate() const
{
  table().validate(*this);
  requireOption(smallest_ratio < largest_ratio, "fixed_point.smallest_ratio", smallest_ratio, "< largest_ratio");
}

FixedPoint::FixedPoint(std::string name, const FixedPointMap& map, ScaledContacts::Metric metric,
                       const FixedPointOptions& options)
  : Solver(std::move(name)), map_(map), metric_(metric), options_(options)
{
  options_.validate();
}

void FixedPoint::setOptions(const FixedPointOptions& options)
{
  options.validate();
  options_ = options;
}

double FixedPoint::evaluate(const DelassusProblem& problem, const SolveContext& context, const Eigen::VectorXd& z,
                            Eigen::VectorXd& field)
{
  scaled_.velocity(z, field);
  scaled_.unscaleImpulse(z, r_);
  scaled_.unscaleVelocity(field, u_);
  const double value = context.residual(problem, u_, r_);
  for (int i = 0; i < problem.W.blocks(); ++i)
    map_.field(scaled_.laws()[static_cast<size_t>(i)], &field[scaled_.offset(i)]);
  return value;
}

void FixedPoint::advance(double theta)
{
  trial_ = z_ - theta * field_;
  for (size_t i = 0; i < scaled_.laws().size(); ++i)
  {
    const int row = scaled_.offset(static_cast<int>(i));
    map_.project(scaled_.laws()[i], &z_[row], &trial_[row]);
  }
}

void FixedPoint::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  scaled_.set(problem, context.metric.step_lengths, metric_);
  scaled_.scaleImpulse(result.solution.r, z_);
  double theta = options_.first_step;
  OuterLoop loop(context, result);
  if (loop.record(evaluate(problem, context, z_, field_), result.solution.r))
    return;
  while (!loop.outOfBudget("fixed-point iterations exhausted"))
  {
    advance(theta);
    ++result.iterations;
    const double value = evaluate(problem, context, trial_, trial_field_);
    if (!std::isfinite(value))
    {
      loop.stop(SolverStatus::NUMERICAL_FAILURE, "the fixed-point iterations diverged");
      return;
    }
    if (loop.record(value, r_))
      return;
    const double change = (trial_ - z_).norm();
    const double ratio = change > 0.0 ? theta * (trial_field_ - field_).norm() / change : 0.0;
    if (change == 0.0 || theta < SMALLEST_STEP || theta > LARGEST_STEP)
    {
      loop.stop(SolverStatus::STAGNATED, change == 0.0 ? "the iterate no longer changes" : "no step length leads on");
      return;
    }
    if (options_.adapt && ratio > options_.largest_ratio)
    {
      theta *= options_.shrink;
      continue;
    }
    z_.swap(trial_);
    field_.swap(trial_field_);
    if (options_.adapt && ratio < options_.smallest_ratio)
      theta /= options_.shrink;
  }
}

}  // namespace frictional_contact_sim
