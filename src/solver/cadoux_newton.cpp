#include "frictional_contact_sim/solver/cadoux_newton.h"

#include <Eigen/QR>

#include "frictional_contact_sim/math/cone.h"
#include "frictional_contact_sim/problem/law_functions.h"
#include "frictional_contact_sim/solver/convex/spectral_gradient.h"
#include "frictional_contact_sim/solver/outer_loop.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
template <int D>
void coneJacobian(const Law& law, const Eigen::VectorXd& x, int row, SquareMatrix<3>& jacobian)
{
  jacobian.topLeftCorner<D, D>() = coneProjectionJacobian<D>(x.segment<D>(row), law.coefficient);
}

SquareMatrix<3> projectionJacobian(const Law& law, const Eigen::VectorXd& x, int row)
{
  SquareMatrix<3> jacobian = SquareMatrix<3>::Zero();
  if (law.type == LawType::COULOMB_3D)
    coneJacobian<3>(law, x, row, jacobian);
  else if (law.type == LawType::COULOMB_2D)
    coneJacobian<2>(law, x, row, jacobian);
  else
    jacobian(0, 0) = projectionSlope(law, x[row]);
  return jacobian;
}
}  // namespace

void CadouxNewtonOptions::validate() const
{
  requireOption(inner_accuracy > 0.0 && inner_accuracy < 1.0, "cadoux_newton.inner_accuracy", inner_accuracy,
                "in (0, 1)");
  requireOption(line_search_steps >= 0, "cadoux_newton.line_search_steps", line_search_steps, ">= 0");
  requireOption(sufficient_decrease > 0.0 && sufficient_decrease < 0.5, "cadoux_newton.sufficient_decrease",
                sufficient_decrease, "in (0, 0.5)");
  requireOption(rank_threshold > 0.0 && rank_threshold < 1.0, "cadoux_newton.rank_threshold", rank_threshold,
                "in (0, 1)");
  requireOption(max_rows >= 1, "cadoux_newton.max_rows", max_rows, ">= 1");
  requireOption(stall_window >= 2, "cadoux_newton.stall_window", stall_window, ">= 2");
}

Eigen::VectorXd cadouxNewtonStep(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s,
                                 double rank_threshold)
{
  const Eigen::MatrixXd W = problem.W.toDense();
  const Eigen::VectorXd gap = map.value() - s;  // F - s
  // Rows of S W, then W + E S W and E (F - s).
  Eigen::MatrixXd slope(map.size(), W.cols());
  Eigen::MatrixXd shifted = W;
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(W.rows());
  for (int k = 0; k < map.size(); ++k)
  {
    const int i = map.contact(k);
    const int row = problem.W.offset(i);
    const int tangents = problem.W.dimension(i) - 1;
    const double mu = problem.laws[static_cast<std::size_t>(i)].coefficient;
    slope.row(k).setZero();
    if (map.value()[k] > 0.0)
      slope.row(k) = map.u().segment(row + 1, tangents).transpose() / map.value()[k] * W.middleRows(row + 1, tangents);
    shifted.row(row) += mu * slope.row(k);
    shift[row] = mu * gap[k];
  }
  const Eigen::VectorXd& rho = map.convexProblem().step_lengths;
  Eigen::MatrixXd system(W.rows(), W.cols());
  Eigen::VectorXd right(W.rows());
  Eigen::VectorXd x = map.r();
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int row = problem.W.offset(i);
    const int d = problem.W.dimension(i);
    x.segment(row, d) -= rho[i] * map.shiftedVelocity().segment(row, d);
    const SquareMatrix<3> jacobian = projectionJacobian(problem.laws[static_cast<std::size_t>(i)], x, row);
    const auto P = jacobian.topLeftCorner(d, d);
    system.middleRows(row, d) = rho[i] * P * shifted.middleRows(row, d);
    system.block(row, row, d, d) += Eigen::MatrixXd::Identity(d, d) - P;
    right.segment(row, d) = -rho[i] * P * shift.segment(row, d);
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  factor.setThreshold(rank_threshold);
  factor.compute(system);
  const Eigen::VectorXd dr = factor.solve(right);
  return gap + slope * dr;
}

CadouxNewton::CadouxNewton(const CadouxNewtonOptions& options, std::unique_ptr<ConvexSolver> inner)
  : Solver("cadoux_newton")
  , options_(options)
  , map_(inner != nullptr ? std::move(inner) : std::make_unique<SpectralGradient>())
{
  options_.validate();
}

void CadouxNewton::doSolve(const DelassusProblem& problem, SolverResult& result)
{
  OuterLoop loop(stopping().tolerance, result, options_.stall_window);
  if (problem.W.rows() > options_.max_rows)
  {
    loop.stop(SolverStatus::NUMERICAL_FAILURE, "");
    result.message = "the least-squares system has " + std::to_string(problem.W.rows()) + " rows, the limit is " +
                     std::to_string(options_.max_rows);
    return;
  }
  map_.setProblem(problem, stepLengths());
  map_.setGuess(result.solution.r);
  Eigen::VectorXd s = map_.value();
  if (loop.record(residual(problem, map_.u(), map_.r()), map_.r()))
    return;
  ConvexBudget budget;
  budget.interrupted = [this] { return timeIsUp(); };
  const auto evaluate = [&](const Eigen::VectorXd& point)
  {
    map_.evaluate(point, loop.innerTolerance(options_.inner_accuracy, map_.size() > 0), budget);
    return 0.5 * (map_.value() - point).squaredNorm();
  };
  double merit = evaluate(s);
  while (!loop.outOfBudget(stopping().max_iterations, timeIsUp(), "Newton iterations exhausted"))
  {
    ++result.iterations;
    if (loop.record(residual(problem, map_.u(), map_.r()), map_.r()))
      return;
    const Eigen::VectorXd step = cadouxNewtonStep(problem, map_, s, options_.rank_threshold);
    const Eigen::VectorXd fixed_point = map_.value();
    double length = 1.0;
    double trial_merit = merit;
    bool accepted = false;
    for (int k = 0; k <= options_.line_search_steps && !accepted && step.allFinite(); ++k, length *= 0.5)
    {
      const Eigen::VectorXd trial = (s + length * step).cwiseMax(0.0);
      trial_merit = evaluate(trial);
      // Newton's slope of the merit is -2 merit.
      accepted = trial_merit <= (1.0 - 2.0 * options_.sufficient_decrease * length) * merit;
      if (accepted)
        s = trial;
    }
    if (!accepted)
    {
      s = fixed_point;
      trial_merit = evaluate(s);
    }
    merit = trial_merit;
  }
}

}  // namespace frictional_contact_sim
