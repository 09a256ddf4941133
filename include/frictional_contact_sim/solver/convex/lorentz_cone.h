#pragma once
/**
 * @file lorentz_cone.h
 * @brief Second-order cones Q = { x : |x_1..| <= x_0 } of dimension d = 1, 2, 3 with Nesterov-Todd scaling.
 *
 *   Jordan product   x o y = (x.y, x_0 y_T + y_0 x_T),   identity e = (1, 0),   J = diag(1, -1, ..)
 *   scaling          an automorphism N of the cone with  N^-1 x = N^T z = lambda;   N^-1 = J N^T J / beta^2
 *   of one pair      N = beta [w_0, w_T^T; w_T, I + w_T w_T^T/(1 + w_0)],  w = (x' + J z')/(2 gamma),
 *                    x' = x/|x|_J, z' = z/|z|_J, gamma^2 = (1 + x'.z')/2, beta^2 = |x|_J/|z|_J, |x|_J^2 = x^T J x
 * After a step the new pair is scaled in the coordinates of lambda, where nothing cancels, and the factors are
 * multiplied: N <- N N'. That is what keeps digits when x and z approach the boundary; as 3 x 3 numbers N and N^-1 end
 * near |w| = 1e8, that is for slip speeds and impulses together 16 digits above the complementarity m.
 *
 * d = 1 is the half-line. Source: Nesterov, Todd (1997); Vandenberghe (2010), "The CVXOPT linear and quadratic cone
 * program solvers", sections 4 and 6.
 */
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/math/cone.h"

namespace frictional_contact_sim
{
/** @brief A pair scaled by Nesterov and Todd; all vectors have 3 entries, those beyond the dimension are zero. */
struct LorentzScaling
{
  SquareMatrix<3> forward = SquareMatrix<3>::Identity();  ///< N
  SquareMatrix<3> inverse = SquareMatrix<3>::Identity();  ///< N^-1
  double square = 1.0;  ///< beta^2, kept apart: from N it would be a difference of large numbers
  Vector<3> lambda = Vector<3>(1.0, 0.0, 0.0);

  Vector<3> x() const { return forward * lambda; }
  Vector<3> z() const { return inverse.transpose() * lambda; }
};

/** @brief (x_0 - |x_T|)(x_0 + |x_T|) */
inline double lorentzDeterminant(const Vector<3>& x)
{
  const double tangential = std::hypot(x[1], x[2]);
  return (x[0] - tangential) * (x[0] + tangential);
}

inline Vector<3> jordanProduct(const Vector<3>& x, const Vector<3>& y)
{
  Vector<3> result;
  result[0] = x.dot(y);
  result.tail<2>() = x[0] * y.tail<2>() + y[0] * x.tail<2>();
  return result;
}

/** @brief The y with lambda o y = b. */
inline Vector<3> jordanDivide(const Vector<3>& lambda, const Vector<3>& b)
{
  Vector<3> y;
  y[0] = (lambda[0] * b[0] - lambda.tail<2>().dot(b.tail<2>())) / lorentzDeterminant(lambda);
  y.tail<2>() = (b.tail<2>() - y[0] * lambda.tail<2>()) / lambda[0];
  return y;
}

/** @brief Largest t with x + t d in the cone, x inside; infinity when there is none. */
inline double lorentzStep(const Vector<3>& x, const Vector<3>& d)
{
  const double norm = std::sqrt(lorentzDeterminant(x));
  const Vector<3> unit = x / norm;
  const double head = unit[0] * d[0] - unit.tail<2>().dot(d.tail<2>());
  const Vector<2> tail = d.tail<2>() - ((head + d[0]) / (unit[0] + 1.0)) * unit.tail<2>();
  const double rate = (tail.norm() - head) / norm;
  return rate > 0.0 ? 1.0 / rate : std::numeric_limits<double>::infinity();
}

/** @brief Scaling of a pair (x, z) inside the cone. @return false when one is not inside. */
inline bool scalePair(const Vector<3>& x, const Vector<3>& z, int dimension, LorentzScaling& scaling)
{
  const double x_norm = std::sqrt(lorentzDeterminant(x));
  const double z_norm = std::sqrt(lorentzDeterminant(z));
  if (!(x_norm > 0.0) || !(z_norm > 0.0) || !(x[0] > 0.0) || !(z[0] > 0.0))
    return false;
  const Vector<3> x_unit = x / x_norm;
  Vector<3> z_unit = z / z_norm;
  const double gamma = std::sqrt(0.5 * (1.0 + x_unit.dot(z_unit)));
  z_unit.tail<2>() *= -1.0;
  const Vector<3> w = (x_unit + z_unit) / (2.0 * gamma);
  const double beta = std::sqrt(x_norm / z_norm);
  SquareMatrix<3> N;
  N(0, 0) = w[0];
  N.block<1, 2>(0, 1) = w.tail<2>().transpose();
  N.block<2, 1>(1, 0) = w.tail<2>();
  N.block<2, 2>(1, 1) = SquareMatrix<2>::Identity() + w.tail<2>() * w.tail<2>().transpose() / (1.0 + w[0]);
  scaling.square = beta * beta;
  scaling.forward = beta * N;
  scaling.inverse = N / beta;
  scaling.inverse.block<1, 2>(0, 1) *= -1.0;
  scaling.inverse.block<2, 1>(1, 0) *= -1.0;
  scaling.lambda = scaling.forward * z;
  for (int k = dimension; k < 3; ++k)
    scaling.lambda[k] = 0.0;
  return true;
}

/** @brief Spectral form of N^-2 on the light-cone axes: v+ = (1, s)/sqrt2, v- = (1, -s)/sqrt2, v0 perpendicular to s.
 *  w_0 - |w_T| = 1/(w_0 + |w_T|) is exact, so that eigenvalues of very different size all keep their digits. */
struct LorentzSpectrum
{
  Vector<2> direction = Vector<2>(1.0, 0.0);  ///< s = w_T/|w_T|
  double plus = 1.0, minus = 1.0, perpendicular = 1.0;  ///< eigenvalues of N^-2
  double tangential = 0.0;  ///< |w_T|
};

inline LorentzSpectrum inverseSquareSpectrum(const LorentzScaling& scaling)
{
  // The first column of N N^T = beta^2 (2 w w^T - J).
  const double square = scaling.square;
  const Vector<3> column = scaling.forward * scaling.forward.row(0).transpose() / square;
  const double head = std::sqrt(std::max(1.0, 0.5 * (column[0] + 1.0)));
  LorentzSpectrum spectrum;
  const Vector<2> tail = column.tail<2>() / (2.0 * head);
  spectrum.tangential = tail.norm();
  if (spectrum.tangential > 0.0)
    spectrum.direction = tail / spectrum.tangential;
  const double growth = head + spectrum.tangential;
  spectrum.plus = 1.0 / (square * growth * growth);
  spectrum.minus = growth * growth / square;
  spectrum.perpendicular = 1.0 / square;
  return spectrum;
}

/** @brief The scaling of (N (lambda + t dx), N^-T (lambda + t dz)), dx and dz in scaled coordinates. */
inline bool advance(LorentzScaling& scaling, const Vector<3>& x_scaled, const Vector<3>& z_scaled, int dimension)
{
  LorentzScaling local;
  if (!scalePair(x_scaled, z_scaled, dimension, local))
    return false;
  scaling.forward = (scaling.forward * local.forward).eval();
  scaling.inverse = (local.inverse * scaling.inverse).eval();
  scaling.square *= local.square;
  scaling.lambda = local.lambda;
  return true;
}

}  // namespace frictional_contact_sim
