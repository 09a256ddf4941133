#pragma once
/**
 * @file lumped_inertia.h
 * @brief Inertia of links rigidly joined, and whether the moving links' inertia makes sense. Private to model/.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
/** @brief The same inertia in the axes and about the origin of a frame the old frame is placed in. */
RigidInertia transform(const RigidInertia& inertia, const Eigen::Isometry3d& placement);

/**
 * @brief One inertia of many, all given in the same frame.
 * Parallel axis theorem about the common centre of mass (two passes: no cancellation far from the origin).
 */
RigidInertia combine(const std::vector<RigidInertia>& parts);

/**
 * @brief Judges the moving links after lumping: numbers must be finite, principal moments not negative. What is zero is
 * judged joint by joint (joint_inertia.h). The link of a FIXED base is not judged.
 * @throws ModelError naming source, link and values
 * @return warnings: moments of no real distribution of mass
 */
std::vector<std::string> checkInertia(const MultibodyModel& model, const std::string& source);

}  // namespace frictional_contact_sim
