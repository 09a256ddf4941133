#pragma once
/**
 * @file contact_kinematics.h
 * @brief What the existence criterion (problem/existence.h) sees of a problem: H, w, the dual cones, and all bilateral
 * rows together. DRY_FRICTION rows bound r and restrict nothing.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
/** @brief A row group of H whose velocity must lie in a dual cone. */
struct DualCone
{
  int law;  ///< index in the problem's laws
  int row;  ///< first row in H
  int dimension;  ///< 1, 2 or 3
  double friction;  ///< [-]
};

/** @brief What the criterion looks at: kinematics only. */
struct ContactKinematics
{
  SparseRows H;  ///< rows x nv
  Eigen::VectorXd w;  ///< rows
  SparseRows E;  ///< bilateral rows x nv
  Eigen::VectorXd b;  ///< bilateral rows
  std::vector<int> bilateral_law;  ///< of each row of E the law that it is, -1: row of the problem's G
  std::vector<int> bilateral_row;  ///< and the row of G, -1: a law
  std::vector<DualCone> cones;
};

/** @brief BILATERAL laws first, then the rows of G. @param G, b nullptr: none */
ContactKinematics collectKinematics(const SparseRows& H, const Eigen::VectorXd& w, const std::vector<Law>& laws,
                                    const SparseRows* G, const Eigen::VectorXd* b);

}  // namespace frictional_contact_sim
