#pragma once
/**
 * @file closure.h
 * @brief Two links joined beside their trees: the closure of a kinematic loop, a suction gripper's grasp, a tool
 * change.
 */
#include <Eigen/Geometry>

#include "frictional_contact_sim/model/loop_joint.h"
#include "frictional_contact_sim/model/multibody_data.h"

namespace frictional_contact_sim
{
/** @brief Part of the simulation's state; its rows are ClosureRows'. */
struct Closure
{
  LoopType type = LoopType::WELD;
  int body_a = -1;  ///< index of the body
  int frame_a = -1;  ///< URDF link in the body's model
  int body_b = -1;  ///< -1: the world
  int frame_b = -1;
  Eigen::Isometry3d anchor = Eigen::Isometry3d::Identity();  ///< in link a; its z axis is that of AXIS
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of the anchor in link b, or in the world
  /// Directions of the rows about axes over the last step, world axes: the identity of a weld, x and y of the anchor as
  /// link b has it of an AXIS.
  Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
  /// On link a over the last step: force in world axes, torque about the anchor along `basis` [N s, N m s]
  Vector6d impulse = Vector6d::Zero();

  /** @brief Impulse on link a, world axes, torque about the anchor (linear; angular) [N s, N m s]. */
  Vector6d worldImpulse() const
  {
    Vector6d world;
    world << impulse.head<3>(), basis * impulse.tail<3>();
    return world;
  }
};

}  // namespace frictional_contact_sim
