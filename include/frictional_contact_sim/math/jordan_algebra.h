#pragma once
/**
 * @file jordan_algebra.h
 * @brief Jordan algebra of the Lorentz cone K = { x = (x_N, x_T) : |x_T| <= x_N } and the Fischer-Burmeister function.
 *
 *   x o y     = (x . y, x_N y_T + y_N x_T) = L(x) y,   L(x) = [ x_N x_T' ; x_T x_N I ] (arrow matrix), unit e = (1, 0)
 *   x         = lambda_1 c_1 + lambda_2 c_2,  lambda_1,2 = x_N -/+ |x_T|,  c_1,2 = (1, -/+ x_T/|x_T|)/2
 *   x^(1/2)   = lambda_1^(1/2) c_1 + lambda_2^(1/2) c_2
 *   phi(x, y) = x + y - s,  s = (x o x + y o y + alpha^2 e)^(1/2)                    (4.11); alpha > 0: smoothed
 *   dphi/dx   = I - L(s)^-1 L(x),  dphi/dy = I - L(s)^-1 L(y)
 *
 * Fixed size D = 2 or 3, no allocation. phi = 0 with alpha = 0 exactly when x and y are in K and x . y = 0.
 *
 * The eigenvalues of w = x o x + y o y are sums of squares, with s_T/|s_T| = t and P the projection orthogonal to t:
 *   lambda_1,2(w) = (x_N -/+ t.x_T)^2 + |P x_T|^2 + (y_N -/+ t.y_T)^2 + |P y_T|^2,
 * computed so, nothing cancels (the textbook difference loses half of the digits near the boundary), and the rows of
 * L(s)^-1 L(x) stay bounded by one. Where lambda_1(w) = 0 phi is not differentiable; the Jacobians are then the limit
 * along (x + t e, y + t e), t -> 0+, an element of the B-subdifferential.
 *
 * Source: Cadoux (2009), (4.11); Fukushima, Luo, Tseng (2002), "Smoothing functions for second-order-cone
 * complementarity problems"; Pan, Chen (2009), "A damped Gauss-Newton method for the second-order cone complementarity
 * problem", for the B-subdifferential. Departure: the eigenvalues without cancellation.
 */
#include <cmath>

#include "frictional_contact_sim/math/cone.h"

namespace frictional_contact_sim
{
/** @brief x o y. */
template <int D>
inline Vector<D> jordanProduct(const Vector<D>& x, const Vector<D>& y)
{
  Vector<D> z;
  z[0] = x.dot(y);
  z.template tail<D - 1>() = x[0] * y.template tail<D - 1>() + y[0] * x.template tail<D - 1>();
  return z;
}

/** @brief L(x), with L(x) y = x o y. */
template <int D>
inline SquareMatrix<D> arrowMatrix(const Vector<D>& x)
{
  SquareMatrix<D> L = x[0] * SquareMatrix<D>::Identity();
  L.template block<1, D - 1>(0, 1) = x.template tail<D - 1>().transpose();
  L.template block<D - 1, 1>(1, 0) = x.template tail<D - 1>();
  return L;
}

/** @brief x = lambda_1 c_1 + lambda_2 c_2 with c_1,2 = (1, -/+ axis)/2; the first tangent where x_T = 0. */
template <int D>
struct SpectralDecomposition
{
  double smallest = 0.0;  ///< lambda_1
  double largest = 0.0;  ///< lambda_2
  Vector<D - 1> axis = Vector<D - 1>::Unit(0);  ///< x_T/|x_T|

