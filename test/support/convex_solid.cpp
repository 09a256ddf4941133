#include "support/convex_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include "frictional_contact_sim/collision/polyhedron.h"

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
constexpr double PI = 3.14159265358979323846;

struct Triangle
{
  std::array<int, 3> corner;
  Plane plane;
  std::vector<int> outside;  ///< points above it, each kept by one triangle
  bool alive = true;
};

/** Quickhull with the edges of the visible region as horizon; `tolerance` is what counts as above. */
class HullBuilder
{
public:
  explicit HullBuilder(const std::vector<Eigen::Vector3d>& points) : points_(points)
  {
    Eigen::Vector3d low = points.front();
    Eigen::Vector3d high = points.front();
    for (const Eigen::Vector3d& point : points)
    {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    tolerance_ = 1e-12 * std::max((high - low).norm(), 1e-300);
  }

  std::vector<Triangle> build()
  {
    if (!makeSimplex())
      return {};
    for (size_t next = 0; next < triangles_.size(); ++next)
      while (triangles_[next].alive && !triangles_[next].outside.empty())
        addFarthest(next);
    return triangles_;
  }

private:
  double above(const Triangle& triangle, int point) const
  {
    return triangle.plane.normal.dot(points_[point]) - triangle.plane.offset;
  }

  void add(int a, int b, int c, const std::vector<int>& candidates, std::vector<char>& taken)
  {
    Triangle triangle;
    triangle.corner = {a, b, c};
    const Eigen::Vector3d normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
    triangle.plane.normal = normal / std::max(normal.norm(), std::numeric_limits<double>::min());
    triangle.plane.offset = triangle.plane.normal.dot(points_[a]);
    for (size_t i = 0; i < candidates.size(); ++i)
      if (!taken[i] && above(triangle, candidates[i]) > tolerance_)
      {
        taken[i] = 1;
        triangle.outside.push_back(candidates[i]);
      }
    for (int k = 0; k < 3; ++k)
      owner_[{triangle.corner[k], triangle.corner[(k + 1) % 3]}] = static_cast<int>(triangles_.size());
    triangles_.push_back(std::move(triangle));
  }

  bool makeSimplex()
  {
    const auto farthest = [&](const auto& distance)
    {
      int best = 0;
      for (size_t i = 1; i < points_.size(); ++i)
        if (distance(points_[i]) > distance(points_[best]))
          best = static_cast<int>(i);
      return best;
    };
    const int a = farthest([](const Eigen::Vector3d& p) { return p.x(); });
    const int b = farthest([&](const Eigen::Vector3d& p) { return (p - points_[a]).norm(); });
    const Eigen::Vector3d line = (points_[b] - points_[a]).normalized();
    const int c = farthest([&](const Eigen::Vector3d& p) { return (p - points_[a]).cross(line).norm(); });
    const Eigen::Vector3d normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]).normalized();
    int d = farthest([&](const Eigen::Vector3d& p) { return std::abs(normal.dot(p - points_[a])); });
    const double height = normal.dot(points_[d] - points_[a]);
    if (!(std::abs(height) > 1e3 * tolerance_))
      return false;
    std::vector<int> all(points_.size());
    for (size_t i = 0; i < all.size(); ++i)
      all[i] = static_cast<int>(i);
    std::vector<char> taken(all.size(), 0);
    const bool up = height < 0.0;  // d below abc: abc looks outwards
    const int p = up ? a : b;
    const int q = up ? b : a;
    add(p, q, c, all, taken);
    add(q, p, d, all, taken);
    add(c, q, d, all, taken);
    add(p, c, d, all, taken);
    return true;
  }

  void addFarthest(size_t seed)
  {
    const std::vector<int>& outside = triangles_[seed].outside;
    int peak = outside.front();
    for (const int point : outside)
      if (above(triangles_[seed], point) > above(triangles_[seed], peak))
        peak = point;
    std::vector<int> visible{static_cast<int>(seed)};
    std::set<int> seen{static_cast<int>(seed)};
    std::vector<std::array<int, 2>> horizon;
    std::vector<int> candidates;
    for (size_t i = 0; i < visible.size(); ++i)
    {
      Triangle& triangle = triangles_[visible[i]];
      triangle.alive = false;
      candidates.insert(candidates.end(), triangle.outside.begin(), triangle.outside.end());
      for (int k = 0; k < 3; ++k)
      {
        const int from = triangle.corner[k];
        const int to = triangle.corner[(k + 1) % 3];
        const auto other = owner_.find({to, from});
        const int neighbour = other == owner_.end() ? -1 : other->second;
        if (neighbour >= 0 && triangles_[neighbour].alive && above(triangles_[neighbour], peak) > tolerance_)
        {
          if (seen.insert(neighbour).second)
            visible.push_back(neighbour);
        }
        else if (seen.count(neighbour) == 0)
          horizon.push_back({from, to});
      }
    }
    std::vector<char> taken(candidates.size(), 0);
    for (const std::array<int, 2>& edge : horizon)
      add(edge[0], edge[1], peak, candidates, taken);
  }

  const std::vector<Eigen::Vector3d>& points_;
  double tolerance_ = 0.0;
  std::vector<Triangle> triangles_;
  std::map<std::array<int, 2>, int> owner_;  ///< directed edge: its triangle
};
}  // namespace

