#pragma once
/**
 * @file ds_newton.h
 * @brief ds_newton: semismooth Newton (solver/semismooth_newton.h) on De Saxce's formulation by projection.
 *
 *   f(u, r) = S^-1 P_{K_mu'}(S r - S^-1 u~) - r,   u~ = u + mu |u_T| e_N,   S = diag(rho_N, rho_T, rho_T)^(-1/2),
 *   mu' = mu (rho_N / rho_T)^(1/2),   rho_N = 1/W_NN,  rho_T = 1/lambda_max(W_TT)                            [kg]
 *   df/du = -S^-1 P' S^-1 du~/du,     df/dr = S^-1 P' S - I,   P' of appendix E, du~/du of (D.2)
 *
 * With rho_N = rho_T = rho this is P_K(r - rho u~) - r, the thesis's (4.8) and (D.1). With two step lengths the point
 * is projected in the metric S^2: S maps K_mu to K_mu' and S^-1 maps the dual of K_mu to the dual of K_mu', so zeros
 * are the same for any positive pair. One-dimensional laws: P(r - rho u) - r. Source: De Saxce, Feng (1998); Cadoux
 * (2009), (4.8), (D.1), (D.2), appendix E. Departure: two step lengths a contact.
 */
#include "frictional_contact_sim/solver/semismooth_newton.h"

namespace frictional_contact_sim
{
/** @brief De Saxce's projection function of one Coulomb contact, as above. */
ContactMap deSaxceMap();

class DsNewton : public SemismoothNewton
{
public:
  explicit DsNewton(const SemismoothNewtonOptions& options = {});
};

}  // namespace frictional_contact_sim
