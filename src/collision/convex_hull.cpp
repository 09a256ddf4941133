// Convex hulls: the triangles of Quickhull merged to polygonal faces, vertices that change nothing left out.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "frictional_contact_sim/collision/polyhedron.h"
#include "polyhedron_topology.h"

namespace frictional_contact_sim
{
namespace
{
// Of a fine mesh a second hull, without the vertices that change nothing, is made when that leaves so few.
constexpr int FINE = 1000;
constexpr double WORTH_A_HULL = 0.9;

Eigen::Vector3d areaVector(const std::vector<Eigen::Vector3d>& points, const HullTriangle& triangle)
{
  const Eigen::Vector3d& origin = points[triangle.corner[0]];
  return (points[triangle.corner[1]] - origin).cross(points[triangle.corner[2]] - origin);
}

/// Triangles grown together to faces, and what has become of the vertices.
class FaceMerger
{
public:
  FaceMerger(const std::vector<Eigen::Vector3d>& points, const std::vector<HullTriangle>& triangles, double tolerance)
    : points_(points), triangles_(triangles), tolerance_(tolerance), face_(triangles.size(), -1)
  {
    grow();
    loops_.resize(members_.size());
    for (size_t f = 0; f < members_.size(); ++f)
      loops_[f] = boundary(static_cast<int>(f));
    // what is no convex polygon stays triangles: a strip left over between two faces, a face with a hole, the rim of a
    // plate so thin that its two sides are in one plane
    const size_t count = members_.size();
    for (size_t f = 0; f < count; ++f)
      if (!isConvexPolygon(static_cast<int>(f)))
        split(static_cast<int>(f));
  }

  const std::vector<std::vector<int>>& loops() const { return loops_; }

  /// Of every point: the number of faces it is a corner of. Less than three: inside a face or on an edge.
  std::vector<int> facesAtPoint() const
  {
    std::vector<int> faces(points_.size(), 0);
    for (const std::vector<int>& loop : loops_)
      for (const int vertex : loop)
        ++faces[vertex];
    return faces;
  }

  /// Of every point: whether the hull changes by more than the tolerance without it.
  std::vector<char> neededPoints() const
  {
    const std::vector<int> faces = facesAtPoint();
    std::vector<char> is_needed(points_.size(), 0);
    for (size_t p = 0; p < faces.size(); ++p)
      is_needed[p] = faces[p] >= 3 ? 1 : 0;
    for (const std::vector<int>& loop : loops_)
      for (const int vertex : loop)
        if (faces[vertex] < 3 && !isOnEdge(vertex, loop, faces))
          is_needed[vertex] = 1;
    return is_needed;
  }

  /// Afterwards every vertex is the corner of a face.
  void splitFacesWithVerticesInside()
  {
    const std::vector<int> faces = facesAtPoint();
    for (size_t t = 0; t < triangles_.size(); ++t)
      for (const int vertex : triangles_[t].corner)
        if (faces[vertex] == 0 && members_[face_[t]].size() > 1)
          split(face_[t]);
  }

private:
  /// Two faces that are nearly one plane meet in any line: only on a straight one a corner of two faces is idle.
  bool isOnEdge(int vertex, const std::vector<int>& loop, const std::vector<int>& faces) const
  {
    const size_t size = loop.size();
    const size_t at = static_cast<size_t>(std::find(loop.begin(), loop.end(), vertex) - loop.begin());
    const auto corner = [&](size_t step)
    {
      size_t k = (at + step) % size;
      while (k != at && faces[loop[k]] < 3)
        k = (k + step) % size;
      return loop[k];
    };
    const int next = corner(1);
    const int last = corner(size - 1);
    if (next == vertex || next == last)
      return false;
    const Eigen::Vector3d along = points_[next] - points_[last];
    return along.cross(points_[vertex] - points_[last]).norm() <= tolerance_ * along.norm();
  }

  /// From the largest triangles on: their planes are the most accurate. All points are below a triangle's plane.
  void grow()
  {
    std::vector<std::pair<double, int>> order;
    for (size_t t = 0; t < triangles_.size(); ++t)
      order.emplace_back(-areaVector(points_, triangles_[t]).norm(), static_cast<int>(t));
    std::sort(order.begin(), order.end());
    for (const auto& [area, seed] : order)
    {
      if (face_[seed] >= 0)
        continue;
      const Eigen::Vector3d normal = areaVector(points_, triangles_[seed]).normalized();
      const double offset = normal.dot(points_[triangles_[seed].corner[0]]);
      const auto isCoplanar = [&](int t)
      {
        return std::all_of(triangles_[t].corner.begin(), triangles_[t].corner.end(),
                           [&](int v) { return std::abs(normal.dot(points_[v]) - offset) <= tolerance_; });
      };
      const int number = static_cast<int>(members_.size());
      std::vector<int> members = {seed};
      face_[seed] = number;
      for (size_t k = 0; k < members.size(); ++k)
        for (const int next : triangles_[members[k]].neighbour)
          if (face_[next] < 0 && isCoplanar(next))
          {
            face_[next] = number;
            members.push_back(next);
          }
      members_.push_back(members);
    }
  }