Hull convexHullOf(const std::vector<Eigen::Vector3d>& points)
{
  Hull hull;
  if (points.size() < 4)
    return hull;
  for (const Triangle& triangle : HullBuilder(points).build())
  {
    if (!triangle.alive || triangle.plane.normal.norm() < 0.5)
      continue;
    hull.triangles.push_back(triangle.corner);
    Plane plane = triangle.plane;
    for (const Eigen::Vector3d& point : points)  // a half space that holds every point, whatever rounding did
      plane.offset = std::max(plane.offset, plane.normal.dot(point));
    hull.planes.push_back(plane);
  }
  return hull;
}

ConvexSolid::ConvexSolid(const Geometry& geometry) : geometry_(geometry)
{
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    addRound(sphere->radius, 0.0, false);
  else if (const auto* box = std::get_if<Box>(&geometry))
    addBox(*box);
  else if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    addRound(cylinder->radius, cylinder->half_length, true);
  else if (const auto* capsule = std::get_if<Capsule>(&geometry))
    addRound(capsule->radius, capsule->half_length, false);
  else if (const auto* mesh = std::get_if<Mesh>(&geometry))
    addHull(readMesh(mesh->path, mesh->scale));
  else
    throw std::invalid_argument("convex_solid: a geometry that is not a bounded convex one");
}

ConvexSolid::ConvexSolid(const std::vector<Eigen::Vector3d>& vertices) : geometry_(Mesh{"", Eigen::Vector3d::Ones()})
{
  addHull(vertices);
}

std::vector<ConvexSolid> ConvexSolid::solidsOf(const Geometry& geometry)
{
  std::vector<ConvexSolid> solids;
  if (const auto* mesh = std::get_if<Mesh>(&geometry))
    for (const MeshPart& part : readMeshParts(mesh->path, mesh->scale))
      solids.emplace_back(part.vertices);
  else
    solids.emplace_back(geometry);
  return solids;
}

void ConvexSolid::addBox(const Box& box)
{
  for (int corner = 0; corner < 8; ++corner)
    points.emplace_back((corner & 1) != 0 ? box.half_size.x() : -box.half_size.x(),
                        (corner & 2) != 0 ? box.half_size.y() : -box.half_size.y(),
                        (corner & 4) != 0 ? box.half_size.z() : -box.half_size.z());
  for (int corner = 0; corner < 8; ++corner)
    for (const int bit : {1, 2, 4})
      if ((corner & bit) == 0)
        edges.push_back({corner, corner | bit});
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 50; ++k)
    {
      Eigen::Vector3d unit;
      unit[axis] = k < 25 ? -1.0 : 1.0;
      unit[(axis + 1) % 3] = -0.8 + 0.4 * (k % 5);
      unit[(axis + 2) % 3] = -0.8 + 0.4 * (k % 25 / 5);
      points.push_back(unit.cwiseProduct(box.half_size));
    }
  radius = box.half_size.norm();
}

