#include "frictional_contact_sim/solver/cadoux_newton.h"

#include <Eigen/QR>
#include <algorithm>
#include <utility>

#include "frictional_contact_sim/math/cone.h"
#include "frictional_contact_sim/problem/law_functions.h"
#include "frictional_contact_sim/solver/outer_loop.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MOST_LANDING_ROWS = 300;

bool isPlanar(const DelassusProblem& problem)
{
  return std::none_of(
      problem.laws.begin(), problem.laws.end(),
      [](const Law& law) { return law.type == LawType::COULOMB_3D && law.coefficient > 0.0; });
}

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

const OptionTable<CadouxNewtonOptions>& CadouxNewtonOptions::table()
{
  static const OptionTable<CadouxNewtonOptions> table(
      "cadoux_newton",
      {
          {"inner_accuracy", &CadouxNewtonOptions::inner_accuracy, inside(0.0, 1.0), "-",
           "inner tolerance relative to the outer error"},
          {"line_search_steps", &CadouxNewtonOptions::line_search_steps, atLeast(0), "halvings", "of the step"},
          {"sufficient_decrease", &CadouxNewtonOptions::sufficient_decrease, inside(0.0, 0.5), "-", "Armijo constant"},
          {"proximal", &CadouxNewtonOptions::proximal, inside(0.0, 1.0), "-", "alpha of the linear system"},
          {"max_rows", &CadouxNewtonOptions::max_rows, atLeast(1), "rows", "above them the method fails at once"},
          {"stall_window", &CadouxNewtonOptions::stall_window, atLeast(2), "iterations",
           "without the residual falling by a tenth before giving up"},
          {"inner", &CadouxNewtonOptions::inner, innerSolverNames(), "method of the inner convex problems"},
      });
  return table;
}

void CadouxNewtonOptions::validate() const
{
  table().validate(*this);
}

/** P' of every law, and the rows where it is not zero. */
void CadouxNewtonStep::activate(const DelassusProblem& problem, const SlipMap& map)
{
  const int blocks = problem.W.blocks();
  jacobian_.resize(static_cast<size_t>(blocks));
  position_.resize(static_cast<size_t>(problem.W.rows()));
  x_ = map.r();
  int active = 0;
  for (int i = 0; i < blocks; ++i)
  {
    const int row = problem.W.offset(i);
    const int d = problem.W.dimension(i);
    x_.segment(row, d) -= map.convexProblem().step_lengths[i] * map.shiftedVelocity().segment(row, d);
    SquareMatrix<3>& P = jacobian_[static_cast<size_t>(i)];
    P = projectionJacobian(problem.laws[static_cast<size_t>(i)], x_, row);
    const bool fixed = P.isZero(0.0);
    for (int k = row; k < row + d; ++k)
      position_[static_cast<size_t>(k)] = fixed ? -1 : active++;
  }
  active_ = active;
  right_.resize(problem.W.rows());
}

/** The rows of law i in (4.28): I - P' + rho P' (G W_i + alpha/rho), G = I + mu e u_T^T/F. */
template <int D>
void CadouxNewtonStep::fillRows(const DelassusProblem& problem, const SlipMap& map, int i,
                                Eigen::Map<Eigen::MatrixXd>& system)
{
  const int row = problem.W.offset(i);
  const int first = position_[static_cast<size_t>(row)];
  const SquareMatrix<D> P = jacobian_[static_cast<size_t>(i)].topLeftCorner<D, D>();
  const double mu = D > 1 ? problem.laws[static_cast<size_t>(i)].coefficient : 0.0;
  SquareMatrix<D> G = SquareMatrix<D>::Identity();
  for (int k = 1; k < D && speed_[i] > 0.0; ++k)
    G(0, k) = mu * map.u()[row + k] / speed_[i];
  const double rho = map.convexProblem().step_lengths[i];
  const SquareMatrix<D> A = rho * P * G;
  problem.W.visitRow(i,
                     [&](int column, const double* w, int stride)
                     {
                       const int target = position_[static_cast<size_t>(column)];
                       if (target < 0)
                         return;
                       Vector<D> w_column;
                       for (int k = 0; k < D; ++k)
                         w_column[k] = w[k * stride];
                       system.col(target).template segment<D>(first) = A * w_column;
                     });
  system.block<D, D>(first, first) += SquareMatrix<D>::Identity() - (1.0 - alpha_) * P;
  right_.segment<D>(first) = -rho * mu * gap_[i] * P.col(0);
}

/** F - s and F, a number for each law. */
void CadouxNewtonStep::setGaps(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s)
{
  gap_.setZero(problem.W.blocks());
  speed_.setZero(problem.W.blocks());
  for (int k = 0; k < map.size(); ++k)
  {
    gap_[map.contact(k)] = map.value()[k] - s[k];
    speed_[map.contact(k)] = map.value()[k];
  }
}

void CadouxNewtonStep::fill(const DelassusProblem& problem, const SlipMap& map, Eigen::Map<Eigen::MatrixXd>& system)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    if (position_[static_cast<size_t>(problem.W.offset(i))] < 0)
      continue;
    if (problem.W.dimension(i) == 3)
      fillRows<3>(problem, map, i, system);
    else if (problem.W.dimension(i) == 2)
      fillRows<2>(problem, map, i, system);
    else
      fillRows<1>(problem, map, i, system);
  }
}

