// Points in one plane: the plane, and the convex polygon around them.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "polyhedron_topology.h"

namespace frictional_contact_sim
{
namespace
{
using Corners = std::vector<Eigen::Vector2d>;

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c)
{
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Counter-clockwise (Andrew's monotone chain, 1979).
Corners convexPolygon(Corners points)
{
  std::sort(points.begin(), points.end(),
            [](const Eigen::Vector2d& p, const Eigen::Vector2d& q)
            { return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y(); });
  Corners chain;
  for (int side = 0; side < 2; ++side)
  {
    const size_t start = chain.size();
    for (const Eigen::Vector2d& point : points)
    {
      while (chain.size() >= start + 2 && turn(chain[chain.size() - 2], chain.back(), point) <= 0.0)
        chain.pop_back();
      chain.push_back(point);
    }
    chain.pop_back();  // the first of the other side
    std::reverse(points.begin(), points.end());
  }
  return chain;
}

/// Leaves out corners within the tolerance of the line from the last one kept to the next one.
Corners withoutFlatCorners(const Corners& corners, double tolerance)
{
  Corners kept;
  const size_t size = corners.size();
  for (size_t k = 0; k < size; ++k)
  {
    const Eigen::Vector2d& last = kept.empty() ? corners[size - 1] : kept.back();
    const Eigen::Vector2d& next = k + 1 < size ? corners[k + 1] : kept.empty() ? corners[0] : kept.front();
    if (std::abs(turn(last, corners[k], next)) > tolerance * (next - last).norm())
      kept.push_back(corners[k]);
  }
  return kept.size() >= 3 ? kept : corners;
}
}  // namespace

CommonPlane commonPlane(const std::vector<Eigen::Vector3d>& points, double tolerance)
{
  const auto farthest = [&](const auto& distance)
  {
    const auto less = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) { return distance(p) < distance(q); };
    return *std::max_element(points.begin(), points.end(), less);
  };
  CommonPlane plane;
  const Eigen::Vector3d& start = points.front();
  plane.origin = farthest([&](const Eigen::Vector3d& p) { return (p - start).squaredNorm(); });
  const Eigen::Vector3d other = farthest([&](const Eigen::Vector3d& p) { return (p - plane.origin).squaredNorm(); });
  const Eigen::Vector3d along = (other - plane.origin).normalized();
  const auto fromLine = [&](const Eigen::Vector3d& p) { return along.cross(p - plane.origin).norm(); };
  const Eigen::Vector3d third = farthest(fromLine);
  plane.is_line = fromLine(third) <= tolerance;
  if (plane.is_line)
    return plane;
  plane.normal = (other - plane.origin).cross(third - plane.origin).normalized();
  int axis = 0;
  plane.normal.cwiseAbs().maxCoeff(&axis);
  if (plane.normal[axis] < 0.0)
    plane.normal = -plane.normal;
  const auto fromPlane = [&](const Eigen::Vector3d& p) { return std::abs(plane.normal.dot(p - plane.origin)); };
  plane.is_plane = fromPlane(farthest(fromPlane)) <= tolerance;
  return plane;
}

Polyhedron flatPolygon(const std::vector<Eigen::Vector3d>& points, const CommonPlane& plane, double tolerance)
{
  int axis = 0;
  plane.normal.cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3d x = (Eigen::Vector3d::Unit(axis) - plane.normal[axis] * plane.normal).normalized();
  const Eigen::Vector3d y = plane.normal.cross(x);
  Corners projected;
  for (const Eigen::Vector3d& point : points)
    projected.emplace_back(x.dot(point - plane.origin), y.dot(point - plane.origin));
  Polyhedron polygon;
  std::vector<int> front;
  std::vector<std::array<int, 2>> sides;
  const Corners corners = withoutFlatCorners(convexPolygon(projected), tolerance);
  const int size = static_cast<int>(corners.size());
  for (int k = 0; k < size; ++k)
  {
    polygon.vertices.push_back(plane.origin + corners[k].x() * x + corners[k].y() * y);
    front.push_back(k);
    sides.push_back({k, (k + 1) % size});
  }
  const std::vector<int> back(front.rbegin(), front.rend());
  completeTopology({front, back}, polygon);
  for (int face = 0; face < 2; ++face)
  {
    // one plane, seen from both sides, to the last bit
    polygon.faces[face].normal = (face == 0 ? 1.0 : -1.0) * plane.normal;
    polygon.faces[face].offset = (face == 0 ? 1.0 : -1.0) * plane.normal.dot(plane.origin);
  }
  polygon.slack = 1e-14 * (polygon.size + polygon.center.norm());  // round-off
  completeSearch(sides, polygon);
  polygon.is_flat = true;
  return polygon;
}

}  // namespace frictional_contact_sim
