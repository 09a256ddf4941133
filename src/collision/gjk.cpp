#include <algorithm>
#include <cmath>
#include <limits>

#include "core_view.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MAX_ITERATIONS = 100;
// A support no nearer than this fraction of the distance is no progress: double precision leaves 1e-16.
constexpr double RELATIVE_PROGRESS = 1e-13;
constexpr double TOUCHING = 1e-12;  // times the size

struct Corner
{
  Eigen::Vector3d difference;
  Eigen::Vector3d point_a;
  Eigen::Vector3d point_b;
  int vertex_a;
  int vertex_b;
};

/// Corners and weights of the closest point to the origin.
struct Simplex
{
  std::array<Corner, 4> corner;
  std::array<double, 4> weight{};
  int count = 0;
};

/// Indices of the corners that carry the closest point, and their weights.
struct Subset
{
  std::array<int, 3> index{};
  std::array<double, 3> weight{};
  int count = 0;
  double distance_squared = std::numeric_limits<double>::infinity();
};

double distanceSquared(const Simplex& simplex, const Subset& subset)
{
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (int k = 0; k < subset.count; ++k)
    point += subset.weight[k] * simplex.corner[subset.index[k]].difference;
  return point.squaredNorm();
}

Subset closestOnEdge(const Simplex& simplex, int i, int k)
{
  const Eigen::Vector3d& p = simplex.corner[i].difference;
  const Eigen::Vector3d edge = simplex.corner[k].difference - p;
  const double length_squared = edge.squaredNorm();
  const double t = length_squared > 0.0 ? -p.dot(edge) / length_squared : 0.0;
  Subset subset;
  if (t <= 0.0)
    subset = {{i}, {1.0}, 1};
  else if (t >= 1.0)
    subset = {{k}, {1.0}, 1};
  else
    subset = {{i, k}, {1.0 - t, t}, 2};
  subset.distance_squared = distanceSquared(simplex, subset);
  return subset;
}

Subset better(const Subset& first, const Subset& second)
{
  return second.distance_squared < first.distance_squared ? second : first;
}

Subset closestOnTriangle(const Simplex& simplex, int i, int j, int k)
{
  const Eigen::Vector3d& p = simplex.corner[i].difference;
  const Eigen::Vector3d u = simplex.corner[j].difference - p;
  const Eigen::Vector3d v = simplex.corner[k].difference - p;
  const Eigen::Vector3d normal = u.cross(v);
  const double area_squared = normal.squaredNorm();
  if (area_squared > 0.0)
  {
    // barycentric coordinates of the projection of the origin
    const double weight_j = normal.dot(v.cross(p)) / area_squared;
    const double weight_k = normal.dot(p.cross(u)) / area_squared;
    if (weight_j > 0.0 && weight_k > 0.0 && weight_j + weight_k < 1.0)
    {
      Subset subset{{i, j, k}, {1.0 - weight_j - weight_k, weight_j, weight_k}, 3};
      const double height = normal.dot(p);
      subset.distance_squared = height * height / area_squared;
      return subset;
    }
  }
  return better(better(closestOnEdge(simplex, i, j), closestOnEdge(simplex, j, k)), closestOnEdge(simplex, i, k));
}

/// @return false when the origin is inside the tetrahedron
bool closestOnTetrahedron(const Simplex& simplex, Subset& closest)
{
  bool is_outside = false;
  closest = Subset();
  for (int apex = 0; apex < 4; ++apex)
  {
    const int i = (apex + 1) % 4;
    const int j = (apex + 2) % 4;
    const int k = (apex + 3) % 4;
    const Eigen::Vector3d& p = simplex.corner[i].difference;
    const Eigen::Vector3d normal = (simplex.corner[j].difference - p).cross(simplex.corner[k].difference - p);
    const double apex_side = normal.dot(simplex.corner[apex].difference - p);
    const double origin_side = -normal.dot(p);
    if (apex_side * origin_side <= 0.0)  // a flat tetrahedron counts as outside of all its faces
    {
      is_outside = true;
      closest = better(closest, closestOnTriangle(simplex, i, j, k));
    }
  }
  return is_outside;
}

bool reduce(Simplex& simplex)
{
  Subset subset;
  switch (simplex.count)
  {
    case 1:
      subset = {{0}, {1.0}, 1};
      break;
    case 2:
      subset = closestOnEdge(simplex, 0, 1);
      break;
    case 3:
      subset = closestOnTriangle(simplex, 0, 1, 2);
      break;
    default:
      if (!closestOnTetrahedron(simplex, subset))
        return false;
  }
  const std::array<Corner, 4> old = simplex.corner;
  for (int k = 0; k < subset.count; ++k)
  {
    simplex.corner[k] = old[subset.index[k]];
    simplex.weight[k] = subset.weight[k];
  }
  simplex.count = subset.count;
  return true;
}

ClosestPoints result(const Simplex& simplex, bool are_apart)
{
  ClosestPoints closest;
  closest.are_apart = are_apart;
  closest.count = simplex.count;
  for (int k = 0; k < simplex.count; ++k)
  {
    closest.point_a += simplex.weight[k] * simplex.corner[k].point_a;
    closest.point_b += simplex.weight[k] * simplex.corner[k].point_b;
    closest.difference += simplex.weight[k] * simplex.corner[k].difference;
    closest.vertex_a[k] = simplex.corner[k].vertex_a;
    closest.vertex_b[k] = simplex.corner[k].vertex_b;
  }
  return closest;
}
}  // namespace

ClosestPoints closestPoints(const CoreView& a, const CoreView& b)
{
  const double touching = TOUCHING * (a.shape->bounding_radius + b.shape->bounding_radius);
  Simplex simplex;
  Eigen::Vector3d v = a.interior() - b.interior();
  if (v.squaredNorm() == 0.0)
    v = Eigen::Vector3d::UnitZ();
  double last = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < MAX_ITERATIONS; ++iteration)
  {
    Corner corner;
    corner.vertex_a = a.support(-v, corner.point_a);
    corner.vertex_b = b.support(v, corner.point_b);
    corner.difference = corner.point_a - corner.point_b;
    const double distance_squared = v.squaredNorm();
    const bool has_point = simplex.count > 0;
    if (has_point && distance_squared - v.dot(corner.difference) <= RELATIVE_PROGRESS * distance_squared)
      return result(simplex, true);
    const auto is_same = [&](const Corner& other) { return other.difference == corner.difference; };
    if (std::any_of(simplex.corner.begin(), simplex.corner.begin() + simplex.count, is_same))
      return result(simplex, true);
    const Simplex before = simplex;
    simplex.corner[simplex.count++] = corner;
    if (!reduce(simplex))
      return result(before, false);
    v.setZero();
    for (int k = 0; k < simplex.count; ++k)
      v += simplex.weight[k] * simplex.corner[k].difference;
    if (v.squaredNorm() <= touching * touching)
      return result(simplex, false);
    if (v.squaredNorm() >= last)  // round-off: the simplex before was as good
      return result(before.count > 0 ? before : simplex, true);
    last = v.squaredNorm();
  }
  return result(simplex, true);
}

}  // namespace frictional_contact_sim
