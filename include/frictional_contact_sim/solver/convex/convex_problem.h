#pragma once
/**
 * @file convex_problem.h
 * @brief The convex problem inside the outer fixed points:   min 1/2 r^T W r + c^T r,   r in a product of simple sets.
 *
 *   CONE       |r_T| <= p r_N, 2 or 3 rows    K_mu with p = mu                           (3.13)
 *   CYLINDER   r_N >= 0, |r_T| <= p           Tresca's half-cylinder T(s), p = s [N s]   (1.26), (4.17)
 *   HALF_LINE  r >= 0                         UNILATERAL
 *   INTERVAL   |r| <= p                       DRY_FRICTION, p = c [N s]
 *   LINE       r free                         BILATERAL
 *
 * Optimality, with u = W r + c [m/s] and rho_i = 1/lambda_max(W_ii) [kg]:
 *   e_i = (r_i - P_i(r_i - rho_i u_i)) / rho_i = 0,   error = max_i |e_i| [m/s]
 * W need only be positive semi-definite; when it is slightly unsymmetric the problem means this fixed point.
 * Source: Cadoux (2009), (3.13), (4.17).
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"

namespace frictional_contact_sim
{
enum class SetType
{
  CONE,
  CYLINDER,
  HALF_LINE,
  INTERVAL,
  LINE
};

struct SimpleSet
{
  SetType type = SetType::CONE;
  int dimension = 3;  ///< rows: 1, 2 or 3
  double parameter = 0.0;  ///< CONE: mu [-]; CYLINDER, INTERVAL: threshold [N s]; else 0
};

struct ConvexProblem
{
  const DelassusOperator* W = nullptr;  ///< not owned, rows x rows [1/kg]
  Eigen::VectorXd c;  ///< rows [m/s]
  std::vector<SimpleSet> sets;  ///< one a block of W
  Eigen::VectorXd step_lengths;  ///< rho_i, one a set [kg]
};

/** @brief The sets of (3.13): cones for Coulomb, each one-dimensional law's own set. c and step_lengths are copied. */
void makeConeProblem(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths, ConvexProblem& convex);
/** @brief The sets of (4.17a): cylinders of radius thresholds[i] [N s] (one a law, read for Coulomb laws only). */
void makeCylinderProblem(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths,
                         const Eigen::VectorXd& thresholds, ConvexProblem& convex);

/** @brief The metric D of a gradient step r - t D u; scalars a block, so that projections keep their closed form. */
enum class Metric
{
  UNIT,  ///< D = I, t [kg]: the thesis's
  BLOCK  ///< D = diag(rho_i), t [-]: does not see the units nor the mass ratios between contacts
};
void fillMetric(const ConvexProblem& problem, Metric metric, Eigen::VectorXd& diagonal);

/** @brief Projects the set's rows in place. */
void projectOntoSet(const SimpleSet& set, double* r);
void projectOntoSets(const ConvexProblem& problem, Eigen::VectorXd& r);

/** @brief error [m/s] as defined above, u = W r + c given. */
double optimalityError(const ConvexProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r);

}  // namespace frictional_contact_sim
