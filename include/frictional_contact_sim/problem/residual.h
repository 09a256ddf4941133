#pragma once
/**
 * @file residual.h
 * @brief The one residual of the package, and diagnostics beside it.
 *
 *   e_i   = (r_i - P_i(r_i - rho_i u~_i)) / rho_i                     [m/s], each law with its own projection P_i
 *   E     = max_i max(|e_i|, eps |r_i|/rho_i) / S_i                   rho_i, S_i: residual_metric.h
 * and for the global form also, whichever is largest,
 *   |M v + f - H^T r - G^T lambda|_inf  relative to the largest of |M v|, |f|, |H^T r|, |G^T lambda|,
 *   |G v + b|_inf                       relative to the largest of |G_ij v_j|, |b_i|, |G_ij (M^-1 f)_j|.
 * u is recomputed: W r + q (local) or H v + w (global); W = H M^-1 H^T and q = w - H M^-1 f, bilaterals or not. The
 * last term of the bilateral scale keeps a mechanism at rest, where v is round-off, from a meaningless 0/0. Where W_ii
 * = 0 (nothing moves this row) rho_i is the smallest of the others': any positive number is right there. E = 0 without
 * rows. The number does not change with the units of mass, length and time, nor with the order of contacts.
 *
 * Round-off. |e_i| up to 64 eps times the largest speed of a point of the bodies that the rows touch (over the reach
 * for angles) counts as zero: v is not known better. A bare global problem says of these speeds what goes into u = H v
 * + w: |w_k| and |H_kj v_j|. In the other direction, r - P(r - rho u) is exactly zero once u is below the round-off of
 * r/rho, which confirms nothing: E is never below eps |r_i|/rho_i / S_i. So where no solution exists and impulses run
 * away, E does not vanish.
 *
 * Beside it, for comparison with others:
 *   siconos_error    |r - P_K(r - u~)|_2 / max(|q|_2, |r|_2, |u|_2)   (rho = 1)
 *   natural_map_1q   |r - P_K(r - u~)|_2 / (1 + |q|_2)
 * See docs/residuals.md; Acary, Bremond, Huber (2018) for the natural map.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/problem/residual_metric.h"

namespace frictional_contact_sim
{
class DelassusReduction;

/** @brief Largest magnitude, 0 of nothing. */
inline double maxAbs(const Eigen::VectorXd& x)
{
  return x.size() == 0 ? 0.0 : x.lpNorm<Eigen::Infinity>();
}

/** @brief rho_i of every law, as defined above; resized. */
void computeStepLengths(const DelassusProblem& problem, Eigen::VectorXd& step_lengths);
void computeStepLengths(const DelassusOperator& W, Eigen::VectorXd& step_lengths);

/**
 * @brief The laws' part of E for given u and r, nothing recomputed; no allocation.
 * @param errors when not nullptr, |e_i| of each law [m/s], round-off zero (resized)
 * @param residuals when not nullptr, what each law alone gives (resized)
 */
double lawResidual(const std::vector<Law>& laws, const ResidualMetric& metric, const Eigen::VectorXd& u,
                   const Eigen::VectorXd& r, Eigen::VectorXd* errors = nullptr, Eigen::VectorXd* residuals = nullptr);

/** @brief The metric of a local problem. */
ResidualMetric makeMetric(const DelassusProblem& problem);

/** @brief E of a local problem; u is overwritten by W r + q. */
double localResidual(const DelassusProblem& problem, const ResidualMetric& metric, const Eigen::VectorXd& r,
                     Eigen::VectorXd& u);

/** @brief What the global residual needs beside the problem, and its workspace. */
struct GlobalResidualData
{
  ResidualMetric metric;  ///< with rho_i and q without the bilaterals
  Eigen::VectorXd mass_inverse_force;  ///< M^-1 f, with bilaterals
  Eigen::VectorXd momentum, term;  ///< workspace, nv
};

/** @brief The parts of E of a global problem. */
struct GlobalResidual
{
  double law = 0.0;  ///< contacts and one-dimensional rows
  double dynamics = 0.0;  ///< momentum balance
  double bilateral = 0.0;  ///< G v + b
  double value() const;  ///< the largest: E
};

/** @brief Fills `data` for a problem and its reduction. @param islands of the reduced problem's W */
void setMetric(const IncrementalProblem& problem, const DelassusReduction& reduction, const Islands& islands,
               GlobalResidualData& data);

/** @brief E of a global problem; solution.u is overwritten by H v + w. */
GlobalResidual globalResidual(const IncrementalProblem& problem, GlobalResidualData& data, Solution& solution);

/** @brief Convenience for tests and tools: computes everything needed. */
double evaluateResidual(const DelassusProblem& problem, const Eigen::VectorXd& r);
GlobalResidual evaluateResidual(const IncrementalProblem& problem, const Solution& solution);

/** @brief Complementarity diagnostics of one answer; see the top for the first two. */
struct Diagnostics
{
  double siconos_error = 0.0;
  double natural_map_1q = 0.0;
  double cone_violation = 0.0;  ///< max_i distance of r_i to its set [N s]
  double negative_velocity = 0.0;  ///< max_i max(0, -u_N) of Coulomb and unilateral rows [m/s]
  double complementarity = 0.0;  ///< max_i |u_N r_N| [J]
  double maximum_dissipation = 0.0;  ///< max_i | |r_T||u_T| + r_T . u_T | of Coulomb contacts [J]
};

/** @brief Diagnostics of u and r; q only scales the first two. */
Diagnostics diagnose(const std::vector<Law>& laws, const Eigen::VectorXd& q, const Eigen::VectorXd& u,
                     const Eigen::VectorXd& r);

}  // namespace frictional_contact_sim
