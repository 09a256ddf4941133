#pragma once
/**
 * @file cone.h
 * @brief Projections on Coulomb's cone and on balls, with their Jacobians; fixed size, no allocation.
 *
 *   K_mu  = { x = (x_N, x_T) : |x_T| <= mu x_N }           Coulomb's cone, D = 2 or 3 components, normal first
 *   K_mu* = { y = (y_N, y_T) : mu |y_T| <= y_N }           its dual
 *
 * A vector outside both K and its polar -K* is sent to the boundary ray t (1, mu x_T/|x_T|),
 * t = (x_N + mu |x_T|) / (1 + mu^2).
 *
 * At mu = 0 the cone is the half line x_T = 0, x_N >= 0: the sign of x_N is asked for, since |x_T| <= mu x_N alone
 * lets every (x_N, 0) pass.
 *
 * Source: Cadoux (2009), appendix E (projection on the second-order cone and its derivative), here without the scaling
 * to mu = 1, which would break down at mu = 0.
 */
#include <Eigen/Core>
#include <cmath>

namespace frictional_contact_sim
{
template <int D>
using Vector = Eigen::Matrix<double, D, 1>;
template <int D>
using SquareMatrix = Eigen::Matrix<double, D, D>;

/** @brief True when x is in K_mu. */
template <int D>
inline bool inCone(const Vector<D>& x, double mu)
{
  return x[0] >= 0.0 && x.template tail<D - 1>().norm() <= mu * x[0];
}

/** @brief Euclidean projection of x on K_mu. */
template <int D>
inline Vector<D> projectOntoCone(const Vector<D>& x, double mu)
{
  const double tangential = x.template tail<D - 1>().norm();
  if (x[0] >= 0.0 && tangential <= mu * x[0])
    return x;
  if (mu * tangential <= -x[0])
    return Vector<D>::Zero();
  const double t = (x[0] + mu * tangential) / (1.0 + mu * mu);
  Vector<D> result;
  result[0] = t;
  result.template tail<D - 1>() = (mu * t / tangential) * x.template tail<D - 1>();
  return result;
}

/** @brief Euclidean projection of y on K_mu*; by Moreau's decomposition y + P_K(-y). */
template <int D>
inline Vector<D> projectOntoDualCone(const Vector<D>& y, double mu)
{
  return y + projectOntoCone<D>(-y, mu);
}

/** @brief An element of the generalised Jacobian of projectOntoCone at x: the derivative where there is one. */
template <int D>
inline SquareMatrix<D> coneProjectionJacobian(const Vector<D>& x, double mu)
{
  const double tangential = x.template tail<D - 1>().norm();
  if (x[0] >= 0.0 && tangential <= mu * x[0])
    return SquareMatrix<D>::Identity();
  if (mu * tangential <= -x[0])
    return SquareMatrix<D>::Zero();
  const Vector<D - 1> s = x.template tail<D - 1>() / tangential;
  const double scale = 1.0 / (1.0 + mu * mu);
  const double t = (x[0] + mu * tangential) * scale;
  SquareMatrix<D> jacobian;
  jacobian(0, 0) = scale;
  jacobian.template block<1, D - 1>(0, 1) = (mu * scale) * s.transpose();
  jacobian.template block<D - 1, 1>(1, 0) = (mu * scale) * s;
  const double turn = mu * t / tangential;
  jacobian.template block<D - 1, D - 1>(1, 1) =
      turn * SquareMatrix<D - 1>::Identity() + (mu * mu * scale - turn) * s * s.transpose();
  return jacobian;
}

/** @brief Projection on the ball of the given radius; a negative radius is an empty ball, projection 0 by (1.24). */
template <int D>
inline Vector<D> projectOntoBall(const Vector<D>& x, double radius)
{
  if (radius <= 0.0)
    return Vector<D>::Zero();
  const double norm = x.norm();
  if (norm <= radius)
    return x;
  return (radius / norm) * x;
}

/** @brief projectOntoBall with its derivatives by x and by the radius. */
template <int D>
struct BallJacobian
{
  Vector<D> value;
  SquareMatrix<D> by_x;
  Vector<D> by_radius;
};

template <int D>
inline BallJacobian<D> ballProjectionJacobian(const Vector<D>& x, double radius)
{
  BallJacobian<D> jacobian;
  jacobian.by_radius.setZero();
  if (radius <= 0.0)
  {
    jacobian.value.setZero();
    jacobian.by_x.setZero();
    return jacobian;
  }
  const double norm = x.norm();
  if (norm <= radius)
  {
    jacobian.value = x;
    jacobian.by_x.setIdentity();
    return jacobian;
  }
  jacobian.value = (radius / norm) * x;
  const Vector<D> s = x / norm;
  jacobian.by_x = (radius / norm) * (SquareMatrix<D>::Identity() - s * s.transpose());
  jacobian.by_radius = s;
  return jacobian;
}

}  // namespace frictional_contact_sim
