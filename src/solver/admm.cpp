#include "frictional_contact_sim/solver/admm.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/solver/outer_loop.h"

namespace frictional_contact_sim
{
namespace
{
/// Iterations without the residual falling by a tenth before giving up: the method is not monotone.
constexpr int STALL_WINDOW = 2000;

/// Barzilai-Borwein curvature of (dz, dl) and how much it can be trusted.
struct Curvature
{
  double value = 0.0;
  double correlation = 0.0;
};

template <typename Impulse, typename Velocity>
Curvature curvature(const Impulse& dz, const Velocity& dl, const Eigen::VectorXd& metric)
{
  const double product = dz.dot(dl);
  const double z = dz.cwiseQuotient(metric).dot(dz);
  const double l = dl.cwiseProduct(metric).dot(dl);
  Curvature result;
  if (!(product > 0.0) || !(z > 0.0) || !(l > 0.0))
    return result;
  const double steepest = l / product;
  const double minimal = product / z;
  result.value = 2.0 * minimal > steepest ? minimal : steepest - 0.5 * minimal;
  result.correlation = product / std::sqrt(z * l);
  return result;
}
}  // namespace

const OptionTable<AdmmOptions>& AdmmOptions::table()
{
  static const OptionTable<AdmmOptions> table(
      "admm",
      {
          {"penalty", &AdmmOptions::penalty, above(0.0), "-", "first rho"},
          {"update_interval", &AdmmOptions::update_interval, atLeast(1), "iterations",
           "between two spectral estimates of rho"},
          {"correlation", &AdmmOptions::correlation, inside(0.0, 1.0), "-",
           "smallest correlation of a trusted curvature"},
          {"convergence", &AdmmOptions::convergence, above(0.0), "-", "constant of the limit on changes of rho"},
          {"refactor_ratio", &AdmmOptions::refactor_ratio, above(1.0), "-", "rho changes only by at least this factor"},
      });
  return table;
}

void AdmmOptions::validate() const
{
  table().validate(*this);
}

Admm::Admm(const AdmmOptions& options) : Solver("admm"), options_(options)
{
  options_.validate();
}

void Admm::updateShift(const DelassusProblem& problem)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const Law& law = problem.laws[static_cast<size_t>(i)];
    const int row = problem.W.offset(i);
    if (law.isCoulomb() && law.coefficient > 0.0)
      convex_.c[row] = problem.q[row] + law.coefficient * lambda_.segment(row + 1, law.dimension() - 1).norm();
  }
}

void Admm::remember()
{
  old_r_ = r_;
  old_y_ = y_;
  old_lambda_ = lambda_;
  old_lambda_hat_ = lambda_hat_;
}

double Admm::spectralPenalty(int iteration) const
{
  const Curvature smooth = curvature(r_ - old_r_, lambda_hat_ - old_lambda_hat_, metric_);
  const Curvature sets = curvature(old_y_ - y_, lambda_ - old_lambda_, metric_);
  const bool trust_smooth = smooth.correlation > options_.correlation;
  const bool trust_sets = sets.correlation > options_.correlation;
  double penalty = penalty_;
  if (trust_smooth && trust_sets)
    penalty = std::sqrt(smooth.value * sets.value);
  else if (trust_smooth)
    penalty = smooth.value;
  else if (trust_sets)
    penalty = sets.value;
  const double limit = 1.0 + options_.convergence / (static_cast<double>(iteration) * iteration);
  penalty = std::clamp(penalty, penalty_ / limit, penalty_ * limit);
  return std::clamp(penalty, 1e-8, 1e8);
}

bool Admm::refactor()
{
  shift_ = penalty_ * inverse_metric_;
  return factor_.factor(shift_);
}

void Admm::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  makeConeProblem(problem, context.metric.step_lengths, convex_);
  fillMetric(convex_, Metric::BLOCK, metric_);
  inverse_metric_ = metric_.cwiseInverse();
  factor_.setOperator(problem.W);
  penalty_ = options_.penalty;
  y_ = result.solution.r;
  projectOntoSets(convex_, y_);
  problem.W.apply(y_, u_);
  u_ += problem.q;
  OuterLoop loop(context, result, STALL_WINDOW);
  if (loop.record(context.residual(problem, u_, y_), y_))
    return;
  // The multiplier of the start is u~ of the guess, zero for a cold one.
  lambda_ = u_;
  if (y_.isZero(0.0))
    lambda_.setZero();
  lambda_hat_ = lambda_;
  r_ = y_;
  x_ = -metric_.cwiseProduct(lambda_) / penalty_;
  remember();
  bool factored = refactor();
  for (int k = 1; k <= context.max_iterations; ++k)
  {
    if (!factored || !y_.allFinite())
    {
      loop.stop(SolverStatus::NUMERICAL_FAILURE, "W + rho D^-1 could not be factored");
      return;
    }
    result.iterations = k;
    updateShift(problem);
    // In the form of a step from y: the factor holds the symmetric part of W only, u_ the product with W itself.
    r_ = -(u_ + (convex_.c - problem.q) + penalty_ * inverse_metric_.cwiseProduct(x_));
    factor_.solve(r_, r_);
    lambda_hat_ = -penalty_ * inverse_metric_.cwiseProduct(x_ + r_);
    r_ += y_;
    x_ += r_;
    y_ = x_;
    projectOntoSets(convex_, y_);
    x_ -= y_;
    lambda_ = -penalty_ * inverse_metric_.cwiseProduct(x_);
    problem.W.apply(y_, u_);
    u_ += problem.q;
    if (loop.record(context.residual(problem, u_, y_), y_))
      return;
    if (loop.outOfBudget("iterations exhausted"))
      return;
    if (k % options_.update_interval != 0)
      continue;
    const double penalty = spectralPenalty(k);
    remember();
    if (std::max(penalty / penalty_, penalty_ / penalty) < options_.refactor_ratio)
      continue;
    x_ *= penalty_ / penalty;
    penalty_ = penalty;
    factored = refactor();
  }
  loop.stop(SolverStatus::MAX_ITERATIONS, "iterations exhausted");
}

}  // namespace frictional_contact_sim
