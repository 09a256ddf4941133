#pragma once
/**
 * @file core_view.h
 * @brief The core of a shape seen from b's frame, and the closest points of two cores (GJK).
 *
 * Source: Gilbert, Johnson, Keerthi, IEEE J. Robotics Automation 4(2), 1988. GJK is used for the combination of
 * features only; gaps and normals are recomputed from the features.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
struct CoreView
{
  const ConvexShape* shape = nullptr;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double shrink = 1.0;  ///< about the interior point: 1 = the core itself, 0 = its interior point

  const Polyhedron& core() const { return shape->core; }
  Eigen::Vector3d vertex(int index) const { return rotation * shape->core.vertices[index] + translation; }
  Eigen::Vector3d interior() const { return rotation * shape->core.interior + translation; }
  /** @brief Farthest point along direction. @return its vertex, -1 on a cylinder */
  int support(const Eigen::Vector3d& direction, Eigen::Vector3d& point) const;
  /** @brief The same, exact: support() may be Polyhedron::slack short. Of several vertices the first. */
  int exactSupport(const Eigen::Vector3d& direction, Eigen::Vector3d& point) const;
};

/** @brief Size that tolerances of a pair are of: the smaller one that is not a point [m]. */
inline double smallerSize(const ConvexShape& a, const ConvexShape& b)
{
  const double smaller = std::min(a.bounding_radius, b.bounding_radius);
  return smaller > 0.0 ? smaller : std::max(a.bounding_radius, b.bounding_radius);
}

/** @brief s(n) = min over a of n . x - max over b of n . x: a lower bound of the distance for every unit n. */
double separation(const CoreView& a, const CoreView& b, const Eigen::Vector3d& n);

/** @brief Result of GJK: the simplex of the difference a - b that carries the closest point. */
struct ClosestPoints
{
  bool are_apart = false;
  Eigen::Vector3d difference = Eigen::Vector3d::Zero();  ///< point of a minus point of b
  Eigen::Vector3d point_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d point_b = Eigen::Vector3d::Zero();
  int count = 0;
  std::array<int, 4> vertex_a{};  ///< of the simplex
  std::array<int, 4> vertex_b{};
};

/** @brief Closest points; are_apart is false when the cores overlap or are nearer than 1e-12 of their size. */
ClosestPoints closestPoints(const CoreView& a, const CoreView& b);

/**
 * @brief Direction from b to a of largest separation s(n): globally the closest direction when the cores are apart,
 * a local maximum (seen from the shapes a little shrunk) when they touch or overlap.
 *
 * Touching cores, the normal case in a simulation, give GJK no direction. So (1) a is shrunk about its interior point
 * until GJK sees a distance; (2) n <- direction of the closest points of a moved away by t n, until n stays: this is
 * the proximal point iteration max s(n') + t n . n', its fixed points are the local maxima of s. Two or three rounds.
 * @param closest simplex of the last call: the features at n
 */
Eigen::Vector3d separatingDirection(const CoreView& a, const CoreView& b, ClosestPoints& closest);

}  // namespace frictional_contact_sim
