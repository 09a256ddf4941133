#pragma once
/**
 * @file weld.h
 * @brief Two links joined rigidly for as long as it lasts: a suction gripper's grasp, a tool change.
 */
#include <Eigen/Geometry>

#include "frictional_contact_sim/model/multibody_data.h"

namespace frictional_contact_sim
{
/** @brief Part of the simulation's state; its rows are WeldRows'. */
struct Weld
{
  int body_a = -1;  ///< index of the body
  int frame_a = -1;  ///< URDF link in the body's model
  int body_b = -1;  ///< -1: the world
  int frame_b = -1;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of link a in link b, or in the world
  /// On link a over the last step, world axes, torque about the origin of link a (linear; angular) [N s, N m s]
  Vector6d impulse = Vector6d::Zero();
};

}  // namespace frictional_contact_sim