  Vector<D> compose(double first, double second) const
  {
    Vector<D> x;
    x[0] = 0.5 * (first + second);
    x.template tail<D - 1>() = 0.5 * (second - first) * axis;
    return x;
  }
};

template <int D>
inline SpectralDecomposition<D> spectralDecomposition(const Vector<D>& x)
{
  SpectralDecomposition<D> spectrum;
  const double tangential = x.template tail<D - 1>().stableNorm();
  if (tangential > 0.0)
    spectrum.axis = x.template tail<D - 1>() / tangential;
  spectrum.smallest = x[0] - tangential;
  spectrum.largest = x[0] + tangential;
  return spectrum;
}

/** @brief The element of K whose square is x; x in K (an eigenvalue below zero by round-off counts as zero). */
template <int D>
inline Vector<D> jordanSquareRoot(const Vector<D>& x)
{
  const SpectralDecomposition<D> spectrum = spectralDecomposition<D>(x);
  return spectrum.compose(std::sqrt(std::fmax(spectrum.smallest, 0.0)), std::sqrt(std::fmax(spectrum.largest, 0.0)));
}

/** @brief phi(x, y) with an element of its B-subdifferential. */
template <int D>
struct FischerBurmeister
{
  Vector<D> value;
  SquareMatrix<D> by_x;
  SquareMatrix<D> by_y;
};

namespace fischer_burmeister_detail
{
/// a + b - root with root^2 = a^2 + b^2 + rest, without cancellation when a + b > 0.
inline double difference(double a, double b, double rest, double root)
{
  const double sum = a + b;
  return sum > 0.0 ? (2.0 * a * b - rest) / (sum + root) : sum - root;
}

/// c . L(x) / sigma for both eigenvectors and the part across them, assembled into L(s)^-1 L(x).
template <int D>
inline SquareMatrix<D> quotient(const Vector<D>& x, const Vector<D - 1>& axis, double sigma_1, double sigma_2)
{
  constexpr int T = D - 1;
  // Below this ratio sigma_1 is the round-off of a zero, and the quotients by it would be noise.
  constexpr double KINK = 1e-15;
  constexpr double HALF_ROOT = 0.70710678118654752440;
  const double along = axis.dot(x.template tail<T>());
  const Vector<T> across = x.template tail<T>() - along * axis;
  SquareMatrix<D> result = SquareMatrix<D>::Zero();
  for (const double sign : {-1.0, 1.0})
  {
    const double sigma = sign < 0.0 ? sigma_1 : sigma_2;
    const double eigenvalue = x[0] + sign * along;
    Vector<D> direction, row;  // 2 c, and c' L(x) / sigma
    direction << 1.0, sign * axis;
    if (sigma > KINK * sigma_2)
      row << 0.5 * eigenvalue / sigma, (0.5 * sign * eigenvalue / sigma) * axis + (0.5 / sigma) * across;
    else
      row << 0.5 * HALF_ROOT, (0.5 * sign * HALF_ROOT) * axis;
    result += direction * row.transpose();
  }
  if (T > 1)
  {
    // Directions orthogonal to the axis: eigenvalue (sigma_1 + sigma_2)/2 of L(s), 1/sqrt(2) of x where both vanish.
    const double mean = 0.5 * (sigma_1 + sigma_2);
    const SquareMatrix<T> projection = SquareMatrix<T>::Identity() - axis * axis.transpose();
    if (mean > 0.0)
    {
      result.template block<T, 1>(1, 0) += across / mean;
      result.template block<T, T>(1, 1) += (x[0] / mean) * projection;
    }
    else
      result.template block<T, T>(1, 1) += HALF_ROOT * projection;
  }
  return result;
}
}  // namespace fischer_burmeister_detail

/**
 * @brief phi(x, y), and its Jacobians when asked for.
 * @param smoothing alpha >= 0, in the unit of x and y
 */
template <int D>
inline FischerBurmeister<D> fischerBurmeister(const Vector<D>& x, const Vector<D>& y, double smoothing, bool jacobians)
{
  constexpr int T = D - 1;
  const Vector<T> tangential = x[0] * x.template tail<T>() + y[0] * y.template tail<T>();
  const double norm = tangential.norm();
  // Where w_T = 0 both eigenvalues are equal and any axis will do.
  const Vector<T> axis = norm > 0.0 ? Vector<T>(tangential / norm) : Vector<T>(Vector<T>::Unit(0));
  const double x_along = axis.dot(x.template tail<T>());
  const double y_along = axis.dot(y.template tail<T>());
  const Vector<T> x_across = x.template tail<T>() - x_along * axis;
  const Vector<T> y_across = y.template tail<T>() - y_along * axis;
  const double across = x_across.squaredNorm() + y_across.squaredNorm() + smoothing * smoothing;
  const double x_small = x[0] - x_along, y_small = y[0] - y_along;
  const double x_large = x[0] + x_along, y_large = y[0] + y_along;
  const double sigma_1 = std::sqrt(x_small * x_small + y_small * y_small + across);
  const double sigma_2 = std::sqrt(x_large * x_large + y_large * y_large + across);
  FischerBurmeister<D> result;
  const double small = fischer_burmeister_detail::difference(x_small, y_small, across, sigma_1);
  const double large = fischer_burmeister_detail::difference(x_large, y_large, across, sigma_2);
  result.value[0] = 0.5 * (small + large);
  result.value.template tail<T>() = x_across + y_across + (0.5 * (large - small)) * axis;
  if (!jacobians)
    return result;
  result.by_x = SquareMatrix<D>::Identity() - fischer_burmeister_detail::quotient<D>(x, axis, sigma_1, sigma_2);
  result.by_y = SquareMatrix<D>::Identity() - fischer_burmeister_detail::quotient<D>(y, axis, sigma_1, sigma_2);
  return result;
}

/** @brief The scalar function a + b - (a^2 + b^2 + alpha^2)^(1/2) with its derivatives (1 - 1/sqrt 2 at the origin). */
struct ScalarFischerBurmeister
{
  double value;
  double by_a;
  double by_b;
};

inline ScalarFischerBurmeister fischerBurmeister(double a, double b, double smoothing)
{
  const double root = std::hypot(std::hypot(a, b), smoothing);
  const double value = fischer_burmeister_detail::difference(a, b, smoothing * smoothing, root);
  if (root > 0.0)
    return {value, 1.0 - a / root, 1.0 - b / root};
  constexpr double KINK = 1.0 - 0.70710678118654752440;
  return {value, KINK, KINK};
}

}  // namespace frictional_contact_sim
