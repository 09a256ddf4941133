#pragma once
/**
 * @file ac_fixed_point.h
 * @brief ac_fixed_point: fixed-point iterations on Alart and Curnier's formulation (solver/fixed_point.h).
 *
 *   r_N <- max(0, r_N - theta rho_N u_N),   r_T <- P_B(0, mu r_N)(r_T - theta rho_T u_T) with the old r_N in the radius
 *   u = W r + q,   rho_N = 1/W_NN,  rho_T = 1/lambda_max(W_TT)                                                   [kg]
 *
 * One-dimensional laws: r <- P(r - theta rho u). Products with W only.
 * Source: Cadoux (2009), (4.7), with (1.23), (1.24). Departure: theta adapts.
 */
#include "frictional_contact_sim/solver/fixed_point.h"

namespace frictional_contact_sim
{
class AcFixedPoint : public FixedPoint
{
public:
  explicit AcFixedPoint(const FixedPointOptions& options = {});
};

}  // namespace frictional_contact_sim
