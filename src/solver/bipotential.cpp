#include "frictional_contact_sim/solver/bipotential.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/problem/law_functions.h"
#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LARGEST_PENALTY = 1e6;
constexpr double SWEEP_WORK = 4.0;  ///< products with matrices of the size of W in a sweep

/// y <- y shortened by `threshold` (to zero at most).
void softThreshold(double* y, int size, double threshold)
{
  Eigen::Map<Eigen::VectorXd> vector(y, size);
  const double norm = vector.norm();
  vector *= norm > threshold ? 1.0 - threshold / norm : 0.0;
}
}  // namespace

const OptionTable<BipotentialOptions>& BipotentialOptions::table()
{
  static const OptionTable<BipotentialOptions> table(
      "bipotential",
      {
          {"penalty", &BipotentialOptions::penalty, NumberRange{0.0, LARGEST_PENALTY, true}, "-",
           "sigma at the start, in scaled variables, >= smallest_penalty"},
          {"smallest_penalty", &BipotentialOptions::smallest_penalty, NumberRange{0.0, LARGEST_PENALTY, true}, "-",
           "sigma never falls below"},
          {"balance_interval", &BipotentialOptions::balance_interval, atLeast(1), "iterations",
           "between two looks at sigma"},
          {"balance_ratio", &BipotentialOptions::balance_ratio, above(1.0), "-",
           "sigma changes when one of the two residuals is that much larger"},
          {"relaxation", &BipotentialOptions::relaxation, NumberRange{1.0, 2.0, false, true}, "-",
           "over-relaxation of z in the other two steps"},
          {"max_rows", &BipotentialOptions::max_rows, atLeast(1), "rows", "above them the dense factor is refused"},
      });
  return table;
}

void BipotentialOptions::validate() const
{
  table().validate(*this);
  requireOption(penalty >= smallest_penalty, "bipotential.penalty", penalty, ">= smallest_penalty");
}

Bipotential::Bipotential(const BipotentialOptions& options) : Solver("bipotential"), options_(options)
{
  options_.validate();
}

void Bipotential::setOptions(const BipotentialOptions& options)
{
  options.validate();
  options_ = options;
}

bool Bipotential::factor()
{
  // The Hessian of z . W z is W + W'; W need not be exactly symmetric.
  shifted_ = matrix_ + matrix_.transpose() + sigma_ * squared_;
  shifted_.diagonal().array() += sigma_;
  llt_.compute(shifted_);
  return llt_.info() == Eigen::Success;
}

void Bipotential::sweep()
{
  const Eigen::VectorXd& q = scaled_.freeVelocity();
  relaxed_c_ = w_ - beta_ - q;
  rhs_.noalias() = sigma_ * (matrix_.transpose() * relaxed_c_);
  rhs_ += sigma_ * (x_ - alpha_) - q;
  z_ = llt_.solve(rhs_);
  c_.noalias() = matrix_ * z_;
  c_ += q;
  old_x_ = x_;
  old_w_ = w_;
  relaxed_z_ = options_.relaxation * z_ + (1.0 - options_.relaxation) * x_;
  relaxed_c_ = options_.relaxation * c_ + (1.0 - options_.relaxation) * w_;
  updateCopies();
  alpha_ += relaxed_z_ - x_;
  beta_ += relaxed_c_ - w_;
}

void Bipotential::updateCopies()
{
  x_ = relaxed_z_ + alpha_;
  w_ = relaxed_c_ + beta_;
  for (size_t i = 0; i < scaled_.laws().size(); ++i)
  {
    const Law& law = scaled_.laws()[i];
    const int row = scaled_.offset(static_cast<int>(i));
    const int d = law.dimension();
    const double impulse = old_x_[row];
    if (law.isCoulomb())
    {
      x_[row] -= law.coefficient * old_w_.segment(row + 1, d - 1).norm() / sigma_;
      w_[row] = std::max(0.0, w_[row]);
      softThreshold(&w_[row + 1], d - 1, law.coefficient * std::max(impulse, 0.0) / sigma_);
    }
    else if (law.type == LawType::UNILATERAL)
      w_[row] = std::max(0.0, w_[row]);
    else if (law.type == LawType::DRY_FRICTION)
      softThreshold(&w_[row], 1, law.coefficient / sigma_);
    else
      w_[row] = 0.0;
    projectImpulse(law, &x_[row]);
  }
}

bool Bipotential::balance()
{
  const double primal = std::sqrt((z_ - x_).squaredNorm() + (c_ - w_).squaredNorm());
  rhs_ = x_ - old_x_;
  rhs_.noalias() += matrix_.transpose() * (w_ - old_w_);
  const double dual = sigma_ * rhs_.norm();
  double factor_by = 1.0;
  if (primal > options_.balance_ratio * dual)
    factor_by = 2.0;
  else if (dual > options_.balance_ratio * primal)
    factor_by = 0.5;
  const double next = std::clamp(sigma_ * factor_by, options_.smallest_penalty, LARGEST_PENALTY);
  if (next == sigma_)
    return true;
  alpha_ *= sigma_ / next;
  beta_ *= sigma_ / next;
  sigma_ = next;
  return factor();
}

void Bipotential::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  if (problem.W.rows() > options_.max_rows)
  {
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.message = std::to_string(problem.W.rows()) + " rows are too many for the dense factor of bipotential";
    return;
  }
  scaled_.set(problem, context.metric.step_lengths, ScaledContacts::Metric::DIRECTION);
  scaled_.scaleImpulse(result.solution.r, z_);
  scaled_.velocity(z_, c_);
  matrix_ = scaled_.root().asDiagonal() * problem.W.toDense() * scaled_.root().asDiagonal();
  if (problem.W.isDense())
    squared_.noalias() = matrix_.transpose() * matrix_;
  else
  {
    const SparseRows sparse = matrix_.sparseView();
    squared_ = SparseRows(sparse.transpose() * sparse);
  }
  sigma_ = options_.penalty;
  x_ = z_;
  w_ = c_;
  alpha_ = -c_ / sigma_;
  beta_ = -z_ / sigma_;
  bool regular = factor();
  OuterLoop loop(context, result);
  for (result.iterations = 0;; ++result.iterations)
  {
    scaled_.unscaleImpulse(x_, r_);
    problem.W.apply(r_, u_);
    u_ += problem.q;
    const double value = context.residual(problem, u_, r_);
    if (loop.record(value, r_))
      return;
    if (!regular || !std::isfinite(value))
    {
      result.status = SolverStatus::NUMERICAL_FAILURE;
      result.message = regular ? "the iterates diverged" : "the matrix of the quadratic step is not positive definite";
      return;
    }
    if (loop.outOfBudget("splitting iterations exhausted", SWEEP_WORK))
      return;
    sweep();
    if ((result.iterations + 1) % options_.balance_interval == 0)
      regular = balance();
  }
}

}  // namespace frictional_contact_sim
