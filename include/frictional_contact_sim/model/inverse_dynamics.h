#pragma once
/**
 * @file inverse_dynamics.h
 * @brief Recursive Newton-Euler for URDF links, those behind fixed joints too: what each joint transmits.
 *
 * Source: Featherstone, Rigid Body Dynamics Algorithms (2008), section 5.3.
 */
#include <vector>

#include "frictional_contact_sim/model/multibody_data.h"

namespace frictional_contact_sim
{
/**
 * @brief For each frame the wrench (force; torque about data.reference) that its URDF joint transmits to it, world
 * axes: rate of momentum of all that hangs on the joint less its weight and what else acts on it. For the root:
 * whatever holds it, zero when it is free.
 * @param data poses, velocities and accelerations without gravity (computeLinkAccelerations)
 * @param gravity world [m/s^2]
 * @param applied frames: (force; torque about data.reference) of contacts and external wrenches, world axes [N], [N m]
 */
void computeJointWrenches(const MultibodyModel& model, const MultibodyData& data, const Eigen::Vector3d& gravity,
                          const std::vector<Vector6d>& applied, std::vector<Vector6d>& wrenches);

/** @brief A wrench about data.reference as (force; torque about the origin of `pose`) in the axes of `pose`. */
Vector6d localWrench(const MultibodyData& data, const Eigen::Isometry3d& pose, const Vector6d& wrench);

/** @brief Acceleration of the link-fixed point at `point`, world axes [m/s^2]: gravity is no part of it. */
Eigen::Vector3d pointAcceleration(const MultibodyData& data, int link, const Eigen::Vector3d& point);

}  // namespace frictional_contact_sim
