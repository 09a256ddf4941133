#include "frictional_contact_sim/solver/one_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/problem/law_functions.h"

namespace frictional_contact_sim
{
namespace
{
/// det S below this share of trace^2: one tangential direction cannot move, and S is raised.
constexpr double SINGULAR = 1e-12;
/// The raise relative to the trace of W: a compromise between the error it makes and the noise it lets through.
constexpr double RAISE = 1e-12;
constexpr int MAX_ROOT_STEPS = 60;

/** The tangential problem after elimination of the normal one; (S + kappa I)^-1 = (adj S + kappa I) / det(S + kappa I).
 */
struct SlidingBranch
{
  Vector<2> b;  ///< right-hand side, r_T = -(S + kappa I)^-1 b
  Vector<2> adjoint_b;  ///< adj(S) b
  double trace, determinant;
  Vector<2> coupling;  ///< W_NT / W_NN
  double normal_0;  ///< -q_N / W_NN
  double mu;

  Vector<2> tangential(double kappa) const
  {
    return (adjoint_b + kappa * b) / -(determinant + kappa * (trace + kappa));
  }
  double normal(const Vector<2>& tangential) const { return normal_0 - coupling.dot(tangential); }
  /** h = mu r_N / |r_T| - 1 and its derivative. */
  double evaluate(double kappa, double& slope) const
  {
    const double inverse_determinant = 1.0 / (determinant + kappa * (trace + kappa));
    const Vector<2> t = (adjoint_b + kappa * b) * -inverse_determinant;
    const Vector<2> t_slope = -inverse_determinant * (b + (trace + 2.0 * kappa) * t);
    const double square = t.squaredNorm();
    const double inverse = 1.0 / std::sqrt(square);
    const double r_N = normal(t);
    slope = -mu * inverse * (coupling.dot(t_slope) + r_N * t.dot(t_slope) / square);
    return mu * r_N * inverse - 1.0;
  }
};

double slidingRoot(const SlidingBranch& branch)
{
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  double kappa = 0.0;
  double slope = 0.0;
  double value = branch.evaluate(kappa, slope);
  // A guess of the right size for the first jump, should the slope at zero be useless.
  const double size = std::max(branch.trace, branch.b.norm() / (branch.mu * branch.normal_0));
  for (int step = 0; step < MAX_ROOT_STEPS && value != 0.0; ++step)
  {
    (value < 0.0 ? low : high) = kappa;
    double next = kappa - value / slope;
    if (!(next > low) || !(next < high))
      next = std::isinf(high) ? 2.0 * low + size : 0.5 * (low + high);
    if (std::abs(next - kappa) <= 2.0 * std::numeric_limits<double>::epsilon() * next)
      return next;
    kappa = next;
    value = branch.evaluate(kappa, slope);
  }
  return kappa;
}
}  // namespace

Vector<3> solveCoulomb(const SquareMatrix<3>& W, const Vector<3>& q, double mu)
{
  if (q[0] >= 0.0)
    return Vector<3>::Zero();
  const double raise = RAISE * W.trace();
  const double W_NN = W(0, 0) > raise ? W(0, 0) : raise;
  if (!(W_NN > 0.0))
    return Vector<3>::Zero();
  const double normal_0 = -q[0] / W_NN;
  if (mu <= 0.0)
    return {normal_0, 0.0, 0.0};
  SlidingBranch branch;
  branch.normal_0 = normal_0;
  branch.mu = mu;
  branch.coupling = W.block<1, 2>(0, 1).transpose() / W_NN;
  SquareMatrix<2> S = W.block<2, 2>(1, 1) - W.block<2, 1>(1, 0) * branch.coupling.transpose();
  if (S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0) <= SINGULAR * S.trace() * S.trace())
    S.diagonal().array() += raise;
  branch.b = q.tail<2>() + W.block<2, 1>(1, 0) * normal_0;
  branch.trace = S.trace();
  branch.determinant = std::max(S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0), raise * raise);
  branch.adjoint_b = {S(1, 1) * branch.b[0] - S(0, 1) * branch.b[1], S(0, 0) * branch.b[1] - S(1, 0) * branch.b[0]};

  Vector<2> tangential = branch.tangential(0.0);
  double normal = branch.normal(tangential);
  if (normal < 0.0 || tangential.squaredNorm() > mu * mu * normal * normal)
  {
    tangential = branch.tangential(slidingRoot(branch));
    normal = tangential.norm() / mu;
  }
  return {normal, tangential[0], tangential[1]};
}

Vector<2> solveCoulomb(const SquareMatrix<2>& W, const Vector<2>& q, double mu)
{
  if (q[0] >= 0.0)
    return Vector<2>::Zero();
  const double raise = RAISE * W.trace();
  const double W_NN = W(0, 0) > raise ? W(0, 0) : raise;
  if (!(W_NN > 0.0))
    return Vector<2>::Zero();
  const double normal_0 = -q[0] / W_NN;
  const double coupling = W(0, 1);
  const double S = std::max(W(1, 1) - coupling * W(1, 0) / W_NN, raise);
  const double b = q[1] + W(1, 0) * normal_0;
  const double stick = -b / S;
  const double normal = normal_0 - coupling * stick / W_NN;
  if (std::abs(stick) <= mu * normal)
    return {normal, stick};
  // |r_T| - mu r_N is linear in |r_T|, negative at 0 and positive at the sticking value: the denominator is positive.
  const double sign = stick > 0.0 ? 1.0 : -1.0;
  const double slide = -q[0] / (W_NN + sign * mu * coupling);
  return {slide, sign * mu * slide};
}

double solveOneDimensional(const Law& law, double W, double q, double previous)
{
  if (!(std::abs(W) > 0.0))
    return projectOntoLaw(law, previous);
  return projectOntoLaw(law, -q / W);
}

}  // namespace frictional_contact_sim
