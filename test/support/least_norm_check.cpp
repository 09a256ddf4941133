#include "support/least_norm_check.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
/// Rows of s: first, count; their direction in r when the impulse stays on a ray.
struct Part
{
  const Law* law;
  int row, dimension, first, count;
  double root;
  Eigen::VectorXd ray;
};

/** Towards the cone in the plane of x: the ray at the angle atan(mu), unless x is steeper or behind. */
Eigen::VectorXd nearestInCone(const Eigen::VectorXd& x, double mu)
{
  const double size = x.size() == 3 ? std::hypot(x[1], x[2]) : std::abs(x[1]);
  const double angle = std::atan2(size, x[0]), edge = std::atan(mu);
  if (angle <= edge)
    return x;
  const double along = x.norm() * std::cos(angle - edge);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(x.size());
  if (along <= 0.0)
    return result;
  result[0] = along * std::cos(edge);
  if (size > 0.0)
    result.tail(x.size() - 1) = along * std::sin(edge) / size * x.tail(x.size() - 1);
  return result;
}

class Dual
{
public:
  Dual(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds, const Solution& solution);
  LeastNormBound climb(int steps);

private:
  void addPart(const Law& law, int row, double threshold, double root, const Solution& solution);
  double value(const Eigen::VectorXd& z);

  std::vector<Part> parts_;
  int rows_ = 0;
  Eigen::MatrixXd basis_;  ///< U: columns orthonormal, B = U diag V^T; z are coordinates in them
  Eigen::VectorXd star_, target_, s_, slope_;
  Eigen::VectorXd r_;
};

void Dual::addPart(const Law& law, int row, double threshold, double root, const Solution& solution)
{
  const int dimension = law.dimension();
  const auto u = solution.u.segment(row, dimension), r = solution.r.segment(row, dimension);
  Part part{&law, row, dimension, rows_, dimension, root, {}};
  if (law.isCoulomb())
  {
    if (u[0] > threshold)
      return;
    if (u.tail(dimension - 1).norm() > threshold && law.coefficient > 0.0)
    {
      if (r.norm() == 0.0)
        return;
      part.ray = r.normalized();
      part.count = 1;
    }
  }
  else if (law.type == LawType::UNILATERAL ? u[0] > threshold : std::abs(u[0]) > threshold)
    return;
  parts_.push_back(part);
  rows_ += part.count;
}

Dual::Dual(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds, const Solution& solution)
  : r_(solution.r)
{
  const Eigen::MatrixXd H(problem.H), M(problem.M), G(problem.G);
  int row = 0;
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    const int dimension = problem.laws[i].dimension();
    const Eigen::MatrixXd block = H.middleRows(row, dimension);
    const Eigen::MatrixXd W = block * M.ldlt().solve(block.transpose());
    const double largest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(W).eigenvalues().maxCoeff();
    if (largest > 0.0)
      addPart(problem.laws[i], row, thresholds[static_cast<Eigen::Index>(i)], std::sqrt(1.0 / largest), solution);
    row += dimension;
  }
  Eigen::MatrixXd B(rows_, problem.velocities());
  star_.resize(rows_);
  for (const Part& part : parts_)
  {
    const Eigen::MatrixXd block = part.root * H.middleRows(part.row, part.dimension);
    const Eigen::VectorXd impulse = solution.r.segment(part.row, part.dimension) / part.root;
    const bool ray = part.ray.size() > 0;
    B.middleRows(part.first, part.count) = ray ? Eigen::MatrixXd(part.ray.transpose() * block) : block;
    star_.segment(part.first, part.count) =
        ray ? Eigen::VectorXd(part.ray.transpose() * impulse) : Eigen::VectorXd(impulse);
  }
  // In the metric of M, so that ranks do not depend on units.
  const Eigen::LLT<Eigen::MatrixXd> mass(M);
  B = mass.matrixL().solve(B.transpose()).transpose().eval();
  if (G.rows() > 0)
  {
    const Eigen::MatrixXd A = mass.matrixL().solve(G.transpose());
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU);
    for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k)
      if (svd.singularValues()[k] > 1e-11 * svd.singularValues()[0])
        B -= B * svd.matrixU().col(k) * svd.matrixU().col(k).transpose();
  }
  if (rows_ == 0)
    return;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(B, Eigen::ComputeThinU);
  const Eigen::VectorXd& singular = svd.singularValues();
  Eigen::Index rank = 0;
  while (rank < singular.size() && singular[rank] > 1e-10 * singular[0])
    ++rank;
  basis_ = svd.matrixU().leftCols(rank);
  target_ = basis_.transpose() * star_;
}

double Dual::value(const Eigen::VectorXd& z)
{
  const Eigen::VectorXd t = basis_ * z;
  s_.resize(rows_);
  for (const Part& part : parts_)
  {
    const Law& law = *part.law;
    if (part.count > 1 || (law.isCoulomb() && part.ray.size() == 0))
      s_.segment(part.first, part.count) = nearestInCone(t.segment(part.first, part.count), law.coefficient);
    else if (law.type == LawType::DRY_FRICTION)
      s_[part.first] = std::min(std::max(t[part.first], -law.coefficient / part.root), law.coefficient / part.root);
    else
      s_[part.first] = std::max(t[part.first], 0.0);
  }
  slope_ = target_ - basis_.transpose() * s_;
  return 2.0 * target_.dot(z) - 2.0 * s_.dot(t) + s_.squaredNorm();
}

/** Nesterov's ascent with restarts; the Hessian is at most the identity. */
LeastNormBound Dual::climb(int steps)
{
  LeastNormBound result;
  result.sum = star_.squaredNorm();
  result.r = r_;
  if (rows_ == 0 || target_.norm() == 0.0)
    return result;
  Eigen::VectorXd z = target_, ahead = z, best = z;
  double momentum = 1.0;
  double top = value(z), last = top;
  for (int k = 0; k < steps; ++k)
  {
    value(ahead);
    const Eigen::VectorXd next = ahead + slope_;
    const double found = value(next);
    if (slope_.norm() <= 1e-14 * target_.norm())
      k = steps;
    const double grown = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum));
    const bool restart = found < last;
    ahead = restart ? next : Eigen::VectorXd(next + (momentum - 1.0) / grown * (next - z));
    momentum = restart ? 1.0 : grown;
    z = next;
    last = found;
    if (found >= top)
    {
      top = found;
      best = z;
    }
  }
  result.bound = std::max(0.0, value(best));
  result.gap = slope_.norm() / target_.norm();
  for (const Part& part : parts_)
  {
    const Eigen::VectorXd impulse = part.root * s_.segment(part.first, part.count);
    result.r.segment(part.row, part.dimension) = part.ray.size() > 0 ? Eigen::VectorXd(impulse[0] * part.ray) : impulse;
  }
  return result;
}
}  // namespace

LeastNormBound leastNormBound(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds,
                              const Solution& solution, int steps)
{
  return Dual(problem, thresholds, solution).climb(steps);
}

}  // namespace test_support
}  // namespace frictional_contact_sim
