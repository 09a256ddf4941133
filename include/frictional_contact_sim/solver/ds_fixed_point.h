#pragma once
/**
 * @file ds_fixed_point.h
 * @brief ds_fixed_point: De Saxce and Feng's "Uzawa" iterations (solver/fixed_point.h).
 *
 *   r <- P_L(r - theta rho u~(r)),   u~ = u + mu |u_T| e_N,   u = W r + q,   rho_i = 1/lambda_max(W_ii) a contact [kg]
 *
 * One-dimensional laws: r <- P(r - theta rho u). Products with W only.
 * Source: De Saxce, Feng (1998); Cadoux (2009), (4.8), (4.9). Departure: theta adapts; the paper leaves rho to the
 * user.
 */
#include "frictional_contact_sim/solver/fixed_point.h"

namespace frictional_contact_sim
{
class DsFixedPoint : public FixedPoint
{
public:
  explicit DsFixedPoint(const FixedPointOptions& options = {});
};

}  // namespace frictional_contact_sim
