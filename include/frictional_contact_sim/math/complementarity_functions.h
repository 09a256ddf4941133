#pragma once
/**
 * @file complementarity_functions.h
 * @brief The Fischer-Burmeister function of each law, with Jacobians; commensurable u and r (rho = 1), no allocation.
 *
 *   Coulomb      phi(x, y),  x = (mu r_N, r_T),  y = (u~_N, mu u~_T)      in the Jordan algebra; u~ = u + mu |u_T| e_N
 *   mu = 0       (phi(r_N, u_N), r_T)                                     x and y would vanish in part
 *   unilateral   phi(r, u)
 *   dry friction phi(r + c, -phi(c - r, -u))                              -c <= r <= c, u = 0 inside, else u opposite
 *
 * alpha > 0 smooths every phi. Zero with alpha = 0 exactly where (u, r) is in the law.
 * Source: Cadoux (2009), (4.11), K_mu scaled to the Lorentz cone; Billups (1995) for the box.
 */
#include "frictional_contact_sim/math/contact_functions.h"
#include "frictional_contact_sim/math/jordan_algebra.h"

namespace frictional_contact_sim
{
/** @brief Coulomb contact. */
template <int D>
inline ContactFunction<D> coulombFischerBurmeister(const Vector<D>& u, const Vector<D>& r, double mu, double smoothing,
                                                   bool jacobians)
{
  ContactFunction<D> f;
  if (mu == 0.0)
  {
    const ScalarFischerBurmeister normal = fischerBurmeister(r[0], u[0], smoothing);
    f.value = r;
    f.value[0] = normal.value;
    f.by_u.setZero();
    f.by_u(0, 0) = normal.by_b;
    f.by_r.setIdentity();
    f.by_r(0, 0) = normal.by_a;
    return f;
  }
  Vector<D> x = r;
  x[0] *= mu;
  const Vector<D> shifted = deSaxce<D>(u, mu);
  Vector<D> y = mu * shifted;
  y[0] = shifted[0];
  const FischerBurmeister<D> phi = fischerBurmeister<D>(x, y, smoothing, jacobians);
  f.value = phi.value;
  if (!jacobians)
    return f;
  f.by_r = phi.by_x;
  f.by_r.col(0) *= mu;
  SquareMatrix<D> by_shifted = mu * phi.by_y;
  by_shifted.col(0) = phi.by_y.col(0);
  f.by_u = by_shifted * deSaxceJacobian<D>(u, mu);
  return f;
}

/** @brief 0 <= u orthogonal r >= 0. */
inline ContactFunction<1> unilateralFischerBurmeister(double u, double r, double smoothing)
{
  const ScalarFischerBurmeister phi = fischerBurmeister(r, u, smoothing);
  ContactFunction<1> f;
  f.value[0] = phi.value;
  f.by_u(0, 0) = phi.by_b;
  f.by_r(0, 0) = phi.by_a;
  return f;
}

/** @brief |r| <= threshold, u = 0 or r = -threshold u/|u|. */
inline ContactFunction<1> dryFrictionFischerBurmeister(double u, double r, double threshold, double smoothing)
{
  const ScalarFischerBurmeister upper = fischerBurmeister(threshold - r, -u, smoothing);
  const ScalarFischerBurmeister lower = fischerBurmeister(r + threshold, -upper.value, smoothing);
  ContactFunction<1> f;
  f.value[0] = lower.value;
  f.by_u(0, 0) = lower.by_b * upper.by_b;
  f.by_r(0, 0) = lower.by_a + lower.by_b * upper.by_a;
  return f;
}

}  // namespace frictional_contact_sim
