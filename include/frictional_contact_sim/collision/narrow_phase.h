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
#include <array>
#include <cstdint>

#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
constexpr int MAX_PAIR_POINTS = 8;

/// Number of a feature of one shape: kind in the two high bits, index in the other 14.
using Feature = std::uint16_t;
enum class FeatureKind
{
  VERTEX,
  EDGE,
  FACE,
  CURVE  ///< points of a cylinder's rim and side, see CylinderFeature
};
constexpr Feature makeFeature(FeatureKind kind, int index)
{
  return static_cast<Feature>((static_cast<int>(kind) << 14) | (index & 0x3fff));
}

struct PairContact
{
  Eigen::Vector3d position;  ///< midway between the surfaces [m]
  Eigen::Vector3d normal;  ///< unit, from b to a
  double gap = 0.0;  ///< [m]
  Feature feature_a = 0;
  Feature feature_b = 0;
};

/** @brief Candidates of one pair; reduced to MAX_PAIR_POINTS at the end. */
struct Manifold
{
  static constexpr int CAPACITY = 512;
  std::array<PairContact, CAPACITY> points;
  int count = 0;

  void add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, double gap, Feature feature_a,
           Feature feature_b)
  {
    if (count < CAPACITY)
    {
      points[count++] = {position, normal, gap, feature_a, feature_b};
    }
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
