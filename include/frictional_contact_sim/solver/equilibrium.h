#pragma once
/**
 * @file equilibrium.h
 * @brief Statics: whether forces in their laws balance the loads, or the proof that none do.
 *
 *     find r in L, lambda:   H^T r + G^T lambda = f           (a body at rest, u = 0: all of K is allowed)
 *
 * as the convex problem  min 1/2 |H^T r + G^T lambda - f|^2 in the norm of M^-1,  (3.13) of Cadoux (2009) with s = 0:
 * M serves as a proximal term, since K of rigid bodies is zero. Its minimum is zero where an equilibrium exists. Else
 * v = M^-1 (H^T r + G^T lambda - f) is a certificate (Farkas): H v in L* and G v = 0, so that no force opposes it, and
 * the loads do work on it, -f . v = |v|_M^2 > 0.
 *
 * Sources: Cadoux (2009), sections 1.5.2 and 3.3; Heyman (1966) for masonry.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
struct Equilibrium
{
  bool exists = false;
  bool is_proven = false;  ///< when it does not exist: v is a certificate
  double share = 0.0;  ///< |v|_M / |M^-1 f|_M: what of the loads no force balances [-]
  double residual = 0.0;  ///< of the forces where it exists, nothing moving: residual.h with w = 0 [-]
  double reach = 0.0;  ///< least u_N - mu |u_T| of H v, over the largest |u|: not below zero for a certificate [-]
  int iterations = 0;
  Solution solution;  ///< r, lambda; v = 0 where it exists, else the certificate
};

/** @brief w and b of the problem do not count. @param tolerance on the share [-] > 0
 *  @throws std::invalid_argument when M is not positive definite */
Equilibrium findEquilibrium(const IncrementalProblem& problem, double tolerance);

}  // namespace frictional_contact_sim
