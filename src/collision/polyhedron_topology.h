#pragma once
/**
 * @file polyhedron_topology.h
 * @brief Shared by polyhedron.cpp and convex_hull.cpp.
 */
#include <vector>

#include "frictional_contact_sim/collision/polyhedron.h"

namespace frictional_contact_sim
{
/** @brief Fills faces, edges, neighbours and bounds from the vertices and the corner loops of the faces. */
void completeTopology(const std::vector<std::vector<int>>& loops, Polyhedron& polyhedron);
}  // namespace frictional_contact_sim
