#pragma once
/**
 * @file roll_pitch_yaw.h
 * @brief URDF's rpy: turns about the fixed axes x, y, z, in this order.
 */
#include <Eigen/Geometry>

namespace frictional_contact_sim
{
/** @param rpy roll, pitch, yaw [rad] */
inline Eigen::Quaterniond fromRollPitchYaw(const Eigen::Vector3d& rpy)
{
  return Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX());
}

}  // namespace frictional_contact_sim
