#pragma once
/**
 * @file convex_solid.h
 * @brief A collision geometry as a solid of points, for checks that must share no code with collision/: how deep a
 * point is in it, and points of its surface.
 *
 * Depth of a point p (shape frame, [m], positive inside, concave everywhere, so its maximum over a convex set is the
 * only one):  sphere R - |p|,  box min_i (h_i - |p_i|),  cylinder min(R - |p_xy|, l - |p_z|),  capsule R - distance to
 * the axis,  mesh min_i (d_i - n_i . p) over the planes of the convex hull of its vertices. The hull is found here, by
 * Quickhull (Barber, Dobkin, Huhdanpaa 1996) with every d_i the largest n_i . x over all vertices; a mesh's vertices,
 * part by part, are the only thing taken from collision/. A flat polygon has points and no inside.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "frictional_contact_sim/model/geometry.h"

namespace frictional_contact_sim
{
namespace test_support
{
struct Plane
{
  Eigen::Vector3d normal;  ///< unit, outwards
  double offset;  ///< normal . x <= offset for all points [m]
};

/** @brief Planes and triangles (of point indices) of the convex hull; empty for points in one plane. */
struct Hull
{
  std::vector<Plane> planes;
  std::vector<std::array<int, 3>> triangles;
};
Hull convexHullOf(const std::vector<Eigen::Vector3d>& points);

class ConvexSolid
{
public:
  explicit ConvexSolid(const Geometry& geometry);
  /** @brief The hull of some points. */
  explicit ConvexSolid(const std::vector<Eigen::Vector3d>& vertices);
  /** @brief One solid, for a mesh one for each of its parts. */
  static std::vector<ConvexSolid> solidsOf(const Geometry& geometry);

  double depth(const Eigen::Vector3d& point) const;
  /** @brief Largest -n . x over the solid (n unit, shape frame): how far it reaches against n. Exact. */
  double reachAgainst(const Eigen::Vector3d& n) const;
  /** @brief Nearest point of the solid, where the surface is curved and samples alone would miss its lowest point. */
  Eigen::Vector3d nearest(const Eigen::Vector3d& point) const;

  bool curved = false;
  std::vector<Eigen::Vector3d> points;  ///< corners of a polytope first, then samples of faces or of the curved surface
  std::vector<std::array<int, 2>> edges;  ///< of a polytope
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the bounding sphere
  double radius = 0.0;

private:
  void addBox(const Box& box);
  void addRound(double cap_radius, double half_length, bool flat);
  void addHull(const std::vector<Eigen::Vector3d>& all);

  Geometry geometry_;
  Hull hull_;
};

}  // namespace test_support
}  // namespace frictional_contact_sim
