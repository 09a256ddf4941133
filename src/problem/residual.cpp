#include "frictional_contact_sim/problem/residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/law_functions.h"

namespace frictional_contact_sim
{
namespace
{
double blockEigenvalue(const DelassusOperator& W, int block)
{
  if (W.dimension(block) == 3)
    return largestEigenvalue(W.diagonalBlock<3>(block));
  if (W.dimension(block) == 2)
    return largestEigenvalue(W.diagonalBlock<2>(block));
  return std::abs(W.diagonalBlock<1>(block)(0, 0));
}

/** Of a bare problem: what is lost in forming u = H v + w. */
void setRoundOff(const IncrementalProblem& problem, const Eigen::VectorXd& v, Eigen::VectorXd& round_off)
{
  int row = 0;
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    double largest = 0.0;
    for (const int end = row + problem.laws[i].dimension(); row < end; ++row)
    {
      largest = std::max(largest, std::abs(problem.w[row]));
      for (SparseRows::InnerIterator entry(problem.H, row); entry; ++entry)
        largest = std::max(largest, std::abs(entry.value() * v[entry.col()]));
    }
    round_off[static_cast<Eigen::Index>(i)] =
        ResidualMetric::ROUND_OFF * std::numeric_limits<double>::epsilon() * largest;
  }
}

/** Largest term of a row of G with the velocities that M couples its own with: none of them is known better than their
 * round-off. */
double coupledVelocity(const IncrementalProblem& problem, int row, const Eigen::VectorXd& v)
{
  double largest = 0.0;
  for (SparseRows::InnerIterator entry(problem.G, row); entry; ++entry)
    for (SparseRows::InnerIterator coupled(problem.M, entry.col()); coupled; ++coupled)
      largest = std::max(largest, std::abs(entry.value() * v[coupled.col()]));
  return largest;
}

/** |G v + b| of a row relative to the largest term of all of them and to what the row is scaled with. */
double bilateralResidual(const IncrementalProblem& problem, const Eigen::VectorXd& mass_inverse_force,
                         const Eigen::VectorXd& v)
{
  double largest = std::max(maxAbs(problem.b), VELOCITY_FLOOR);
  for (int row = 0; row < problem.bilaterals(); ++row)
    for (SparseRows::InnerIterator entry(problem.G, row); entry; ++entry)
      largest = std::max({largest, std::abs(entry.value() * v[entry.col()]),
                          std::abs(entry.value() * mass_inverse_force[entry.col()])});
  double worst = 0.0;
  for (int row = 0; row < problem.bilaterals(); ++row)
  {
    double sum = problem.b[row];
    for (SparseRows::InnerIterator entry(problem.G, row); entry; ++entry)
      sum += entry.value() * v[entry.col()];
    double error = std::abs(sum);
    double scale = largest;
    if (!problem.bilateral_scales.empty())
    {
      const LawScale& given = problem.bilateral_scales[static_cast<size_t>(row)];
      scale = std::max(scale, given.speed_change / given.reach);
      const double known = std::max(given.speed / given.reach, coupledVelocity(problem, row, v));
      if (error <= ResidualMetric::ROUND_OFF * std::numeric_limits<double>::epsilon() * known)
        error = 0.0;
    }
    error /= scale;
    if (!(error <= worst) && !std::isnan(worst))
      worst = error;
  }
  return worst;
}
}  // namespace

void computeStepLengths(const DelassusProblem& problem, Eigen::VectorXd& step_lengths)
{
  computeStepLengths(problem.W, step_lengths);
}

void computeStepLengths(const DelassusOperator& W, Eigen::VectorXd& step_lengths)
{
  const int count = W.blocks();
  step_lengths.resize(count);
  double largest = 0.0;
  for (int i = 0; i < count; ++i)
  {
    step_lengths[i] = blockEigenvalue(W, i);
    largest = std::max(largest, step_lengths[i]);
  }
  for (int i = 0; i < count; ++i)
    if (step_lengths[i] > 0.0)
      step_lengths[i] = 1.0 / step_lengths[i];
    else
      step_lengths[i] = largest > 0.0 ? 1.0 / largest : 1.0;
}

double lawResidual(const std::vector<Law>& laws, const ResidualMetric& metric, const Eigen::VectorXd& u,
                   const Eigen::VectorXd& r, Eigen::VectorXd* errors, Eigen::VectorXd* residuals)
{
  for (Eigen::VectorXd* values : {errors, residuals})
    if (values != nullptr)
      values->resize(static_cast<Eigen::Index>(laws.size()));
  double worst = 0.0;
  int row = 0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const auto index = static_cast<Eigen::Index>(i);
    const int dimension = laws[i].dimension();
    const double step_length = metric.step_lengths[index];
    const double raw = naturalMapError(laws[i], u.data() + row, r.data() + row, step_length);
    double error = raw <= metric.round_off[index] ? 0.0 : raw;
    if (errors != nullptr)
      (*errors)[index] = error;
    double square = 0.0;
    for (int k = row; k < row + dimension; ++k)
      square += r[k] * r[k];
    if (square > 0.0)
      error = std::max(error, std::numeric_limits<double>::epsilon() * std::sqrt(square) / step_length);
    error /= metric.scales[index];
    if (residuals != nullptr)
      (*residuals)[index] = error;
    // Written so that a NaN becomes the worst error instead of disappearing in a comparison.
    if (!(error <= worst) && !std::isnan(worst))
      worst = error;
    row += dimension;
  }
  return worst;
}

