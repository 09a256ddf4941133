#pragma once
/**
 * @file cylinder_view.h
 * @brief A cylinder in b's frame: caps, rims, generators. Shared by the files on cylinder contacts.
 */
#include <array>

#include "core_pair.h"
#include "curve_contact.h"
#include "cylinder_feature.h"

namespace frictional_contact_sim
{
struct CylinderView
{
  const CoreView& view;

  double radius() const { return view.shape->radius; }
  Eigen::Vector3d axis() const { return view.rotation.col(2); }
  /** @brief Outward normal of a cap. */
  Eigen::Vector3d capNormal(int cap) const { return cap == 0 ? Eigen::Vector3d(-axis()) : axis(); }
  Eigen::Vector3d capCenter(int cap) const { return view.translation + view.shape->half_length * capNormal(cap); }
  /** @brief The cap that looks along a direction. */
  int capTowards(const Eigen::Vector3d& direction) const { return axis().dot(direction) < 0.0 ? 0 : 1; }
  Circle rim(int cap) const { return {capCenter(cap), view.rotation.col(0), view.rotation.col(1), radius()}; }
  /** @brief Point of a rim farthest along a direction. */
  Eigen::Vector3d rimPoint(int cap, const Eigen::Vector3d& direction) const
  {
    const double x = direction.dot(view.rotation.col(0));
    const double y = direction.dot(view.rotation.col(1));
    const double length = std::hypot(x, y);
    return length > 0.0 ? Eigen::Vector3d(capCenter(cap) +
                                          radius() / length * (x * view.rotation.col(0) + y * view.rotation.col(1)))
                        : capCenter(cap);
  }
  /** @brief Sine of the angle between the axis and a unit vector. */
  double sine(const Eigen::Vector3d& n) const
  {
    return std::hypot(n.dot(view.rotation.col(0)), n.dot(view.rotation.col(1)));
  }
};

/// A flat feature of one shape as separating axis: a face of a polyhedron or the cap of a cylinder.
struct FlatAxis
{
  bool is_on_a = false;
  int face = -1;  ///< of the polyhedron; or
  int cap = -1;  ///< of the cylinder
  double separation = -std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< from b to a
};

/**
 * @brief Contacts of a cylinder with a flat feature, or of anything with the cap of a cylinder: points of the overlap
 * of the two features, gaps along the axis's normal. Adds the points within the margin.
 * @return false when nothing is over the flat feature
 */
bool addFlatContacts(const CorePair& pair, const FlatAxis& axis);

/// A stationary pair of a point of the rim or side of cylinder a and a point of b.
struct CurveContact
{
  double separation = -std::numeric_limits<double>::infinity();  ///< s(n) of the whole shapes
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d point_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d point_b = Eigen::Vector3d::Zero();
  Feature feature_a = 0;
  Feature feature_b = 0;
  bool is_on_axis_a = false;  ///< point_a still on the axis: moved to the side along the normal
  bool is_on_axis_b = false;
  bool is_crossing = false;  ///< of two nearly parallel lines: its place is noise
  bool is_proper = false;  ///< both points belong to their shapes
  bool is_end = false;  ///< end of a line on the side of the other
};

/// Stationary pairs near a direction.
struct CurveContacts
{
  CurveContact best;  ///< the one of largest separation
  std::array<CurveContact, 16> ends;  ///< for lines along each other: where the overlap ends
  int end_count = 0;
};

/**
 * @brief Contacts of rim or side of cylinder a with vertices, edges, rim or side of b near the direction n.
 * @param closest its vertices of b are the candidates (not for two cylinders)
 */
CurveContacts findCurveContacts(const CorePair& pair, const Eigen::Vector3d& n, const ClosestPoints& closest);

}  // namespace frictional_contact_sim