  /// Corners around a face, empty when they are no single loop.
  std::vector<int> boundary(int face) const
  {
    std::vector<std::pair<int, int>> sides;
    for (const int t : members_[face])
      for (int k = 0; k < 3; ++k)
        if (face_[triangles_[t].neighbour[k]] != face)
          sides.emplace_back(triangles_[t].corner[(k + 1) % 3], triangles_[t].corner[(k + 2) % 3]);
    std::sort(sides.begin(), sides.end());
    std::vector<int> loop;
    size_t at = 0;
    for (size_t k = 0; k < sides.size(); ++k)
    {
      if (k > 0 && sides[k].first == sides[k - 1].first)
        return {};  // touches itself in a vertex
      loop.push_back(sides[at].first);
      const auto next = std::lower_bound(sides.begin(), sides.end(), std::make_pair(sides[at].second, -1));
      at = static_cast<size_t>(next - sides.begin());
      if (at == 0 && k + 1 < sides.size())
        return {};  // more than one loop
    }
    return loop;
  }

  bool isConvexPolygon(int face) const
  {
    const std::vector<int>& loop = loops_[face];
    const size_t size = loop.size();
    if (members_[face].size() == 1)
      return true;
    if (size < 3)
      return false;
    const Eigen::Vector3d normal = areaVector(points_, triangles_[members_[face].front()]).normalized();
    for (size_t k = 0; k < size; ++k)
    {
      const Eigen::Vector3d& last = points_[loop[(k + size - 1) % size]];
      const Eigen::Vector3d along = points_[loop[(k + 1) % size]] - last;
      const double outside = along.cross(normal).dot(points_[loop[k]] - last);
      if (outside < -tolerance_ * along.norm())
        return false;
    }
    return std::all_of(members_[face].begin(), members_[face].end(),
                       [&](int t) { return isInside(triangles_[t], loop, normal); });
  }

  bool isInside(const HullTriangle& triangle, const std::vector<int>& loop, const Eigen::Vector3d& normal) const
  {
    for (size_t k = 0; k < loop.size(); ++k)
    {
      const Eigen::Vector3d& from = points_[loop[k]];
      const Eigen::Vector3d along = points_[loop[(k + 1) % loop.size()]] - from;
      const Eigen::Vector3d outwards = along.cross(normal);
      for (const int v : triangle.corner)
        if (outwards.dot(points_[v] - from) > tolerance_ * along.norm())
          return false;
    }
    return true;
  }

  void split(int face)
  {
    const std::vector<int> members = members_[face];
    for (const int t : members)
    {
      const int number = t == members.front() ? face : static_cast<int>(members_.size());
      if (number != face)
      {
        members_.emplace_back();
        loops_.emplace_back();
      }
      members_[number] = {t};
      loops_[number].assign(triangles_[t].corner.begin(), triangles_[t].corner.end());
      face_[t] = number;
    }
  }