/** Sphere (half length 0), capsule, or cylinder with flat ends. */
void ConvexSolid::addRound(double cap_radius, double half_length, bool flat)
{
  curved = true;
  radius = flat ? std::hypot(cap_radius, half_length) : cap_radius + half_length;
  for (int k = 0; k < 24; ++k)
  {
    const double angle = 2.0 * PI * k / 24.0;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0.0);
    for (const double height : {-1.0, -0.5, 0.0, 0.5, 1.0})
      points.emplace_back(cap_radius * out + Eigen::Vector3d(0.0, 0.0, height * half_length));
    for (const double side : {-1.0, 1.0})
      for (const double part : {0.25, 0.5, 0.75, 1.0})
      {
        const double polar = 0.5 * PI * part;
        const Eigen::Vector3d cap = flat ? Eigen::Vector3d(cap_radius * (1.0 - part) * out)
                                         : Eigen::Vector3d(cap_radius * (std::cos(polar) * out));
        const double rise = flat ? 0.0 : cap_radius * std::sin(polar);
        points.emplace_back(cap + Eigen::Vector3d(0.0, 0.0, side * (half_length + rise)));
      }
  }
}

void ConvexSolid::addHull(const std::vector<Eigen::Vector3d>& all)
{
  hull_ = convexHullOf(all);
  std::map<int, int> corner;
  for (const std::array<int, 3>& triangle : hull_.triangles)
    for (const int vertex : triangle)
      if (corner.emplace(vertex, static_cast<int>(points.size())).second)
        points.push_back(all[vertex]);
  for (const std::array<int, 3>& triangle : hull_.triangles)
    for (int k = 0; k < 3; ++k)
      if (triangle[k] < triangle[(k + 1) % 3])
        edges.push_back({corner[triangle[k]], corner[triangle[(k + 1) % 3]]});
  if (points.empty())
    points = all;  // in one plane
  Eigen::Vector3d low = points.front();
  Eigen::Vector3d high = points.front();
  for (const Eigen::Vector3d& point : points)
  {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  center = 0.5 * (low + high);
  for (const Eigen::Vector3d& point : points)
    radius = std::max(radius, (point - center).norm());
  if (hull_.triangles.size() <= 500)  // of a fine mesh the corners are dense enough
    for (const std::array<int, 3>& triangle : hull_.triangles)
      points.push_back((all[triangle[0]] + all[triangle[1]] + all[triangle[2]]) / 3.0);
}

double ConvexSolid::depth(const Eigen::Vector3d& point) const
{
  if (const auto* sphere = std::get_if<Sphere>(&geometry_))
    return sphere->radius - point.norm();
  if (const auto* box = std::get_if<Box>(&geometry_))
    return (box->half_size - point.cwiseAbs()).minCoeff();
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry_))
    return std::min(cylinder->radius - point.head<2>().norm(), cylinder->half_length - std::abs(point.z()));
  if (const auto* capsule = std::get_if<Capsule>(&geometry_))
  {
    const double along = std::max(-capsule->half_length, std::min(capsule->half_length, point.z()));
    return capsule->radius - (point - Eigen::Vector3d(0.0, 0.0, along)).norm();
  }
  double depth = hull_.planes.empty() ? -1.0 : std::numeric_limits<double>::infinity();
  for (const Plane& plane : hull_.planes)
    depth = std::min(depth, plane.offset - plane.normal.dot(point));
  return depth;
}

double ConvexSolid::reachAgainst(const Eigen::Vector3d& n) const
{
  if (const auto* sphere = std::get_if<Sphere>(&geometry_))
    return sphere->radius;
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry_))
    return cylinder->radius * n.head<2>().norm() + cylinder->half_length * std::abs(n.z());
  if (const auto* capsule = std::get_if<Capsule>(&geometry_))
    return capsule->radius + capsule->half_length * std::abs(n.z());
  double reach = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point : points)
    reach = std::max(reach, -n.dot(point));
  return reach;
}

Eigen::Vector3d ConvexSolid::nearest(const Eigen::Vector3d& point) const
{
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry_))
  {
    Eigen::Vector3d result = point;
    const double out = point.head<2>().norm();
    if (out > cylinder->radius)
      result.head<2>() *= cylinder->radius / out;
    result.z() = std::max(-cylinder->half_length, std::min(cylinder->half_length, point.z()));
    return result;
  }
  const auto* sphere = std::get_if<Sphere>(&geometry_);
  const auto* capsule = std::get_if<Capsule>(&geometry_);
  if (sphere == nullptr && capsule == nullptr)
    return point;
  const double length = capsule != nullptr ? capsule->half_length : 0.0;
  const double size = capsule != nullptr ? capsule->radius : sphere->radius;
  const Eigen::Vector3d axis(0.0, 0.0, std::max(-length, std::min(length, point.z())));
  const Eigen::Vector3d out = point - axis;
  return out.norm() > size ? Eigen::Vector3d(axis + size / out.norm() * out) : point;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
