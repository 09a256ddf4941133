#include "core_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyhedron_search.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double DEEP = 1e-3;  // times the size: overlap that no simulation step leaves behind
// Times the size: a point so near the plane of a flat polygon is in front of it, whatever the round-off says.
constexpr double IN_FRONT = 1e-9;

Eigen::Vector3d cylinderPoint(const ConvexShape& shape, const Eigen::Vector3d& direction)
{
  const double radial = std::hypot(direction.x(), direction.y());
  const double scale = radial > 0.0 ? shape.radius / radial : 0.0;
  return {scale * direction.x(), scale * direction.y(), direction.z() < 0.0 ? -shape.half_length : shape.half_length};
}

Eigen::Vector3d transformed(const CoreView& view, const Eigen::Vector3d& point)
{
  if (view.shrink == 1.0)
    return view.rotation * point + view.translation;
  const Eigen::Vector3d& interior = view.shape->core.interior;
  return view.rotation * (interior + view.shrink * (point - interior)) + view.translation;
}
}  // namespace

int CoreView::support(const Eigen::Vector3d& direction, Eigen::Vector3d& point) const
{
  const Eigen::Vector3d local = rotation.transpose() * direction;
  int index = -1;
  switch (shape->kind)
  {
    case ShapeKind::CYLINDER:
      point = transformed(*this, cylinderPoint(*shape, local));
      return -1;
    case ShapeKind::BOX:
      index = (local.x() > 0.0 ? 1 : 0) | (local.y() > 0.0 ? 2 : 0) | (local.z() > 0.0 ? 4 : 0);
      break;
    default:
      index = nearlyFarthestVertex(shape->core, local);
  }
  point = transformed(*this, shape->core.vertices[index]);
  return index;
}

int CoreView::exactSupport(const Eigen::Vector3d& direction, Eigen::Vector3d& point) const
{
  if (shape->kind != ShapeKind::HULL)
    return support(direction, point);
  const int index = farthestVertex(shape->core, rotation.transpose() * direction);
  point = transformed(*this, shape->core.vertices[index]);
  return index;
}

double separation(const CoreView& a, const CoreView& b, const Eigen::Vector3d& n)
{
  Eigen::Vector3d low_a;
  Eigen::Vector3d high_b;
  a.exactSupport(-n, low_a);
  b.exactSupport(n, high_b);
  return n.dot(low_a - high_b);
}

namespace
{
/// Size to compare with: the smaller extended core of the two.
double coreSize(const CoreView& a, const CoreView& b)
{
  return smallerSize(*a.shape, *b.shape);
}

/// Direction to leave b from a point inside it: the nearest face, or the nearest side of a cylinder.
Eigen::Vector3d wayOut(const CoreView& b, const Eigen::Vector3d& point)
{
  const Eigen::Vector3d local = b.rotation.transpose() * (point - b.translation);
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  if (b.shape->kind == ShapeKind::CYLINDER)
  {
    const double radial = std::hypot(local.x(), local.y());
    if (radial - b.shape->radius > std::abs(local.z()) - b.shape->half_length && radial > 0.0)
      best = Eigen::Vector3d(local.x() / radial, local.y() / radial, 0.0);
    else
      best.z() = local.z() < 0.0 ? -1.0 : 1.0;
  }
  double largest = -std::numeric_limits<double>::infinity();
  const double tie = b.core().is_flat ? IN_FRONT * b.core().size : 0.0;
  for (const Polyhedron::Face& face : b.core().faces)
  {
    const double distance = face.normal.dot(local) - face.offset;
    if (distance > largest + tie)
    {
      largest = distance;
      best = face.normal;
    }
  }
  return b.rotation * best;
}

bool isSolid(const CoreView& view)
{
  return view.shape->kind == ShapeKind::CYLINDER || (!view.core().faces.empty() && !view.core().is_flat);
}

Eigen::Vector3d firstDirection(const CoreView& a, const CoreView& b)
{
  for (double shrink : {0.99, 0.9, 0.5, 0.0})
  {
    // a polygon, segment or point in the surface of b gains nothing from being shrunk itself
    CoreView small_a = a;
    CoreView small_b = b;
    (isSolid(a) ? small_a : small_b).shrink = shrink;
    const ClosestPoints closest = closestPoints(small_a, small_b);
    if (closest.are_apart)
      return closest.difference.normalized();
  }
  return isSolid(a) && !isSolid(b) ? Eigen::Vector3d(-wayOut(a, b.interior())) : wayOut(b, a.interior());
}

/// Deep overlap has many local maxima: the best of all face normals, caps and the direction given.
Eigen::Vector3d bestStart(const CoreView& a, const CoreView& b, const Eigen::Vector3d& start)
{
  Eigen::Vector3d best = start;
  double largest = separation(a, b, start);
  const auto offer = [&](const Eigen::Vector3d& n, double distance)
  {
    if (distance > largest)
    {
      largest = distance;
      best = n;
    }
  };
  for (const CoreView* view : {&a, &b})
  {
    const CoreView& other = view == &a ? b : a;
    const double sign = view == &a ? -1.0 : 1.0;
    for (const Polyhedron::Face& face : view->core().faces)
    {
      const Eigen::Vector3d outwards = view->rotation * face.normal;
      Eigen::Vector3d nearest;
      other.support(-outwards, nearest);
      offer(sign * outwards, outwards.dot(nearest - view->translation) - face.offset);
    }
    if (view->shape->kind == ShapeKind::CYLINDER)
    {
      const Eigen::Vector3d axis = view->rotation.col(2);
      offer(axis, separation(a, b, axis));
      offer(-axis, separation(a, b, -axis));
    }
  }
  return best;
}
}  // namespace

Eigen::Vector3d separatingDirection(const CoreView& a, const CoreView& b, ClosestPoints& closest)
{
  const double size = coreSize(a, b);
  closest = closestPoints(a, b);
  if (closest.are_apart && closest.difference.norm() > 1e-7 * size)
    return closest.difference.normalized();
  const auto is_point = [](const CoreView& view) { return view.core().vertices.size() == 1; };
  if (is_point(a) || is_point(b))
    return is_point(a) ? wayOut(b, a.translation) : Eigen::Vector3d(-wayOut(a, b.translation));
  Eigen::Vector3d n = firstDirection(a, b);
  if (separation(a, b, n) < -DEEP * size)
    n = bestStart(a, b, n);
  for (int round = 0; round < 20; ++round)
  {
    CoreView moved = a;
    const double shift = std::max(0.0, 1e-2 * size - separation(a, b, n));
    moved.translation += shift * n;
    const ClosestPoints next = closestPoints(moved, b);
    if (!next.are_apart)
      break;
    const Eigen::Vector3d direction = next.difference.normalized();
    closest = next;
    const bool has_settled = (direction - n).norm() < 1e-9;
    n = direction;
    if (has_settled)
      break;
  }
  return n;
}

}  // namespace frictional_contact_sim
