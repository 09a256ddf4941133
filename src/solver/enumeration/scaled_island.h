#pragma once
/**
 * @file scaled_island.h
 * @brief One island without BILATERAL laws, its rows scaled so that W_ii and q are about one.
 *
 *   u' = W' r' + q',   r = P r' + p (all rows of the island),   E r' = e
 *
 * BILATERAL rows b are eliminated: r_b = -W_bb^+ (W_bc r_c + q_b), least norm where they are redundant; what the
 * pseudo-inverse leaves of u_b = 0 are the rows of E, which a symmetric positive semi-definite W does not have.
 * Scaling: law i by s_i = 1/sqrt(lambda_max(W_ii)), r_i = s_i sigma r'_i, u_i = sigma u'_i / s_i, sigma the largest
 * s_i |q_i| (of one-sided rows the negative part only).
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"

namespace frictional_contact_sim
{
struct ScaledIsland
{
  Eigen::MatrixXd W;
  Eigen::VectorXd q;
  std::vector<Law> laws;  ///< DRY_FRICTION's threshold scaled
  std::vector<int> offsets;  ///< first row of each law
  std::vector<int> indices;  ///< of each law among the island's
  Eigen::MatrixXd E;
  Eigen::VectorXd e;
  Eigen::MatrixXd P;
  Eigen::VectorXd p;
  bool consistent = true;  ///< false: bilateral rows contradict each other, whatever r' is

  int rows() const { return static_cast<int>(q.size()); }
  /** @brief The island's impulses [N s]. */
  Eigen::VectorXd impulses(const Eigen::VectorXd& scaled) const { return P * scaled + p; }
};

ScaledIsland scaleIsland(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<Law>& laws);

}  // namespace frictional_contact_sim
