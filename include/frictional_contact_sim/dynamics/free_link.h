#pragma once
/**
 * @file free_link.h
 * @brief A body that is one floating link, stepped about its centre of mass with its angular velocity in body axes:
 * implicit midpoint of the Lie-Poisson equations with Cayley's update. Energy, the vector of angular momentum and
 * linear momentum of a free motion are kept to round-off, wherever the link's origin is.
 *
 *     m (v_c' - v_c) = dt m g + F
 *     J (o' - o) = dt (J o_m) x o_m + tau              o_m = (o + o')/2, torque about the centre, body axes
 *     p_c' = p_c + dt (v_c + v_c')/2,   R' = R cay(dt o_m),   cay(x) = (I - x^/2)^-1 (I + x^/2)
 *
 *     m mass, J inertia about the centre [kg m^2], c centre in the link frame [m], p_c = p + R c; o angular velocity in
 *     body axes [rad/s]; F [N s], tau [N m s] impulses of all that acts; cay(x) is the quaternion (x/2, 1) normalised
 *
 * To the rows nothing of this shows. Columns are those of every floating base at the midpoint pose
 * R_m = R cay(dt o / 2), p_m = p_c + dt/2 v_c - R_m c, but they are the image
 *
 *     w~ = R_m o,   v~ = v_c - w~ x (R_m c)
 *
 * of (v_c, o), at the start as at the end of the step: Body::v_start and the problem's v. M(q_m), the Jacobians and
 * generalized forces are those of every tree, and 1/2 v~' M v~ is the kinetic energy at both ends, so the work
 * impulse . mean velocity is exact. Bias in these columns: (-m g, -(R_m J R_m' w~) x w~ - (R_m c) x m g); no
 * centrifugal term. Outside (state, messages) velocities stay those of the origin in world axes.
 *
 * A ball (three equal moments) has principal axes everywhere; the world's are taken, o = w~ = w: then friction that
 * turns a spinning ball is exact too, where body axes have the scheme's error dt^2.
 *
 * Source: Lewis, Simo, Conserving algorithms for the dynamics of Hamiltonian systems on Lie groups, J. Nonlinear Sci. 4
 * (1994), section 5; Austin, Krishnaprasad, Wang, Almost Poisson integration of rigid body systems, J. Comput. Phys.
 * 107 (1993).
 */
#include <Eigen/Core>

#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
struct Body;

/** @brief Whether a tree is one floating link. */
bool isFreeLink(const MultibodyModel& model);

/** @brief Whether the root link's principal moments are equal. */
bool isIsotropic(const MultibodyModel& model);

/** @brief Half a step from (q, v), state velocities. @param q_middle 7 */
void moveFreeLinkToMidpoint(const Body& body, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double dt,
                            Eigen::VectorXd& q_middle);

/** @brief Body::v_start, the image of the state's velocity at the midpoint pose; needs q_middle. */
void mapFreeLinkStart(Body& body);

/** @brief Body::v_free: the velocity at the end under gravity and Body::external alone, to round-off. Needs v_start. */
void moveFreely(Body& body, const Eigen::Vector3d& gravity, double dt);

/** @brief The bias above at mean velocity `v` (6), an image. @param bias 6 */
void computeFreeLinkBias(const Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity,
                         Eigen::VectorXd& bias);

/**
 * @brief The end of a step from the state. @param v 6, the answer, an image @param q_end 7 @param v_end 6, of the
 * origin in world axes; both may be the state's own
 */
void moveFreeLinkToEnd(const Body& body, const Eigen::Ref<const Eigen::VectorXd>& v, double dt, Eigen::VectorXd& q_end,
                       Eigen::VectorXd& v_end);

}  // namespace frictional_contact_sim
