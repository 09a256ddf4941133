#pragma once
/**
 * @file fb_newton.h
 * @brief fb_newton: semismooth Newton (solver/semismooth_newton.h) on the Fischer-Burmeister function of the cone.
 *
 *   f(u, r) = S^-1 phi(x, y),   x = (mu' z_N, z_T),  y = (c~_N, mu' c~_T),   z = S r,  c~ = S^-1 (u + mu |u_T| e_N)
 *   S = diag(rho_N, rho_T, rho_T)^(-1/2),  mu' = mu (rho_N / rho_T)^(1/2),  rho_N = 1/W_NN,  rho_T = 1/lambda_max(W_TT)
 *
 * S makes x and y commensurable ([J]^(1/2)) and keeps the law: see ds_newton.h. x and y are in the Lorentz cone exactly
 * when r is in K_mu and u~ in its dual; phi of math/jordan_algebra.h. A contact with mu = 0 has r_T = 0 and the scalar
 * function for its normal part. One-dimensional laws: P(r - rho u) - r.
 * Source: Fischer (1992); Fukushima, Luo, Tseng (2002); Cadoux (2009), 4.2.3, (4.11). Departure: the scaling S.
 */
#include "frictional_contact_sim/solver/semismooth_newton.h"

namespace frictional_contact_sim
{
/** @brief The Fischer-Burmeister function of one Coulomb contact, as above. */
ContactMap fischerBurmeisterMap();

class FbNewton : public SemismoothNewton
{
public:
  explicit FbNewton(const SemismoothNewtonOptions& options = {});
};

}  // namespace frictional_contact_sim
