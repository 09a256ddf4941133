#pragma once
/**
 * @file contact_functions.h
 * @brief De Saxce's change of variables and the Alart-Curnier function of one contact, with Jacobians.
 *
 *   De Saxce          u~ = u + mu |u_T| e_N                      u~ in K_mu*, r in K_mu, u~ . r = 0       (1.29)
 *   natural map       z  = r - P_K(r - rho u~)                   zero exactly at a solution               (4.8)
 *   Alart-Curnier     f_N = max(0, r_N - rho_N u_N) - r_N                                                 (1.23)
 *                     f_T = P_B(0, mu R)(r_T - rho_T u_T) - r_T                                           (1.24)
 *
 * u [m/s], r [N s], rho [kg] (inverse of a Delassus entry). The thesis takes R = r_N; Siconos and most Newton codes
 * take R = max(0, r_N - rho_N u_N), which agrees at a solution and keeps a take-off from leaving a tangential impulse
 * behind. Both are offered (RadiusRule).
 *
 * Source: Cadoux (2009), (1.23)-(1.29), (4.8), appendix D; Alart and Curnier (1991).
 */
#include "frictional_contact_sim/math/cone.h"

namespace frictional_contact_sim
{
/** @brief What the radius of the friction disc follows in the Alart-Curnier function. */
enum class RadiusRule
{
  IMPULSE,  ///< mu r_N, the thesis's (1.24)
  AUGMENTED  ///< mu max(0, r_N - rho_N u_N)
};

/** @brief De Saxce's u~ = u + mu |u_T| e_N. */
template <int D>
inline Vector<D> deSaxce(const Vector<D>& u, double mu)
{
  Vector<D> result = u;
  result[0] += mu * u.template tail<D - 1>().norm();
  return result;
}

/** @brief du~/du (D.2); at u_T = 0 the element with zero tangential derivative. */
template <int D>
inline SquareMatrix<D> deSaxceJacobian(const Vector<D>& u, double mu)
{
  SquareMatrix<D> jacobian = SquareMatrix<D>::Identity();
  const double tangential = u.template tail<D - 1>().norm();
  if (tangential > 0.0)
    jacobian.template block<1, D - 1>(0, 1) = (mu / tangential) * u.template tail<D - 1>().transpose();
  return jacobian;
}

/** @brief Value and derivatives of a contact function f(u, r). */
template <int D>
struct ContactFunction
{
  Vector<D> value;
  SquareMatrix<D> by_u;
  SquareMatrix<D> by_r;
};

/** @brief The Alart-Curnier function of one Coulomb contact. */
template <int D>
inline Vector<D> alartCurnier(const Vector<D>& u, const Vector<D>& r, double mu, double rho_normal,
                              double rho_tangential, RadiusRule rule)
{
  const double trial = r[0] - rho_normal * u[0];
  const double radius = mu * (rule == RadiusRule::IMPULSE ? r[0] : trial);
  const Vector<D - 1> y = r.template tail<D - 1>() - rho_tangential * u.template tail<D - 1>();
  Vector<D> value;
  value[0] = (trial > 0.0 ? trial : 0.0) - r[0];
  value.template tail<D - 1>() = projectOntoBall<D - 1>(y, radius) - r.template tail<D - 1>();
  return value;
}

/** @brief The Alart-Curnier function with its Jacobians (appendix D.1). */
template <int D>
inline ContactFunction<D> alartCurnierJacobian(const Vector<D>& u, const Vector<D>& r, double mu, double rho_normal,
                                               double rho_tangential, RadiusRule rule)
{
  constexpr int T = D - 1;
  ContactFunction<D> f;
  f.by_u.setZero();
  f.by_r = -SquareMatrix<D>::Identity();
  const double trial = r[0] - rho_normal * u[0];
  const bool active = trial > 0.0;
  f.value[0] = (active ? trial : 0.0) - r[0];
  if (active)
  {
    f.by_u(0, 0) = -rho_normal;
    f.by_r(0, 0) = 0.0;
  }
  const double radius = mu * (rule == RadiusRule::IMPULSE ? r[0] : trial);
  const Vector<T> y = r.template tail<T>() - rho_tangential * u.template tail<T>();
  const BallJacobian<T> ball = ballProjectionJacobian<T>(y, radius);
  f.value.template tail<T>() = ball.value - r.template tail<T>();
  f.by_u.template block<T, T>(1, 1) = -rho_tangential * ball.by_x;
  f.by_r.template block<T, T>(1, 1) += ball.by_x;
  f.by_r.template block<T, 1>(1, 0) = mu * ball.by_radius;
  if (rule == RadiusRule::AUGMENTED)
    f.by_u.template block<T, 1>(1, 0) = (-mu * rho_normal) * ball.by_radius;
  return f;
}

}  // namespace frictional_contact_sim
