#pragma once
/**
 * @file dynamics_algorithms.h
 * @brief Mass matrix (composite rigid body), its tree-sparse factor, bias forces (recursive Newton-Euler), energies.
 *
 * Source: Featherstone, Rigid Body Dynamics Algorithms (2008), tables 5.1, 6.2 and 6.4 (L^T L factor).  No allocation.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
/** @brief data.mass_matrix at the q of forwardKinematics. */
void computeMassMatrix(const MultibodyModel& model, MultibodyData& data);

/**
 * @brief Factor M + diag(extra) = L^T L in data.mass_factor, using dof_parent: no fill-in.
 * @param extra nv, added to the diagonal (servo stiffness and damping); may be empty
 * @return false when a pivot is not positive
 */
bool factorizeMassMatrix(const MultibodyModel& model, const VectorIn& extra, MultibodyData& data);

/** @brief x <- (M + diag(extra))^-1 x with the factor (nv). */
void solveMassMatrix(const MultibodyModel& model, const MultibodyData& data, VectorOut x);

/**
 * @brief Bias forces c(q, v) - tau_gravity (nv): M a + bias = applied.  Gyroscopic, Coriolis and gravity terms.
 * Needs forwardKinematics; calls forwardVelocities.
 * @param gravity world [m/s^2]
 */
void computeBiasForces(const MultibodyModel& model, const VectorIn& v, const Eigen::Vector3d& gravity,
                       MultibodyData& data, VectorOut bias);

/**
 * @brief data.link_velocity and data.link_acceleration at v and its rate (nv), without gravity: spatial accelerations,
 * whose linear part is that of the link-fixed point at `reference` less angular velocity x its velocity.
 * Needs forwardKinematics.
 */
void computeLinkAccelerations(const MultibodyModel& model, const VectorIn& v, const VectorIn& rate,
                              MultibodyData& data);
/** @brief Gravity's part of the bias forces (nv): what holds the links at rest. Needs forwardKinematics. */
void computeGravityForces(const MultibodyModel& model, const Eigen::Vector3d& gravity, MultibodyData& data,
                          VectorOut forces);

/** @brief Adds J^T (force; torque) of a wrench at a link-fixed point to tau (nv). World axes, [N], [N m]. */
void addWrench(const MultibodyModel& model, const MultibodyData& data, int link, const Eigen::Vector3d& point,
               const Eigen::Vector3d& force, const Eigen::Vector3d& torque, VectorOut tau);

/** @brief 1/2 v^T M v [J], of the links from their velocities. Needs forwardVelocities at v. */
double kineticEnergy(const MultibodyModel& model, const MultibodyData& data, const VectorIn& v);

/** @brief -sum m g . c [J]. Needs forwardKinematics. */
double potentialEnergy(const MultibodyModel& model, const MultibodyData& data, const Eigen::Vector3d& gravity);

}  // namespace frictional_contact_sim
