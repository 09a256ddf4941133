#include "frictional_contact_sim/solver/fb_levenberg_marquardt.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// lambda below this cannot be seen in J' J, whose entries are of order one.
constexpr double SMALLEST_LAMBDA = 1e-14;
constexpr double LARGEST_DAMPING = 1e12;
}  // namespace

const OptionTable<FbLevenbergMarquardtOptions>& FbLevenbergMarquardtOptions::table()
{
  static const OptionTable<FbLevenbergMarquardtOptions> table(
      "fb_levenberg_marquardt",
      {
          {"first_damping", &FbLevenbergMarquardtOptions::first_damping, above(0.0), "-", "lambda at the start"},
          {"smallest_damping", &FbLevenbergMarquardtOptions::smallest_damping, above(0.0), "-",
           "lambda never falls below, <= first_damping"},
          {"smallest_gain", &FbLevenbergMarquardtOptions::smallest_gain, inside(0.0, 1.0), "-",
           "actual over predicted decrease from which a step is accepted"},
      });
  return table;
}

void FbLevenbergMarquardtOptions::validate() const
{
  table().validate(*this);
  requireOption(smallest_damping <= first_damping, "fb_levenberg_marquardt.smallest_damping", smallest_damping,
                "<= first_damping");
}

FbLevenbergMarquardt::FbLevenbergMarquardt(const FbLevenbergMarquardtOptions& options)
  : Solver("fb_levenberg_marquardt"), options_(options)
{
  options_.validate();
}

void FbLevenbergMarquardt::setOptions(const FbLevenbergMarquardtOptions& options)
{
  options.validate();
  options_ = options;
}

bool FbLevenbergMarquardt::tryStep(double lambda, double& merit, double& gain)
{
  double predicted = 0.0;
  if (!steps_.leastSquares(system_, lambda, step_, predicted) || !(predicted > 0.0))
    return false;
  trial_z_ = z_ + step_;
  system_.velocity(trial_z_, trial_c_);
  // Only the value is new: A and B of the accepted point are evaluated when it becomes the iterate.
  const double trial = system_.evaluate(trial_c_, trial_z_, 0.0, false);
  gain = (merit - trial) / predicted;
  if (!(gain > options_.smallest_gain))
  {
    system_.evaluate(c_, z_, 0.0, false);
    return false;
  }
  merit = trial;
  z_.swap(trial_z_);
  c_.swap(trial_c_);
  return true;
}

void FbLevenbergMarquardt::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  system_.set(problem, context.metric.step_lengths);
  ScaledContacts& contacts = system_.contacts();
  contacts.scaleImpulse(result.solution.r, z_);
  contacts.velocity(z_, c_);
  const double scale = std::max(contacts.freeVelocity().norm(), std::numeric_limits<double>::min());
  double damping = options_.first_damping, increase = 2.0;
  const double work = SolveContext::factorization(problem, problem.W.rows());
  OuterLoop loop(context, result);
  bool moved = true;
  double merit = 0.0;
  for (result.iterations = 0;; ++result.iterations)
  {
    if (moved)
    {
      contacts.unscaleImpulse(z_, r_);
      contacts.unscaleVelocity(c_, u_);
      if (loop.record(context.residual(problem, u_, r_), r_))
        return;
      merit = system_.evaluate(c_, z_, 0.0, true);
      steps_.assemble(system_);
    }
    if (loop.outOfBudget("Levenberg-Marquardt iterations exhausted", 2.0 * work))
      return;
    if (damping > LARGEST_DAMPING || !std::isfinite(merit))
    {
      result.status = std::isfinite(merit) ? SolverStatus::STAGNATED : SolverStatus::NUMERICAL_FAILURE;
      result.message = std::isfinite(merit) ? "the merit function has no descent left" : "the merit is not finite";
      return;
    }
    double gain = 0.0;
    moved = tryStep(std::max(damping * std::sqrt(2.0 * merit) / scale, SMALLEST_LAMBDA), merit, gain);
    if (moved)
    {
      damping = std::max(damping * std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)), options_.smallest_damping);
      increase = 2.0;
    }
    else
    {
      damping *= increase;
      increase *= 2.0;
    }
  }
}

}  // namespace frictional_contact_sim
