// Shapes against the plane z = 0: exact, a few products a point.
#include <algorithm>
#include <cmath>

#include "cylinder_feature.h"
#include "frictional_contact_sim/collision/narrow_phase.h"
#include "polyhedron_search.h"

namespace frictional_contact_sim
{
namespace
{
constexpr Feature PLANE = makeFeature(FeatureKind::FACE, 0);
// Below this sine of the tilt the lowest rim point is noise, and the fixed rim points are within 1e-8 R of it.
constexpr double FLAT_SINE = 1e-7;
// Fixed rim points matter while the disc settles; at larger tilt the lowest point alone is exact.
constexpr double FIXED_RIM_SINE = 0.05;
// Upper end of the generator line: above 60 degrees of the axis the cylinder cannot come to lie on it soon.
constexpr double GENERATOR_SINE = 0.5;

void addPoint(const Eigen::Vector3d& surface_point, double margin, Feature feature, Manifold& manifold)
{
  const double gap = surface_point.z();
  if (gap <= margin)
    manifold.add({{surface_point.x(), surface_point.y(), 0.5 * gap}, Eigen::Vector3d::UnitZ(), gap, feature, PLANE});
}

void boxOnPlane(const ConvexShape& box, const Eigen::Isometry3d& pose, double margin, Manifold& manifold)
{
  // Of two corners joined by a nearly vertical edge the upper one is no contact to come, however thin the plate.
  const Eigen::Vector3d up = pose.linear().row(2).transpose();
  int fixed_bit = -1;
  for (int i = 0; i < 3; ++i)
    fixed_bit = std::abs(up[i]) > 0.9 ? i : fixed_bit;
  for (int corner = 0; corner < 8; ++corner)
  {
    const bool is_upper = fixed_bit >= 0 && (((corner >> fixed_bit) & 1) == 1) == (up[fixed_bit] > 0.0);
    if (!is_upper)
      addPoint(pose * box.core.vertices[corner], margin, makeFeature(FeatureKind::VERTEX, corner), manifold);
  }
}

void roundedOnPlane(const ConvexShape& shape, const Eigen::Isometry3d& pose, double margin, Manifold& manifold)
{
  const Eigen::Vector3d up = pose.linear().row(2).transpose();
  const double height = pose.translation().z() - shape.radius;
  verticesBelow(shape.core, up, margin - height + 1e-12 * (margin + std::abs(height)), manifold.search);
  for (const int v : manifold.search.found)
  {
    const double gap = up.dot(shape.core.vertices[v]) + height;
    if (gap <= margin)
    {
      Eigen::Vector3d point = pose * shape.core.vertices[v];
      point.z() = gap;
      addPoint(point, margin, makeFeature(FeatureKind::VERTEX, v), manifold);
    }
  }
}

void cylinderOnPlane(const ConvexShape& shape, const Eigen::Isometry3d& pose, double margin, Manifold& manifold)
{
  const Eigen::Vector3d axis = pose.linear().col(2);
  const int low_cap = axis.z() > 0.0 ? 0 : 1;
  const Eigen::Vector3d to_low = (low_cap == 0 ? -shape.half_length : shape.half_length) * axis;
  const Eigen::Vector3d low_center = pose.translation() + to_low;
  // sine of the tilt from the two horizontal axes' heights: accurate where 1 - axis_z^2 is not
  const double sine = std::hypot(pose.linear()(2, 0), pose.linear()(2, 1));
  const bool has_lowest = sine > FLAT_SINE;
  int nearest_fixed = -1;
  if (has_lowest)
  {
    // downwards within the disc, in the cylinder frame: its height is exactly -radius * sine
    const Eigen::Vector3d down(-pose.linear()(2, 0) / sine, -pose.linear()(2, 1) / sine, 0.0);
    const Eigen::Vector3d radial = shape.radius * (pose.linear() * down);
    addPoint(low_center + radial, margin, lowestRimFeature(low_cap), manifold);
    if (std::abs(axis.z()) < GENERATOR_SINE)
      addPoint(pose.translation() - to_low + radial, margin, lowestRimFeature(1 - low_cap), manifold);
    const double angle = std::atan2(down.y(), down.x());
    nearest_fixed = (static_cast<int>(std::lround(angle / (0.25 * M_PI))) + RIM_POINTS) % RIM_POINTS;
  }
  if (sine < FIXED_RIM_SINE)
  {
    for (int k = 0; k < RIM_POINTS; ++k)
    {
      if (k != nearest_fixed)  // the lowest point stands for it
      {
        addPoint(low_center + shape.radius * (pose.linear() * rimDirection(k)), margin, fixedRimFeature(low_cap, k),
                 manifold);
      }
    }
  }
}
}  // namespace

void collideHalfSpace(const ConvexShape& a, const Eigen::Isometry3d& a_in_b, double margin, Manifold& manifold)
{
  if (a.kind == ShapeKind::BOX)
    boxOnPlane(a, a_in_b, margin, manifold);
  else if (a.kind == ShapeKind::CYLINDER)
    cylinderOnPlane(a, a_in_b, margin, manifold);
  else if (a.kind != ShapeKind::HALF_SPACE)
    roundedOnPlane(a, a_in_b, margin, manifold);
  if (manifold.count > MAX_PAIR_POINTS)
  {
    // Tangents fixed in the body (the two axes most across the normal): turning about the normal changes no choice.
    int axis = 0;
    a_in_b.linear().row(2).cwiseAbs().maxCoeff(&axis);
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << a_in_b.linear().col((axis + 1) % 3), a_in_b.linear().col((axis + 2) % 3);
    reduceManifold(tangents, a.bounding_radius, manifold);
  }
}

}  // namespace frictional_contact_sim
