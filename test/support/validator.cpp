#include "support/validator.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

void judgeLaws(const std::vector<Law>& laws, const MatrixXd& W, const VectorXd& q, const VectorXd& u, const VectorXd& r,
               Verdict& verdict)
{
  std::vector<double> lambda;
  int row = 0;
  for (const Law& law : laws)
  {
    const int d = law.dimension();
    const MatrixXd block = 0.5 * (W.block(row, row, d, d) + W.block(row, row, d, d).transpose());
    lambda.push_back(d == 1
                         ? std::abs(block(0, 0))
                         : Eigen::SelfAdjointEigenSolver<MatrixXd>(block, Eigen::EigenvaluesOnly).eigenvalues()[d - 1]);
    row += d;
  }
  const double biggest = lambda.empty() ? 0.0 : *std::max_element(lambda.begin(), lambda.end());
  double worst = 0.0, impulse = 0.0;
  const double velocity = std::max({largest(q), largest(u), 1e-12});
  row = 0;
  for (size_t i = 0; i < laws.size(); ++i)
  {
    const int d = laws[i].dimension();
    const double rho = 1.0 / (lambda[i] > 0.0 ? lambda[i] : biggest > 0.0 ? biggest : 1.0);
    worst = std::max(worst, lawError(laws[i], u.segment(row, d), r.segment(row, d), rho).norm());
    impulse = std::max(impulse, r.segment(row, d).norm() / rho);
    row += d;
  }
  verdict.law = worst / std::max(velocity, impulse);
  verdict.runaway = impulse / velocity;
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
  VectorXd q = problem.w, u = problem.w;
  MatrixXd W(q.size(), q.size());
  VectorXd contact = VectorXd::Zero(v.size()), joint = VectorXd::Zero(v.size());
  if (q.size() > 0)
  {
    q -= H * free;
    u += H * v;
    W = H * lu.solve(MatrixXd(H.transpose()));
    contact = H.transpose() * r;
  }
  if (problem.b.size() > 0)
    joint = G.transpose() * lambda;
  judgeLaws(problem.laws, W, q, u, r, verdict);
  const VectorXd momentum = M * v;
  const double scale = std::max({largest(momentum), largest(problem.f), largest(contact), largest(joint)});
  const double defect = largest(momentum + problem.f - contact - joint);
  verdict.dynamics = scale > 0.0 ? defect / scale : 0.0;
  if (problem.b.size() > 0)
  {
    const double size = std::max({largest(problem.b), (G * v.asDiagonal()).cwiseAbs().maxCoeff(),
                                  (G * free.asDiagonal()).cwiseAbs().maxCoeff()});
    verdict.bilateral = largest(G * v + problem.b) / (size > 0.0 ? size : 1.0);
  }
  return verdict;
}

Verdict validateAnswer(const DelassusProblem& problem, const VectorXd& r)
{
  const MatrixXd W = problem.W.toDense();
  Verdict verdict;
  if (r.size() > 0)
    judgeLaws(problem.laws, W, problem.q, W * r + problem.q, r, verdict);
  return verdict;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
