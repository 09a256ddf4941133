#pragma once
/**
 * @file oriented_boxes.h
 * @brief Whether the boxes of two shapes, in their own axes, prove that the shapes are farther apart than a margin.
 *
 * Separating axes: 3 faces each and 9 crossed edges (Gottschalk, Lin, Manocha 1996); for a half space its normal. Never
 * true for shapes that have a point with gap <= margin, so what the narrow phase would find stays as it is.
 */
#include <Eigen/Geometry>

#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
/** @param a_in_b pose of shape a in the frame of shape b */
bool boxesAreApart(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin);

}  // namespace frictional_contact_sim
