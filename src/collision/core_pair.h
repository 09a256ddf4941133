#pragma once
/**
 * @file core_pair.h
 * @brief Contacts between the features of two rounded cores, in b's frame: shared by the files of the narrow phase.
 */
#include "core_view.h"
#include "frictional_contact_sim/collision/narrow_phase.h"

namespace frictional_contact_sim
{
struct CorePair
{
  CoreView a;
  CoreView b;
  double margin;
  double size;  ///< of the smaller core that is not a point, for tolerances [m]
  Manifold& manifold;
  double radius_a;  ///< around the core of a; 0 for a cylinder, which is its own core
  double radius_b;

  CorePair(const ConvexShape& shape_a, const ConvexShape& shape_b, const Eigen::Isometry3d& a_in_b, double gap_margin,
           Manifold& contacts);
  double radii() const { return radius_a + radius_b; }

  /** @brief Adds the contact of two points of the cores when gap <= margin; n from b to a. */
  void add(const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b, const Eigen::Vector3d& n, Feature feature_a,
           Feature feature_b) const;
};

/// A face of one of the two as separating axis.
struct FaceAxis
{
  bool is_on_a = false;
  int face = -1;
  double separation = -std::numeric_limits<double>::infinity();  ///< of the cores [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< from b to a
};

/** @brief Face of a shape best aligned with a direction that leaves it, -1 without faces. */
int alignedFace(const CoreView& view, const Eigen::Vector3d& direction);
/** @brief The face's normal as axis between the cores; separation -infinity when face is -1. */
FaceAxis faceAxis(const CorePair& pair, bool is_on_a, int face);
/** @brief Sine of the angle between unit vectors, 2 beyond 90 degrees. */
double angleBetween(const Eigen::Vector3d& n, const Eigen::Vector3d& other);
/** @brief Corners of a face and outward normals of its sides into the workspace. */
void setSides(const CoreView& view, const Polyhedron::Face& face, const Eigen::Vector3d& outwards, Manifold& work);
/** @brief Whether a point is between the sides set last. */
bool isInsideSides(const Eigen::Vector3d& point, double tolerance, const Manifold& work);
constexpr double SIDE_TOLERANCE = 1e-8;  ///< times the size: points this near a side are on it

/**
 * @brief Of the look-ahead points from `found` on, drops those that are not behind the points from `first` to `found`:
 * same features, within 1e-2 of the size, or a smaller gap (in an overlap, along a direction that is not the best).
 */
void dropDuplicates(const CorePair& pair, int first, int found);
/** @brief reduceManifold with tangents across the first normal, fixed in b. */
void reduceAcross(const CorePair& pair);

/**
 * @brief The features of the other shape that face the reference face, clipped against its sides (Sutherland, Hodgman
 * 1974); gaps along its normal. Adds the points within the margin.
 * @return false when nothing is over the face
 */
bool clipAgainstFace(const CorePair& pair, const FaceAxis& axis);

/// Vertices of an edge; both the same: a vertex.
struct EdgeEnds
{
  int first;
  int second;
};

/**
 * @brief Closest points of two edges or vertices, adds the contact; near-parallel edges give the ends of the overlap.
 * @param n direction from b to a: decides the side when the features touch or overlap
 * @param is_side_known n tells outside from inside (a solid is involved); else the closest points are never inside
 */
void addEdgeContacts(const CorePair& pair, const EdgeEnds& on_a, const EdgeEnds& on_b, const Eigen::Vector3d& n,
                     bool is_side_known = true);

/** @brief The contact of the supporting points along n; gap = s(n), exact whatever the features. */
void addSupportContact(const CorePair& pair, const Eigen::Vector3d& n);
/** @brief Smallest gap of the points from `first` on, +infinity for none. */
double deepestGap(const CorePair& pair, int first);

/// Points of two lines p + s d, q + t e nearest to each other. Not for parallel lines.
struct LineParameters
{
  double s;
  double t;
};
LineParameters closestOnLines(const Eigen::Vector3d& p, const Eigen::Vector3d& d, const Eigen::Vector3d& q,
                              const Eigen::Vector3d& e);

}  // namespace frictional_contact_sim