bool CadouxNewtonStep::compute(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s,
                               double alpha, Eigen::VectorXd& ds)
{
  alpha_ = alpha;
  activate(problem, map);
  setGaps(problem, map, s);
  lu_.reserve(active_);
  Eigen::Map<Eigen::MatrixXd> system = lu_.start(active_);
  fill(problem, map, system);
  if (!lu_.factor())
    return false;
  lu_.solve(right_.head(active_));
  dr_.setZero(problem.W.rows());
  for (int row = 0; row < problem.W.rows(); ++row)
    if (position_[static_cast<size_t>(row)] >= 0)
      dr_[row] = right_[position_[static_cast<size_t>(row)]];
  // ds = F - s + S W dr
  problem.W.apply(dr_, du_);
  ds.resize(map.size());
  for (int k = 0; k < map.size(); ++k)
  {
    const int i = map.contact(k);
    const int row = problem.W.offset(i) + 1;
    const int tangents = problem.W.dimension(i) - 1;
    ds[k] = gap_[i];
    if (speed_[i] > 0.0)
      ds[k] += map.u().segment(row, tangents).dot(du_.segment(row, tangents)) / speed_[i];
  }
  return ds.allFinite();
}

bool CadouxNewtonStep::land(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s,
                            Eigen::VectorXd& r)
{
  if (problem.W.rows() > MOST_LANDING_ROWS || !isPlanar(problem))
    return false;
  alpha_ = 0.0;
  activate(problem, map);
  setGaps(problem, map, s);
  system_.setZero(active_, active_);
  Eigen::Map<Eigen::MatrixXd> system(system_.data(), active_, active_);
  fill(problem, map, system);
  r = map.r();
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int row = problem.W.offset(i);
    const int d = problem.W.dimension(i);
    const int first = position_[static_cast<size_t>(row)];
    const Law& law = problem.laws[static_cast<size_t>(i)];
    if (first < 0)
      r.segment(row, d).setZero();
    else if (d == 3)
      right_.segment<3>(first) -=
          map.r().segment<3>(row) - projectOntoCone<3>(Vector<3>(x_.segment<3>(row)), law.coefficient);
    else if (d == 2)
      right_.segment<2>(first) -=
          map.r().segment<2>(row) - projectOntoCone<2>(Vector<2>(x_.segment<2>(row)), law.coefficient);
    else
      right_[first] -= map.r()[row] - projectOntoLaw(law, x_[row]);
  }
  if (active_ == 0)  // everything parts; Eigen does not decompose nothing
    return r.allFinite();
  const Eigen::VectorXd dr = system_.completeOrthogonalDecomposition().solve(right_.head(active_));
  for (int row = 0; row < problem.W.rows(); ++row)
    if (position_[static_cast<size_t>(row)] >= 0)
      r[row] += dr[position_[static_cast<size_t>(row)]];
  return r.allFinite();
}

CadouxNewton::CadouxNewton(const CadouxNewtonOptions& options, std::unique_ptr<ConvexSolver> inner)
  : Solver("cadoux_newton")
  , options_(options)
  , map_(inner != nullptr ? std::move(inner) : createInnerSolver(options.inner))
{
  options_.validate();
}

void CadouxNewton::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  OuterLoop loop(context, result, options_.stall_window);
  if (problem.W.rows() > options_.max_rows)
  {
    loop.stop(SolverStatus::NUMERICAL_FAILURE, "");
    result.message = "the Newton system has up to " + std::to_string(problem.W.rows()) + " rows, the limit is " +
                     std::to_string(options_.max_rows);
    return;
  }
  map_.setProblem(problem, context);
  map_.setGuess(result.solution.r);
  s_ = map_.value();
  if (loop.record(context.residual(problem, map_.u(), map_.r()), map_.r()))
    return;
  ConvexBudget budget;
  budget.interrupted = [&context] { return context.spend(1.0); };  // a product an inner iteration
  const auto evaluate = [&](const Eigen::VectorXd& point)
  {
    map_.evaluate(point, loop.innerTolerance(options_.inner_accuracy, map_.size() > 0), budget);
    return 0.5 * (map_.value() - point).squaredNorm();
  };
  double merit = evaluate(s_);
  while (!loop.outOfBudget("Newton iterations exhausted"))
  {
    ++result.iterations;
    if (loop.record(context.residual(problem, map_.u(), map_.r()), map_.r()))
      return;
    if (newton_.land(problem, map_, s_, landed_))
    {
      problem.W.apply(landed_, landed_u_);
      landed_u_ += problem.q;
      const double residual = context.residual(problem, landed_u_, landed_);
      context.spend(SolveContext::factorization(problem, newton_.size()));
      // Elsewhere the piece is not the solution's, and the point worth nothing.
      if (residual <= context.tolerance && loop.record(residual, landed_))
        return;
    }
    const bool regular = newton_.compute(problem, map_, s_, options_.proximal, step_);
    context.spend(SolveContext::factorization(problem, newton_.size()));
    fixed_point_ = map_.value();
    double trial_merit = merit;
    bool accepted = false;
    double length = 1.0;
    for (int k = 0; k <= options_.line_search_steps && !accepted && regular; ++k, length *= 0.5)
    {
      trial_ = (s_ + length * step_).cwiseMax(0.0);
      trial_merit = evaluate(trial_);
      // Newton's slope of the merit is -2 merit.
      accepted = trial_merit <= (1.0 - 2.0 * options_.sufficient_decrease * length) * merit;
    }
    if (accepted)
      s_.swap(trial_);
    else
    {
      s_.swap(fixed_point_);
      trial_merit = evaluate(s_);
    }
    merit = trial_merit;
  }
}

}  // namespace frictional_contact_sim
