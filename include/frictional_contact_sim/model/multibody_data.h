#pragma once
/**
 * @file multibody_data.h
 * @brief Workspace of the algorithms in model/kinematics.h and model/dynamics_algorithms.h, sized once from the model.
 *
 * Everything is in world axes. Spatial vectors are (linear; angular) and refer to the point `reference`, the origin of
 * the root link at the time of forwardKinematics (small lever arms wherever the robot stands): the linear part of a
 * motion vector is the velocity of the link-fixed point that is at `reference`. Because everything shares one frame,
 * composite inertias add without a transform (cf. Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 5 and 6).
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/** @brief Mass, first and second moment about `reference`, world axes; sums over links. */
struct WorldInertia
{
  double mass = 0.0;  ///< [kg]
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< mass times (centre - reference) [kg m]
  Eigen::Matrix3d rotational = Eigen::Matrix3d::Zero();  ///< about reference [kg m^2]
};

struct MultibodyData
{
  explicit MultibodyData(const MultibodyModel& model);

  /// Root joint frame in the world: the model's placement, unless the base is moved; read by forwardKinematics.
  Eigen::Isometry3d base_pose;

  // written by forwardKinematics
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  std::vector<Eigen::Isometry3d> link_pose;  ///< links: link frame in the world
  Matrix6Xd motion_subspace;  ///< 6 x nv: column j is the motion of unit v_j
  std::vector<WorldInertia> link_inertia;  ///< links
  // written by forwardVelocities
  std::vector<Vector6d> link_velocity;  ///< links
  // written by computeMassMatrix
  Eigen::MatrixXd mass_matrix;  ///< nv x nv, both triangles
  // written by factorizeMassMatrix
  Eigen::MatrixXd mass_factor;  ///< nv x nv, lower triangle of L with M = L^T L (tree sparsity)
  Eigen::VectorXd factor_inverse;  ///< nv: 1 / diagonal of L
  // scratch
  Eigen::VectorXd factor_row;  ///< nv
  std::vector<WorldInertia> composite_inertia;
  std::vector<Vector6d> link_acceleration;
  std::vector<Vector6d> link_force;
};

}  // namespace frictional_contact_sim
