#include "support/validator.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
using Eigen::MatrixXd;
using Eigen::VectorXd;

const double EPSILON = std::numeric_limits<double>::epsilon();

/** Nearest point of { |x_T| <= mu x_N }: by the nearest of its candidates (the point itself, the apex, the ray). */
VectorXd nearestInCone(const VectorXd& x, double mu)
{
  const VectorXd tangent = x.tail(x.size() - 1);
  const double length = tangent.norm();
  if (x[0] >= 0.0 && length <= mu * x[0])
    return x;
  VectorXd ray = VectorXd::Zero(x.size());
  ray[0] = 1.0;
  if (length > 0.0)
    ray.tail(x.size() - 1) = mu / length * tangent;
  const double along = std::max(0.0, ray.dot(x) / ray.dot(ray));
  return along * ray;
}

VectorXd lawError(const Law& law, const VectorXd& u, const VectorXd& r, double rho)
{
  VectorXd shifted = u;
  switch (law.type)
  {
    case LawType::COULOMB_3D:
    case LawType::COULOMB_2D:
      shifted[0] += law.coefficient * u.tail(u.size() - 1).norm();
      return (r - nearestInCone(r - rho * shifted, law.coefficient)) / rho;
    case LawType::UNILATERAL:
      return (r.array() - (r - rho * u).array().max(0.0)).matrix() / rho;
    case LawType::DRY_FRICTION:
      return (r.array() - (r - rho * u).array().min(law.coefficient).max(-law.coefficient)).matrix() / rho;
    case LawType::BILATERAL:
      break;
  }
  return u;
}

double largest(const VectorXd& x)
{
  return x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0.0;
}

/** Number of the island of each row's law: what W connects, by flooding. */
std::vector<int> floodIslands(const MatrixXd& W, const std::vector<int>& law_of_row, size_t laws)
{
  std::vector<int> island(laws, -1);
  int count = 0;
  for (size_t first = 0; first < laws; ++first)
  {
    if (island[first] >= 0)
      continue;
    std::vector<size_t> open = {first};
    island[first] = count;
    while (!open.empty())
    {
      const size_t law = open.back();
      open.pop_back();
      for (Eigen::Index i = 0; i < W.rows(); ++i)
        for (Eigen::Index j = 0; j < W.cols(); ++j)
        {
          const auto from = static_cast<size_t>(law_of_row[static_cast<size_t>(i)]);
          const auto to = static_cast<size_t>(law_of_row[static_cast<size_t>(j)]);
          if (from == law && (W(i, j) != 0.0 || W(j, i) != 0.0) && island[to] < 0)
          {
            island[to] = count;
            open.push_back(to);
          }
        }
    }
    ++count;
  }
  return island;
}

/** How much of q_row has to be undone: all of it, or only what is negative. */
double counted(const Law& law, const VectorXd& q, int row, int first)
{
  const bool may_part = law.type == LawType::UNILATERAL ||
                        ((law.type == LawType::COULOMB_3D || law.type == LawType::COULOMB_2D) && row == first);
  return may_part ? std::max(-q[row], 0.0) : std::abs(q[row]);
}

/** S of every law: of a bare problem where `given` is empty. q without the bilaterals. */
std::vector<double> velocityScales(const std::vector<Law>& laws, const std::vector<LawScale>& given, const MatrixXd& W,
                                   const VectorXd& q)
{
  std::vector<int> law_of_row;
  VectorXd size(q.size());
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const int first = static_cast<int>(law_of_row.size());
    for (int k = 0; k < laws[i].dimension(); ++k)
    {
      size[first + k] = counted(laws[i], q, first + k, first);
      law_of_row.push_back(static_cast<int>(i));
    }
  }
  const std::vector<int> island = floodIslands(W, law_of_row, laws.size());
  std::vector<double> scales;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    double own = 0.0, floor = given.empty() ? 1e-6 * largest(size) : 0.0;
    for (size_t row = 0; row < law_of_row.size(); ++row)
    {
      const auto j = static_cast<size_t>(law_of_row[row]);
      if (island[j] != island[i])
        continue;
      if (given.empty() || given[j].unit == given[i].unit)
        own = std::max(own, size[static_cast<Eigen::Index>(row)]);
      if (!given.empty())
        floor = std::max(floor, given[j].speed_change);
    }
    scales.push_back(std::max(own, std::max(floor, 1e-12) / (given.empty() ? 1.0 : given[i].reach)));
  }
  return scales;
}

/** W_free, q_free: without bilaterals, what rho and S are made of; W says the islands. `terms`: what u was summed from.
 */
