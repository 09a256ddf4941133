#pragma once
/**
 * @file joint_inertia.h
 * @brief Whether every joint moves inertia, and what it is given where it does not. Private to model/.
 *
 * A link may have no mass, or none about its joint's axis, as long as its joint moves some: what counts is the mass
 * matrix. M is singular at q exactly where a motion leaves all links without kinetic energy, and the joint nearest to
 * the root that takes part in it moves a link of no inertia about its own axis: a *weak* joint. So only weak joints are
 * looked at, and with something on the diagonal of each of them M is positive definite at every position:
 *
 * - It moves no inertia: at a position without special angles its pivot of M = L^T L (what a joint feels while all that
 *   it carries is free to move) is zero. It gets min_joint_inertia, but where it carries something that moves on its
 * own (two hinges on one line) at most 1e-7 of that, which is not felt.
 * - It moves none and follows (mimic): 1e-7 of what its leader moves; the row moves it, the leader must not feel it.
 * - It is held up by what it carries but for special positions (gimbal lock): 1e-7 of what it carries.
 *
 * What is added stands in MultibodyModel::armature (revolute, prismatic, planar): coupled to nothing, so no other
 * joint's motion changes, and without weight. The link of a floating joint gets mass and moments of its own instead
 * (about the axes that have none), so that it falls as everything does.
 */
#include <optional>
#include <string>
#include <vector>

#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
/**
 * @brief Adds inertia to the joints that need it, see above.
 * @param least [kg m^2, kg for coordinates along which the links slide] > 0; unset: 1e-6 of the body's mass (times its
 * radius of gyration squared), DEFAULT_JOINT_INERTIA where it has none: relative to the body, since contacts on links
 * of very different inertia are hard to solve, and nobody feels the size of what is coupled to nothing. Never less than
 * 1e-9 of what the joint carries: round-off.
 * @return warnings naming joints and values
 */
std::vector<std::string> addJointInertia(MultibodyModel& model, const std::optional<double>& least);

}  // namespace frictional_contact_sim
