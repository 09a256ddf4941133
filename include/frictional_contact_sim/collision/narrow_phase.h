#pragma once
/**
 * @file narrow_phase.h
 * @brief Contact points of one pair of shapes, in closed form from the features that support the contact.
 *
 * Everything is in the frame of shape b, so the result does not lose digits far from the world's origin. The functions
 * have no memory: the same relative pose gives the same bits, whatever happened before (state reset, replay).
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "frictional_contact_sim/collision/contact_id.h"
#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
constexpr int MAX_PAIR_POINTS = 8;

struct PairContact
{
  Eigen::Vector3d position;  ///< midway between the surfaces [m]
  Eigen::Vector3d normal;  ///< unit, from b to a
  double gap = 0.0;  ///< [m]
  Feature feature_a = 0;
  Feature feature_b = 0;
};

/** @brief A corner of a polygon that is being clipped. */
struct ClipPoint
{
  Eigen::Vector3d position;
  Feature incident;  ///< on the shape whose face is clipped
  Feature reference;  ///< on the shape it is clipped against
  int edge;  ///< towards the next corner: edge of the incident shape, or -1 - k for side k of the reference
};

/** @brief Candidates of one pair, reduced to MAX_PAIR_POINTS at the end, and workspace: grows, never shrinks. */
struct Manifold
{
  std::vector<PairContact> points = std::vector<PairContact>(64);
  int count = 0;
  std::vector<char> is_kept;
  std::vector<ClipPoint> polygon;
  std::vector<ClipPoint> clipped;
  std::vector<Eigen::Vector3d> corners;  ///< of the reference face
  std::vector<Eigen::Vector3d> side_normals;  ///< outwards, in the plane of the reference face
  VertexSearch search;

  /** @brief Room for shapes with up to this many vertices, so that no later call allocates. */
  void reserve(size_t vertices);
  void add(const PairContact& point)
  {
    if (count == static_cast<int>(points.size()))
      points.resize(2 * points.size());
    points[count++] = point;
  }
};

/**
 * @brief Contact points with gap <= margin, at most MAX_PAIR_POINTS, ordered by (feature_a, feature_b).
 * @param a_in_b pose of a's frame in b's
 */
void collide(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin,
             Manifold& manifold);

/**
 * @brief Keeps at most MAX_PAIR_POINTS: the touching ones first (within 1e-6 size of the deepest; of many, the extreme
 * ones in eight directions across the normal, fixed in the frame `tangents`), then by gap. Ties within round-off go to
 * the earlier point, so that the choice does not flicker.
 */
void reduceManifold(const Eigen::Matrix<double, 3, 2>& tangents, double size, Manifold& manifold);

/** @brief Sorts by (feature_a, feature_b). */
void sortManifold(Manifold& manifold);

/** @brief Shape a against the half space z <= 0 of b's frame. */
void collideHalfSpace(const ConvexShape& a, const Eigen::Isometry3d& a_in_b, double margin, Manifold& manifold);

/** @brief Spheres, capsules, boxes, hulls against each other. */
void collideRounded(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin,
                    Manifold& manifold);

/** @brief Cylinder a against sphere, capsule, box, hull or cylinder b. */
void collideCylinder(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin,
                     Manifold& manifold);

}  // namespace frictional_contact_sim
