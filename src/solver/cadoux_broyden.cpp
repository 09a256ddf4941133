#include "frictional_contact_sim/solver/cadoux_broyden.h"

#include <cmath>
#include <limits>

#include "frictional_contact_sim/solver/outer_loop.h"

namespace frictional_contact_sim
{
const OptionTable<CadouxBroydenOptions>& CadouxBroydenOptions::table()
{
  static const OptionTable<CadouxBroydenOptions> table(
      "cadoux_broyden",
      {
          {"inner_accuracy", &CadouxBroydenOptions::inner_accuracy, inside(0.0, 1.0), "-",
           "inner tolerance relative to the outer error"},
          {"memory", &CadouxBroydenOptions::memory, atLeast(1), "terms", "of rank one that are kept"},
          {"divergence", &CadouxBroydenOptions::divergence, above(1.0), "-",
           "growth of |G| over its best value that resets B"},
          {"stall_window", &CadouxBroydenOptions::stall_window, atLeast(2), "iterations",
           "without the residual falling by a tenth before giving up"},
          {"inner", &CadouxBroydenOptions::inner, innerSolverNames(), "method of the inner convex problems"},
      });
  return table;
}

void CadouxBroydenOptions::validate() const
{
  table().validate(*this);
}

CadouxBroyden::CadouxBroyden(const CadouxBroydenOptions& options, std::unique_ptr<ConvexSolver> inner)
  : Solver("cadoux_broyden")
  , options_(options)
  , map_(inner != nullptr ? std::move(inner) : createInnerSolver(options.inner))
{
  options_.validate();
}

Eigen::VectorXd CadouxBroyden::apply(const Eigen::VectorXd& x) const
{
  Eigen::VectorXd y = -x;
  for (size_t k = 0; k < left_.size(); ++k)
    y += right_[k].dot(x) * left_[k];
  return y;
}

Eigen::VectorXd CadouxBroyden::applyTransposed(const Eigen::VectorXd& x) const
{
  Eigen::VectorXd y = -x;
  for (size_t k = 0; k < left_.size(); ++k)
    y += left_[k].dot(x) * right_[k];
  return y;
}

void CadouxBroyden::update(const Eigen::VectorXd& ds, const Eigen::VectorXd& dG)
{
  const Eigen::VectorXd product = apply(dG);
  const double curvature = ds.dot(product);
  // ds^T B dG is near |ds|^2 when B is good; far below, the update would blow B up.
  if (std::abs(curvature) < 1e-3 * ds.squaredNorm())
    return;
  if (static_cast<int>(left_.size()) >= options_.memory)
  {
    left_.clear();
    right_.clear();
    return;
  }
  Eigen::VectorXd right = applyTransposed(ds);
  left_.push_back((ds - product) / curvature);
  right_.push_back(std::move(right));
}

void CadouxBroyden::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  left_.clear();
  right_.clear();
  map_.setProblem(problem, context);
  map_.setGuess(result.solution.r);
  Eigen::VectorXd s = map_.value();
  OuterLoop loop(context, result, options_.stall_window);
  if (loop.record(context.residual(problem, map_.u(), map_.r()), map_.r()))
    return;
  ConvexBudget budget;
  budget.interrupted = [&context] { return context.spend(1.0); };  // a product an inner iteration
  Eigen::VectorXd old_s, old_G, best_F;
  double best = std::numeric_limits<double>::infinity();
  while (!loop.outOfBudget("outer iterations exhausted"))
  {
    map_.evaluate(s, loop.innerTolerance(options_.inner_accuracy, map_.size() > 0), budget);
    ++result.iterations;
    if (loop.record(context.residual(problem, map_.u(), map_.r()), map_.r()))
      return;
    const Eigen::VectorXd G = map_.value() - s;
    if (!std::isfinite(G.norm()) && best_F.size() == 0)
    {
      result.status = SolverStatus::NUMERICAL_FAILURE;
      result.message = "the first inner problem has no finite answer";
      return;
    }
    if (G.norm() < best)
    {
      best = G.norm();
      best_F = map_.value();
    }
    if (!(G.norm() <= options_.divergence * best))
    {
      left_.clear();
      right_.clear();
      old_s.resize(0);
      s = best_F;
      continue;
    }
    if (old_s.size() > 0)
      update(s - old_s, G - old_G);
    old_s = s;
    old_G = G;
    s = (s - apply(G)).cwiseMax(0.0);
  }
}

}  // namespace frictional_contact_sim
