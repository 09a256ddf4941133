#pragma once
/**
 * @file polyhedron_search.h
 * @brief Extreme vertices and faces of polyhedra of any size, found along their surface: the exact answer of a search
 * through all of them, ties too.
 *
 * Why this is exact. (1) The vertices of a convex surface above a height are connected along its edges. The triangles
 * of a hull are convex for vertices moved by at most j (Polyhedron::slack = 2 j and round-off), so a way between two
 * vertices never falls by more than the slack below the lower of them, and a flood with that slack reaches all. (2) The
 * faces at a vertex are the corners of its normal cone, and the cones tile the sphere: the cones that meet a cap around
 * the direction are connected across the arcs (edges) that meet it.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/collision/polyhedron.h"

namespace frictional_contact_sim
{
/** @brief A vertex farthest along a direction, within Polyhedron::slack. For hulls and flat polygons. */
int nearlyFarthestVertex(const Polyhedron& core, const Eigen::Vector3d& direction);

/** @brief The vertex farthest along a direction; of several the first. */
int farthestVertex(const Polyhedron& core, const Eigen::Vector3d& direction);

/** @brief All vertices with up . x <= height into search.found, ascending. */
void verticesBelow(const Polyhedron& core, const Eigen::Vector3d& up, double height, VertexSearch& search);

/** @brief The face whose normal is nearest to a direction; of those within 1e-9 of its cosine the first; -1 for none.
 */
int nearestFace(const Polyhedron& core, const Eigen::Vector3d& direction);

}  // namespace frictional_contact_sim
