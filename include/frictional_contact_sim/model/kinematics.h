#pragma once
/**
 * @file kinematics.h
 * @brief Positions, velocities and Jacobians of a MultibodyModel. No allocation.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
using VectorIn = Eigen::Ref<const Eigen::VectorXd>;
using VectorOut = Eigen::Ref<Eigen::VectorXd>;

/** @brief q (nq) of the zero position: all zero, unit quaternions. */
Eigen::VectorXd zeroPosition(const MultibodyModel& model);

/** @brief Link poses, motion subspace, link inertias at q (nq). Writes data.reference. */
void forwardKinematics(const MultibodyModel& model, const VectorIn& q, MultibodyData& data);
/** @brief Of these data.reference and link_pose alone, the same numbers. */
void computeLinkPoses(const MultibodyModel& model, const VectorIn& q, MultibodyData& data);

/** @brief Link velocities at v (nv). Needs forwardKinematics. */
void forwardVelocities(const MultibodyModel& model, const VectorIn& v, MultibodyData& data);

/** @brief q_out = q (+) dt v: quaternions by the exponential map and normalised. q_out may be q. */
void integrate(const MultibodyModel& model, const VectorIn& q, const VectorIn& v, double dt, VectorOut q_out);

/**
 * @brief Adds sign * direction^T J to row (nv), J the Jacobian of the link-fixed point at `point` (world).
 * link -1 (world) adds nothing.
 */
void addPointJacobianRow(const MultibodyModel& model, const MultibodyData& data, int link, const Eigen::Vector3d& point,
                         const Eigen::Vector3d& direction, double sign, VectorOut row);

/** @brief 6 x nv Jacobian of the link-fixed point at `point`: rows (linear; angular), world axes. */
void pointJacobian(const MultibodyModel& model, const MultibodyData& data, int link, const Eigen::Vector3d& point,
                   Eigen::Ref<Matrix6Xd> jacobian);

/** @brief Velocity (linear; angular) of the link-fixed point, world axes. Needs forwardVelocities. */
Vector6d pointVelocity(const MultibodyData& data, int link, const Eigen::Vector3d& point);

/** @brief World pose of a URDF link. */
Eigen::Isometry3d framePose(const MultibodyModel& model, const MultibodyData& data, int frame);

/** @brief Centre of mass of the whole tree, world [m]. */
Eigen::Vector3d centerOfMass(const MultibodyModel& model, const MultibodyData& data);

}  // namespace frictional_contact_sim
