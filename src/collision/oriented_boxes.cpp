#include "oriented_boxes.h"

#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr double ROUND_OFF = 1e-12;  ///< relative to the sizes and distances: what is nearer than that is looked at
constexpr double SMALLEST_CROSS = 1e-4;  ///< squared sine: edges that are more parallel add nothing to the faces

/// Height of the box's lowest point above the plane z = 0.
double lowest(const ConvexShape& shape, const Eigen::Isometry3d& pose)
{
  const Eigen::RowVector3d up = pose.linear().row(2);
  return up * shape.center + pose.translation().z() - up.cwiseAbs() * shape.half_extent;
}
}  // namespace

bool boxesAreApart(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin)
{
  if (a.kind == ShapeKind::HALF_SPACE)
    return false;
  if (b.kind == ShapeKind::HALF_SPACE)
    return lowest(a, a_in_b) > margin + ROUND_OFF * (a_in_b.translation().norm() + a.bounding_radius);
  const Eigen::Matrix3d& turn = a_in_b.linear();  // column i: axis i of a in b's axes
  const Eigen::Matrix3d size = turn.cwiseAbs();
  const Eigen::Vector3d way = a_in_b * a.center - b.center;
  const double far = margin + ROUND_OFF * (way.norm() + a.bounding_radius + b.bounding_radius);
  const Eigen::Vector3d along_b = way.cwiseAbs() - size * a.half_extent - b.half_extent;
  if (along_b.maxCoeff() > far)
    return true;
  const Eigen::Vector3d way_a = turn.transpose() * way;
  const Eigen::Vector3d along_a = way_a.cwiseAbs() - size.transpose() * b.half_extent - a.half_extent;
  if (along_a.maxCoeff() > far)
    return true;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
    {
      // edge i of a cross edge j of b; its length is the sine between them
      const double square = 1.0 - turn(j, i) * turn(j, i);
      if (square < SMALLEST_CROSS)
        continue;
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double distance = std::abs(turn(j1, i) * way[j2] - turn(j2, i) * way[j1]);
      const double reach = a.half_extent[i1] * size(j, i2) + a.half_extent[i2] * size(j, i1) +
                           b.half_extent[j1] * size(j2, i) + b.half_extent[j2] * size(j1, i);
      if (distance - reach > far * std::sqrt(square))
        return true;
    }
  return false;
}

}  // namespace frictional_contact_sim
