#pragma once
/**
 * @file step_motion.h
 * @brief How the links of a body moved over a step: what the equation of motion of the step says of each of them.
 */
#include "frictional_contact_sim/dynamics/body.h"

namespace frictional_contact_sim
{
/**
 * @brief Poses at the midpoint of the last step, mean velocities and mean accelerations over it: jumps of an impact are
 * spread over the step.
 * @param v_end nv, the step's answer in the problem's columns. @param dt of the step [s]
 * @param data sized by the body's model: pose, velocity and acceleration of the links
 */
void computeStepMotion(const Body& body, const VectorIn& v_end, double dt, MultibodyData& data);

/**
 * @brief Adds the external wrenches that acted in the last step to those of their frames.
 * @param middle of that step on the scenario's clock [s]. @param data of computeStepMotion
 * @param applied frames: (force; torque about data.reference), world axes [N], [N m]
 */
void addExternalWrenches(const Body& body, const MultibodyData& data, double middle, std::vector<Vector6d>& applied);

}  // namespace frictional_contact_sim
