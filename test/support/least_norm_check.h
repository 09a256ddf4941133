#pragma once
/**
 * @file least_norm_check.h
 * @brief A lower bound of sum_i |r_i|^2/rho_i over all r with the generalized force of a given one and r_i in its law.
 *
 *   least = max over z of  2 z^T B^T s* - sum_i 2 (s_i^T B_i z - |s_i|^2/2),   s_i = P_i(B_i z),  B = diag(sqrt(rho)) H
 * N
 *
 * N spans the null space of G (dense, SVD). Any z gives a bound, so that whatever the ascent reaches is a certificate;
 * `gap` tells how good it is. Shares no code with math, problem or solver: dense SVD of M, G and B instead of a sparse
 * factor, accelerated gradient steps instead of Newton's, the projection from the angle in the plane of the argument.
 * docs/residuals.md, "Which forces": at most twice the least sum, in every step of every hyperstatic scene.
 */
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
namespace test_support
{
struct LeastNormBound
{
  double sum = 0.0;  ///< sum_i |r_i|^2/rho_i of the given r, laws that may not change left out [kg m^2/s^2]
  double bound = 0.0;  ///< no r with the same effect has less
  double gap = 0.0;  ///< what the bound's own s misses of the generalized force, relative to it [-]
  Eigen::VectorXd r;  ///< of the bound; within the laws, and with the same effect up to gap
};

/** @param thresholds a law each, below it a velocity is zero, as for solver/least_norm.h */
LeastNormBound leastNormBound(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds,
                              const Solution& solution, int steps = 20000);

}  // namespace test_support
}  // namespace frictional_contact_sim
