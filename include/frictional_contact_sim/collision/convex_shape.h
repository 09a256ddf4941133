#pragma once
/**
 * @file convex_shape.h
 * @brief A collision shape made ready for the narrow phase: a convex core and a radius around it.
 *
 * sphere = point + radius, capsule = segment + radius, box and hull = polyhedron + 0 (a flat polygon is a hull); the
 * cylinder is its own core (axis z, flat discs; the polyhedron holds its axis); the half space z <= 0 is the only
 * unbounded shape.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/collision/polyhedron.h"
#include "frictional_contact_sim/model/geometry.h"

namespace frictional_contact_sim
{
enum class ShapeKind
{
  SPHERE,
  CAPSULE,
  BOX,
  HULL,
  CYLINDER,
  HALF_SPACE
};

struct ConvexShape
{
  ShapeKind kind = ShapeKind::SPHERE;
  double radius = 0.0;  ///< around the core; of the discs for a cylinder [m]
  double half_length = 0.0;  ///< capsule (core) and cylinder [m]
  Polyhedron core;  ///< empty for the half space
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the bounding box, shape frame [m]
  Eigen::Vector3d half_extent = Eigen::Vector3d::Zero();  ///< of the bounding box, shape frame [m]
  double bounding_radius = 0.0;  ///< of the sphere about center [m]
};

/**
 * @brief A mesh becomes one hull around all its parts.
 * @throws ModelError (mesh), std::invalid_argument (a size that is not positive)
 */
ConvexShape makeShape(const Geometry& geometry);
/** @brief A hull or flat polygon as shape. */
ConvexShape makeShape(Polyhedron polyhedron);

/** @brief Smallest n . x over the shape, n in the shape frame; -infinity for a half space unless n is its -z. */
double lowestAlong(const ConvexShape& shape, const Eigen::Vector3d& n);

}  // namespace frictional_contact_sim
