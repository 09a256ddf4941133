#pragma once
/**
 * @file start_check.h
 * @brief What is odd about a scene before its first step, as warnings. Private to simulation/.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/world_model.h"

namespace frictional_contact_sim
{
/**
 * @brief A line for each pair of links of different bodies, or link and ground, that overlap: both sides and the depth.
 * Less than a thousandth of the smaller shape's radius is a resting contact.
 * @param collision the world's, with poses
 * @param body that is one of the two; -1: any
 */
std::vector<std::string> findOverlaps(const WorldModel& world, CollisionWorld collision, int body = -1);

/**
 * @brief A line for each link whose moments of inertia cannot be those of its mass in its collision shapes: their sum
 * is a hundred times smaller than that of the shapes filled uniformly, or a hundred times larger than that about the
 * link's centre of mass.
 * @param body index of the body
 */
std::vector<std::string> findImplausibleInertia(const WorldModel& world, int body);

}  // namespace frictional_contact_sim