ResidualMetric makeMetric(const DelassusProblem& problem)
{
  ResidualMetric metric;
  Islands islands;
  islands.find(problem.W);
  computeStepLengths(problem, metric.step_lengths);
  metric.setScales(problem.laws, problem.scales, problem.q, islands);
  return metric;
}

double localResidual(const DelassusProblem& problem, const ResidualMetric& metric, const Eigen::VectorXd& r,
                     Eigen::VectorXd& u)
{
  problem.W.apply(r, u);
  u += problem.q;
  return lawResidual(problem.laws, metric, u, r);
}

double GlobalResidual::value() const
{
  double worst = law;
  for (const double part : {dynamics, bilateral})
    if (!(part <= worst) && !std::isnan(worst))
      worst = part;
  return worst;
}

void setMetric(const IncrementalProblem& problem, const DelassusReduction& reduction, const Islands& islands,
               GlobalResidualData& data)
{
  data.metric.step_lengths = reduction.stepLengths();
  data.metric.setScales(problem.laws, problem.scales, reduction.freeVelocity(), islands);
  data.mass_inverse_force = reduction.massInverseForce();
}

GlobalResidual globalResidual(const IncrementalProblem& problem, GlobalResidualData& data, Solution& solution)
{
  GlobalResidual residual;
  solution.u.resize(problem.rows());
  solution.u.noalias() = problem.H * solution.v;
  solution.u += problem.w;
  if (problem.scales.empty())
    setRoundOff(problem, solution.v, data.metric.round_off);
  residual.law = lawResidual(problem.laws, data.metric, solution.u, solution.r);

  data.momentum.resize(problem.velocities());
  data.term.resize(problem.velocities());
  data.momentum.noalias() = problem.M * solution.v;
  // The floor of velocities, times the largest mass: below it a decaying motion is only subnormal round-off.
  // Of a positive definite M the largest entry is one of the diagonal.
  const Eigen::Map<const Eigen::VectorXd> entries(problem.M.valuePtr(), problem.M.nonZeros());
  const double heaviest = entries.size() > 0 ? std::max(0.0, entries.maxCoeff()) : 0.0;
  double scale = std::max({maxAbs(data.momentum), maxAbs(problem.f), VELOCITY_FLOOR * heaviest});
  data.momentum += problem.f;
  data.term.noalias() = problem.H.transpose() * solution.r;
  scale = std::max(scale, maxAbs(data.term));
  data.momentum -= data.term;
  if (problem.bilaterals() > 0)
  {
    data.term.noalias() = problem.G.transpose() * solution.lambda;
    scale = std::max(scale, maxAbs(data.term));
    data.momentum -= data.term;
  }
  residual.dynamics = scale > 0.0 ? maxAbs(data.momentum) / scale : 0.0;

  residual.bilateral = bilateralResidual(problem, data.mass_inverse_force, solution.v);
  return residual;
}

double evaluateResidual(const DelassusProblem& problem, const Eigen::VectorXd& r)
{
  Eigen::VectorXd u;
  return localResidual(problem, makeMetric(problem), r, u);
}

GlobalResidual evaluateResidual(const IncrementalProblem& problem, const Solution& solution)
{
  DelassusReduction reduction;
  reduction.compute(problem);
  Islands islands;
  islands.find(reduction.problem().W);
  GlobalResidualData data;
  setMetric(problem, reduction, islands, data);
  Solution copy = solution;
  return globalResidual(problem, data, copy);
}

Diagnostics diagnose(const std::vector<Law>& laws, const Eigen::VectorXd& q, const Eigen::VectorXd& u,
                     const Eigen::VectorXd& r)
{
  Diagnostics result;
  double squares = 0.0;
  int row = 0;
  for (const Law& law : laws)
  {
    const int dimension = law.dimension();
    const double error = naturalMapError(law, u.data() + row, r.data() + row, 1.0);
    squares += error * error;
    Eigen::Vector3d projected = Eigen::Vector3d::Zero();
    projected.head(dimension) = r.segment(row, dimension);
    projectImpulse(law, projected.data());
    result.cone_violation =
        std::max(result.cone_violation, (r.segment(row, dimension) - projected.head(dimension)).norm());
    if (law.isOneSided())
    {
      result.negative_velocity = std::max(result.negative_velocity, -u[row]);
      result.complementarity = std::max(result.complementarity, std::abs(u[row] * r[row]));
    }
    if (law.isCoulomb())
    {
      const auto velocity = u.segment(row + 1, dimension - 1);
      const auto impulse = r.segment(row + 1, dimension - 1);
      result.maximum_dissipation =
          std::max(result.maximum_dissipation, std::abs(impulse.norm() * velocity.norm() + impulse.dot(velocity)));
    }
    row += dimension;
  }
  const double error = std::sqrt(squares);
  const double scale = std::max({q.norm(), r.norm(), u.norm()});
  result.siconos_error = scale > 0.0 ? error / scale : 0.0;
  result.natural_map_1q = error / (1.0 + q.norm());
  return result;
}

}  // namespace frictional_contact_sim
