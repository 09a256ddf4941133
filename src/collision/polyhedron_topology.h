#pragma once
/**
 * @file polyhedron_topology.h
 * @brief Shared by the files that make polyhedra: polyhedron.cpp, convex_hull.cpp, flat_polygon.cpp.
 */
#include <array>
#include <vector>

#include "frictional_contact_sim/collision/polyhedron.h"

namespace frictional_contact_sim
{
/** @brief Fills faces, edges, neighbours and bounds from the vertices and the corner loops of the faces. */
void completeTopology(const std::vector<std::vector<int>>& loops, Polyhedron& polyhedron);

/**
 * @brief Fills links and starts, what searches along edges need (polyhedron_search.h).
 * @param pairs vertices that are joined, each pair once or twice, in any order
 */
void completeSearch(const std::vector<std::array<int, 2>>& pairs, Polyhedron& polyhedron);

/**
 * @brief The first point of every cluster of points within the tolerance of it. O(n), the order of the points decides.
 * @param numbers takes, if wanted, which of them each point has become
 */
std::vector<Eigen::Vector3d> weld(const std::vector<Eigen::Vector3d>& points, double tolerance,
                                  std::vector<int>* numbers = nullptr);
/** @brief What single-precision files cannot tell from one point or one plane. */
struct Precision
{
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the bounding box [m]
  double size = 0.0;  ///< half its diagonal; not a number or infinite when a point is [m]
  double weld = 0.0;  ///< [m]
  double coplanar = 0.0;  ///< [m]
};
Precision precisionOf(const std::vector<Eigen::Vector3d>& points);

/** @brief A triangle of a hull; its neighbour k is across the side opposite corner k. Counter-clockwise from outside.
 */
struct HullTriangle
{
  std::array<int, 3> corner;
  std::array<int, 3> neighbour;
};
/** @brief A closed surface of triangles around points: convex for points that are moved by at most `joggle` an axis. */
struct HullSurface
{
  std::vector<HullTriangle> triangles;
  double joggle = 0.0;  ///< [m]
};
/** @brief Quickhull. Points around the origin, not in one plane. @throws std::invalid_argument */
HullSurface hullSurface(const std::vector<Eigen::Vector3d>& points);

/** @brief The plane that points within the tolerance of it lie in. */
struct CommonPlane
{
  bool is_line = false;  ///< they even lie on one line
  bool is_plane = false;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, its largest component positive
};
CommonPlane commonPlane(const std::vector<Eigen::Vector3d>& points, double tolerance);
/** @brief Convex polygon of points in a plane, seen from both sides; corners within the tolerance of a line go. */
Polyhedron flatPolygon(const std::vector<Eigen::Vector3d>& points, const CommonPlane& plane, double tolerance);
}  // namespace frictional_contact_sim