void judgeLaws(const std::vector<Law>& laws, const std::vector<LawScale>& given, const MatrixXd& W,
               const MatrixXd& W_free, const VectorXd& q_free, const VectorXd& u, const VectorXd& r,
               const VectorXd& terms, Verdict& verdict)
{
  std::vector<double> lambda;
  int row = 0;
  for (const Law& law : laws)
  {
    const int d = law.dimension();
    const MatrixXd block = 0.5 * (W_free.block(row, row, d, d) + W_free.block(row, row, d, d).transpose());
    lambda.push_back(d == 1
                         ? std::abs(block(0, 0))
                         : Eigen::SelfAdjointEigenSolver<MatrixXd>(block, Eigen::EigenvaluesOnly).eigenvalues()[d - 1]);
    row += d;
  }
  const double biggest = lambda.empty() ? 0.0 : *std::max_element(lambda.begin(), lambda.end());
  const std::vector<double> scales = velocityScales(laws, given, W, q_free);
  row = 0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const int d = laws[i].dimension();
    const double rho = 1.0 / (lambda[i] > 0.0 ? lambda[i] : biggest > 0.0 ? biggest : 1.0);
    double error = lawError(laws[i], u.segment(row, d), r.segment(row, d), rho).norm();
    const double known = given.empty() ? largest(terms.segment(row, d)) : given[i].speed / given[i].reach;
    if (error <= 64.0 * EPSILON * known)
      error = 0.0;
    verdict.law = std::max(verdict.law, std::max(error, EPSILON * r.segment(row, d).norm() / rho) / scales[i]);
    row += d;
  }
}
}  // namespace

double Verdict::worst() const
{
  return std::max({law, dynamics, bilateral});
}

Verdict validateAnswer(const IncrementalProblem& problem, const VectorXd& v, const VectorXd& r, const VectorXd& lambda)
{
  const MatrixXd M = problem.M, H = problem.H, G = problem.G;
  const Eigen::PartialPivLU<MatrixXd> lu(M);
  Verdict verdict;
  const VectorXd free = lu.solve(problem.f);
  VectorXd q = problem.w, u = problem.w, terms = problem.w.cwiseAbs();
  MatrixXd W(q.size(), q.size()), constrained;
  VectorXd contact = VectorXd::Zero(v.size()), joint = VectorXd::Zero(v.size());
  if (q.size() > 0)
  {
    q -= H * free;
    u += H * v;
    terms = terms.cwiseMax((H * v.asDiagonal()).cwiseAbs().rowwise().maxCoeff());
    W = H * lu.solve(MatrixXd(H.transpose()));
    constrained = W;
    contact = H.transpose() * r;
  }
  if (problem.b.size() > 0)
  {
    joint = G.transpose() * lambda;
    // Bilaterals connect what they touch, whatever they leave of W.
    if (q.size() > 0)
    {
      const MatrixXd reach = H * lu.solve(MatrixXd(G.transpose()));
      const MatrixXd loops = G * lu.solve(MatrixXd(G.transpose()));
      constrained -= reach * loops.completeOrthogonalDecomposition().solve(reach.transpose());
      const double noise = 1e-13 * W.cwiseAbs().maxCoeff();
      constrained = (constrained.array().abs() > noise).select(constrained, 0.0);
    }
  }
  judgeLaws(problem.laws, problem.scales, constrained, W, q, u, r, terms, verdict);
  const VectorXd momentum = M * v;
  const double scale = std::max({largest(momentum), largest(problem.f), largest(contact), largest(joint)});
  const double defect = largest(momentum + problem.f - contact - joint);
  verdict.dynamics = scale > 0.0 ? defect / scale : 0.0;
  if (problem.b.size() > 0)
  {
    const double size = std::max({largest(problem.b), (G * v.asDiagonal()).cwiseAbs().maxCoeff(),
                                  (G * free.asDiagonal()).cwiseAbs().maxCoeff()});
    const VectorXd errors = (G * v + problem.b).cwiseAbs();
    for (Eigen::Index k = 0; k < errors.size(); ++k)
    {
      double scale = size > 0.0 ? size : 1.0, known = 0.0;
      if (!problem.bilateral_scales.empty())
      {
        const LawScale& given = problem.bilateral_scales[static_cast<size_t>(k)];
        scale = std::max(size, given.speed_change / given.reach);
        known = 64.0 * EPSILON * given.speed / given.reach;
      }
      if (errors[k] > known)
        verdict.bilateral = std::max(verdict.bilateral, errors[k] / scale);
    }
  }
  return verdict;
}

Verdict validateAnswer(const DelassusProblem& problem, const VectorXd& r)
{
  const MatrixXd W = problem.W.toDense();
  Verdict verdict;
  if (r.size() > 0)
    judgeLaws(problem.laws, problem.scales, W, W, problem.q, W * r + problem.q, r, VectorXd::Zero(r.size()), verdict);
  return verdict;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
