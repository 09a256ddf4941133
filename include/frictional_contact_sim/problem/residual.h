#pragma once
/**
 * @file residual.h
 * @brief The one residual of the package, and diagnostics beside it.
 *
 *   rho_i = 1/lambda_max(W_ii)                                        [kg]
 *   e_i   = (r_i - P_i(r_i - rho_i u~_i)) / rho_i                     [m/s], each law with its own projection P_i
 *   E     = max_i |e_i| / max(|q|_inf, |u|_inf, max_i |r_i|/rho_i, 1e-12 m/s)
 * and for the global form also, whichever is largest,
 *   |M v + f - H^T r - G^T lambda|_inf  relative to the largest of |M v|, |f|, |H^T r|, |G^T lambda|,
 *   |G v + b|_inf                       relative to the largest of |G_ij v_j|, |b_i|, |G_ij (M^-1 f)_j|.
 * u is recomputed: W r + q (local) or H v + w (global); W = H M^-1 H^T and q = w - H M^-1 f, bilaterals or not. The
 * last term of the bilateral scale keeps a mechanism at rest, where v is round-off, from a meaningless 0/0. Where W_ii
 * = 0 (nothing moves this row) rho_i is the smallest of the others': any positive number is right there. E = 0 without
 * rows. The number does not change with the units of mass, length and time, nor with the order of contacts.
 *
 * Departure from VERIFICATION.md, section 2: in the global form |e_i| <= 8 eps |v|_inf counts as zero, since u = H v +
 * w is not known better. It shows only at tolerances near round-off, or when velocities are 1e6 times the scale above.
 *
 * Beside it, for comparison with others:
 *   siconos_error    |r - P_K(r - u~)|_2 / max(|q|_2, |r|_2, |u|_2)   (rho = 1)
 *   natural_map_1q   |r - P_K(r - u~)|_2 / (1 + |q|_2)
 * Source: VERIFICATION.md section 2; Acary, Bremond, Huber (2018) for the natural map.
 */
#include <Eigen/Core>
#include <limits>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
/// Below any velocity that matters; keeps 0/0 away when everything is at rest without loads [m/s].
constexpr double VELOCITY_FLOOR = 1e-12;

/** @brief Largest magnitude, 0 of nothing. */
inline double maxAbs(const Eigen::VectorXd& x)
{
  return x.size() == 0 ? 0.0 : x.lpNorm<Eigen::Infinity>();
}

/** @brief rho_i of every law, as defined above; resized. */
void computeStepLengths(const DelassusProblem& problem, Eigen::VectorXd& step_lengths);
void computeStepLengths(const DelassusOperator& W, Eigen::VectorXd& step_lengths);

/** @brief What one pass over the laws finds, and E from it. */
struct LawErrors
{
  double worst = 0.0;  ///< max_i |e_i| [m/s]
  double impulse = 0.0;  ///< max_i |r_i|/rho_i [m/s]
  double velocity = 0.0;  ///< max(|q|_inf, |u|_inf, 1e-12) [m/s]

  /** @brief E; see lawResidual() for the cap. */
  double residual(double impulse_cap = std::numeric_limits<double>::infinity()) const;
};

/** @brief One pass over the laws; arguments as for lawResidual(). */
LawErrors measureLaws(const std::vector<Law>& laws, const Eigen::VectorXd& step_lengths, double free_velocity,
                      const Eigen::VectorXd& u, const Eigen::VectorXd& r, Eigen::VectorXd* errors = nullptr,
                      double round_off = 0.0);

/**
 * @brief The local part of E for given u and r, nothing recomputed; no allocation.
 * @param free_velocity |q|_inf
 * @param round_off errors up to this count as zero [m/s]
 * @param impulse_cap the impulses' part of the scale counts at most this many times the velocities' part [-]; infinite
 * in the definition of E. A finite one makes the solvers' stopping criterion: where no solution exists impulses run
 * away, and E alone would vanish while the violation stays. Beyond the cap no error counts less than the round-off of
 * |r_i|/rho_i, in which u is lost.
 * @param errors when not nullptr, |e_i| of each law [m/s] (resized)
 */
double lawResidual(const std::vector<Law>& laws, const Eigen::VectorXd& step_lengths, double free_velocity,
                   const Eigen::VectorXd& u, const Eigen::VectorXd& r, Eigen::VectorXd* errors = nullptr,
                   double round_off = 0.0, double impulse_cap = std::numeric_limits<double>::infinity());

/** @brief E of a local problem; u is overwritten by W r + q. */
double localResidual(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths, const Eigen::VectorXd& r,
                     Eigen::VectorXd& u);

/** @brief What the global residual needs beside the problem, and its workspace. */
struct GlobalResidualData
{
  Eigen::VectorXd step_lengths;  ///< rho_i
  double free_velocity = 0.0;  ///< |w - H M^-1 f|_inf
  Eigen::VectorXd mass_inverse_force;  ///< M^-1 f
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
