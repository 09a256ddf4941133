#pragma once
/**
 * @file root_motion.h
 * @brief Pose and velocity of a robot's root link, whatever moves it: its own coordinates or a prescribed motion.
 */
#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief World pose: the frame of body 0 is that of the link it is named after. */
Eigen::Isometry3d rootPose(const Simulator& simulator, int body);
/** @brief Velocity (linear; angular) of its origin, world axes. */
Vector6d rootVelocity(const Simulator& simulator, int body);

}  // namespace frictional_contact_sim
