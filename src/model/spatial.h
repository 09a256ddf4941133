#pragma once
/**
 * @file spatial.h
 * @brief Products of spatial vectors (linear; angular), all in world axes about one point. Private to model/.
 *
 * Source: Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.9, with linear and angular parts exchanged.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "frictional_contact_sim/model/multibody_data.h"

namespace frictional_contact_sim
{
/** @brief Rate of the motion vector `motion` that is fixed in a link of velocity `velocity`. */
inline Vector6d crossMotion(const Vector6d& velocity, const Vector6d& motion)
{
  const Eigen::Vector3d angular = velocity.tail<3>();
  Vector6d rate;
  rate.head<3>() = angular.cross(motion.head<3>()) + velocity.head<3>().cross(motion.tail<3>());
  rate.tail<3>() = angular.cross(motion.tail<3>());
  return rate;
}

/** @brief Rate of the force vector (force; torque) or momentum that is fixed in a link of velocity `velocity`. */
inline Vector6d crossForce(const Vector6d& velocity, const Vector6d& force)
{
  const Eigen::Vector3d angular = velocity.tail<3>();
  Vector6d rate;
  rate.head<3>() = angular.cross(force.head<3>());
  rate.tail<3>() = angular.cross(force.tail<3>()) + velocity.head<3>().cross(force.head<3>());
  return rate;
}

/** @brief Momentum (linear; angular about the reference) of a link moving with `velocity`; force of an acceleration. */
inline Vector6d multiply(const WorldInertia& inertia, const Vector6d& velocity)
{
  const Eigen::Vector3d linear = velocity.head<3>();
  const Eigen::Vector3d angular = velocity.tail<3>();
  Vector6d momentum;
  momentum.head<3>() = inertia.mass * linear + angular.cross(inertia.moment);
  momentum.tail<3>() = inertia.moment.cross(linear) + inertia.rotational * angular;
  return momentum;
}

/** @brief Inertia of a link at `pose` in world axes about the reference (parallel axis theorem). */
void moveInertia(const RigidInertia& inertia, const Eigen::Isometry3d& pose, const Eigen::Vector3d& reference,
                 WorldInertia& world);

}  // namespace frictional_contact_sim
