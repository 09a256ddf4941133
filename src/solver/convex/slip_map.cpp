#include "frictional_contact_sim/solver/convex/slip_map.h"

#include <algorithm>

#include "frictional_contact_sim/problem/residual.h"

namespace frictional_contact_sim
{
namespace
{
/// r is taken for a direction of recession when |r_i|/rho_i exceeds the velocities by this factor ...
constexpr double RECESSION_SIZE = 1e3;
/// ... and W r and c.r are this small beside it.
constexpr double RECESSION_SLOPE = 1e-3;
}  // namespace

bool isUnqualified(const ConvexProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r)
{
  double size = 0.0;
  for (int i = 0; i < problem.W->blocks(); ++i)
    size = std::max(size, r.segment(problem.W->offset(i), problem.W->dimension(i)).norm() / problem.step_lengths[i]);
  const double speed = std::max(problem.c.lpNorm<Eigen::Infinity>(), VELOCITY_FLOOR);
  return size > RECESSION_SIZE * speed && (u - problem.c).lpNorm<Eigen::Infinity>() < RECESSION_SLOPE * size &&
         problem.c.dot(r) <= RECESSION_SLOPE * problem.c.norm() * r.norm();
}

SlipMap::SlipMap(std::unique_ptr<ConvexSolver> inner) : inner_(std::move(inner))
{
}

SlipMap::~SlipMap() = default;

OperatorUse SlipMap::operatorUse() const
{
  return inner_->operatorUse();
}

void SlipMap::setProblem(const DelassusProblem& problem, const SolveContext& context)
{
  problem_ = &problem;
  velocity_scale_ = context.smallestScale();
  makeConeProblem(problem, context.metric.step_lengths, convex_);
  contacts_.clear();
  for (size_t i = 0; i < problem.laws.size(); ++i)
    if (problem.laws[i].isCoulomb() && problem.laws[i].coefficient > 0.0)
      contacts_.push_back(static_cast<int>(i));
  value_.setZero(size());
  shifted_.setZero(problem.W.rows());
}

void SlipMap::slip()
{
  for (int k = 0; k < size(); ++k)
    value_[k] = u_.segment(problem_->W.offset(contact(k)) + 1, problem_->W.dimension(contact(k)) - 1).norm();
}

void SlipMap::setGuess(const Eigen::VectorXd& r)
{
  r_ = r;
  projectOntoSets(convex_, r_);
  problem_->W.apply(r_, u_);
  u_ += problem_->q;
  slip();
}

ConvexResult SlipMap::evaluate(const Eigen::VectorXd& s, const ConvexBudget& budget)
{
  for (int k = 0; k < size(); ++k)
  {
    const int row = problem_->W.offset(contact(k));
    convex_.c[row] = problem_->q[row] + problem_->laws[static_cast<size_t>(contact(k))].coefficient * s[k];
  }
  const ConvexResult result = inner_->solve(convex_, budget, r_, shifted_);
  u_ = shifted_ - convex_.c + problem_->q;
  slip();
  return result;
}

ConvexResult SlipMap::evaluate(const Eigen::VectorXd& s, double relative_tolerance, ConvexBudget& budget)
{
  budget.tolerance = relative_tolerance * velocity_scale_;
  return evaluate(s, static_cast<const ConvexBudget&>(budget));
}

}  // namespace frictional_contact_sim
