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
 * @brief Judges the moving links after lumping.
 * A link with mass and three positive principal moments is good. Without, it may still move with what it carries: then
 * the mass matrix decides, which must be positive definite (two configurations; the least articulated inertia
 * along a coordinate at least 1e-10 of the composite inertia). The link of a FIXED base is not judged.
 * @throws ModelError naming source, link and values
 * @return warnings
 */
std::vector<std::string> checkInertia(const MultibodyModel& model, const std::string& source);

}  // namespace frictional_contact_sim