  const std::vector<Eigen::Vector3d>& points_;
  const std::vector<HullTriangle>& triangles_;
  double tolerance_;
  std::vector<int> face_;  ///< of every triangle
  std::vector<std::vector<int>> members_;  ///< triangles of every face, its seed first
  std::vector<std::vector<int>> loops_;
};

std::vector<Eigen::Vector3d> chosen(const std::vector<Eigen::Vector3d>& points, const std::vector<char>& is_chosen)
{
  std::vector<Eigen::Vector3d> corners;
  for (size_t p = 0; p < points.size(); ++p)
    if (is_chosen[p])
      corners.push_back(points[p]);
  return corners;
}

/// Numbers the vertices that the surface has in the order of the points.
std::vector<int> numbersOf(size_t points, const HullSurface& surface)
{
  std::vector<int> number(points, -1);
  for (const HullTriangle& triangle : surface.triangles)
    for (const int vertex : triangle.corner)
      number[vertex] = 0;
  int count = 0;
  for (int& entry : number)
    entry = entry < 0 ? -1 : count++;
  return number;
}

/// Slivers have no normal of their own: the best one around an edge of theirs is as good as any.
void repairNormals(double size, Polyhedron& hull)
{
  const std::vector<Polyhedron::Face> before = hull.faces;
  for (size_t f = 0; f < before.size(); ++f)
  {
    Polyhedron::Face& face = hull.faces[f];
    if (face.area > 1e-14 * size * size)
      continue;
    const Polyhedron::Face* best = nullptr;
    for (int k = 0; k < face.size; ++k)
    {
      const auto& pair = hull.edges[hull.face_edges[face.first + k]].face;
      const Polyhedron::Face& other = before[pair[0] == static_cast<int>(f) ? pair[1] : pair[0]];
      if (best == nullptr || other.area > best->area)
        best = &other;
    }
    face.normal = best->normal;
    face.offset = face.normal.dot(hull.vertices[hull.face_vertices[face.first]]);
    for (int k = 1; k < face.size; ++k)
      face.offset = std::max(face.offset, face.normal.dot(hull.vertices[hull.face_vertices[face.first + k]]));
  }
}

/// Far from the origin digits would be lost.
std::vector<Eigen::Vector3d> moved(std::vector<Eigen::Vector3d> points, const Eigen::Vector3d& by)
{
  for (Eigen::Vector3d& point : points)
    point += by;
  return points;
}

/// The points that are corners of faces; all of them where leaving the others out is not worth another hull.
std::vector<Eigen::Vector3d> withoutIdlePoints(const std::vector<Eigen::Vector3d>& points, const HullSurface& surface,
                                               const std::vector<char>& is_needed, double tolerance)
{
  const std::vector<int> numbers = numbersOf(points.size(), surface);
  const int vertices = *std::max_element(numbers.begin(), numbers.end()) + 1;
  const std::vector<Eigen::Vector3d> corners = chosen(points, is_needed);
  const bool is_worth_it = corners.size() < (vertices < FINE ? 1.0 : WORTH_A_HULL) * vertices;
  return is_worth_it && corners.size() >= 4 && !commonPlane(corners, tolerance).is_plane ? corners : points;
}

Polyhedron assemble(std::vector<Eigen::Vector3d> points, const Eigen::Vector3d& center, double tolerance)
{
  std::vector<Eigen::Vector3d> centred = moved(points, -center);
  HullSurface surface = hullSurface(centred);
  auto merger = std::make_unique<FaceMerger>(centred, surface.triangles, tolerance);
  const std::vector<Eigen::Vector3d> corners = withoutIdlePoints(points, surface, merger->neededPoints(), tolerance);
  if (corners.size() < points.size())
  {
    points = corners;
    centred = moved(points, -center);
    surface = hullSurface(centred);
    merger = std::make_unique<FaceMerger>(centred, surface.triangles, tolerance);
  }
  merger->splitFacesWithVerticesInside();
  const std::vector<int> number = numbersOf(points.size(), surface);
  Polyhedron hull;
  for (size_t p = 0; p < points.size(); ++p)
    if (number[p] >= 0)
      hull.vertices.push_back(points[p]);
  std::vector<std::vector<int>> loops = merger->loops();
  for (std::vector<int>& loop : loops)
    for (int& vertex : loop)
      vertex = number[vertex];
  completeTopology(loops, hull);
  repairNormals(hull.size, hull);
  std::vector<std::array<int, 2>> pairs;
  for (const HullTriangle& triangle : surface.triangles)
    for (int k = 0; k < 3; ++k)
      pairs.push_back({number[triangle.corner[k]], number[triangle.corner[(k + 1) % 3]]});
  // points on a way down the convex surface are at most the moves of two of them and round-off higher than they should
  hull.slack = 2.0 * std::sqrt(3.0) * surface.joggle + 1e-14 * (hull.size + center.norm());
  completeSearch(pairs, hull);
  return hull;
}
}  // namespace

Polyhedron convexHull(const std::vector<Eigen::Vector3d>& points)
{
  if (points.empty())
    throw std::invalid_argument("it has no vertices");
  const Precision precision = precisionOf(points);
  if (!std::isfinite(precision.size))
    throw std::invalid_argument("a vertex is not finite");
  if (!(precision.size > 0.0))
    throw std::invalid_argument("all its vertices are one point; a sphere of radius 0 is a point");
  const double tolerance = precision.coplanar;
  const std::vector<Eigen::Vector3d> welded = weld(points, precision.weld);
  const CommonPlane plane = commonPlane(welded, tolerance);
  if (plane.is_line)
    throw std::invalid_argument("all its vertices lie on one line, which is no shape; a thin capsule or box is one");
  if (plane.is_plane)
    return flatPolygon(welded, plane, tolerance);
  return assemble(welded, precision.center, tolerance);
}

}  // namespace frictional_contact_sim
