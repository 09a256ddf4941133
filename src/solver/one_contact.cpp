#include "frictional_contact_sim/solver/one_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/problem/law_functions.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double SINGULAR = 1e-14;
constexpr int MAX_ROOT_STEPS = 60;

/** The tangential problem after elimination of the normal one, in the eigenbasis of S. */
struct SlidingBranch
{
  double s1, s2;  ///< eigenvalues of S
  double b1, b2;  ///< components of b
  double w1, w2;  ///< components of W_NT
  double normal_0;  ///< -q_N / W_NN
  double W_NN, mu;

  /** h = mu r_N / |r_T| - 1 and its derivative. */
  double evaluate(double kappa, double& slope) const
  {
    const double d1 = 1.0 / (s1 + kappa);
    const double d2 = 1.0 / (s2 + kappa);
    const double t1 = -b1 * d1;
    const double t2 = -b2 * d2;
    const double square = t1 * t1 + t2 * t2;
    const double inverse = 1.0 / std::sqrt(square);
    const double normal = normal_0 - (w1 * t1 + w2 * t2) / W_NN;
    const double normal_slope = (w1 * t1 * d1 + w2 * t2 * d2) / W_NN;
    // d(1/|r_T|) = |r_T|^-3 (t1^2 d1 + t2^2 d2)
    const double inverse_slope = inverse / square * (t1 * t1 * d1 + t2 * t2 * d2);
    slope = mu * (normal_slope * inverse + normal * inverse_slope);
    return mu * normal * inverse - 1.0;
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
  const double size =
      std::max({branch.s1, branch.s2, std::hypot(branch.b1, branch.b2) / (branch.mu * branch.normal_0)});
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
  const double raise = SINGULAR * W.trace();
  const double W_NN = W(0, 0) + raise;
  if (!(W_NN > 0.0))
    return Vector<3>::Zero();
  const double normal_0 = -q[0] / W_NN;
  if (mu <= 0.0)
    return {normal_0, 0.0, 0.0};
  const double wn1 = 0.5 * (W(0, 1) + W(1, 0));
  const double wn2 = 0.5 * (W(0, 2) + W(2, 0));
  const double s11 = W(1, 1) + raise - wn1 * wn1 / W_NN;
  const double s22 = W(2, 2) + raise - wn2 * wn2 / W_NN;
  const double s12 = 0.5 * (W(1, 2) + W(2, 1)) - wn1 * wn2 / W_NN;
  const double b1 = q[1] + wn1 * normal_0;
  const double b2 = q[2] + wn2 * normal_0;
  // Eigenbasis of S: a Jacobi rotation.
  double cosine = 1.0;
  double sine = 0.0;
  if (s12 != 0.0)
  {
    const double theta = 0.5 * (s22 - s11) / s12;
    const double tangent = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(1.0 + theta * theta));
    cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
    sine = tangent * cosine;
  }
  SlidingBranch branch;
  branch.s1 = std::max(cosine * cosine * s11 - 2.0 * cosine * sine * s12 + sine * sine * s22, raise);
  branch.s2 = std::max(sine * sine * s11 + 2.0 * cosine * sine * s12 + cosine * cosine * s22, raise);
  branch.b1 = cosine * b1 - sine * b2;
  branch.b2 = sine * b1 + cosine * b2;
  branch.w1 = cosine * wn1 - sine * wn2;
  branch.w2 = sine * wn1 + cosine * wn2;
  branch.normal_0 = normal_0;
  branch.W_NN = W_NN;
  branch.mu = mu;

  double t1 = -branch.b1 / branch.s1;
  double t2 = -branch.b2 / branch.s2;
  double normal = normal_0 - (branch.w1 * t1 + branch.w2 * t2) / W_NN;
  if (t1 * t1 + t2 * t2 > mu * mu * normal * normal || normal < 0.0)
  {
    const double kappa = slidingRoot(branch);
    t1 = -branch.b1 / (branch.s1 + kappa);
    t2 = -branch.b2 / (branch.s2 + kappa);
    normal = std::sqrt(t1 * t1 + t2 * t2) / mu;
  }
  return {normal, cosine * t1 + sine * t2, -sine * t1 + cosine * t2};
}

Vector<2> solveCoulomb(const SquareMatrix<2>& W, const Vector<2>& q, double mu)
{
  if (q[0] >= 0.0)
    return Vector<2>::Zero();
  const double raise = SINGULAR * W.trace();
  const double W_NN = W(0, 0) + raise;
  if (!(W_NN > 0.0))
    return Vector<2>::Zero();
  const double normal_0 = -q[0] / W_NN;
  const double coupling = 0.5 * (W(0, 1) + W(1, 0));
  const double S = std::max(W(1, 1) + raise - coupling * coupling / W_NN, raise);
  const double b = q[1] + coupling * normal_0;
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
