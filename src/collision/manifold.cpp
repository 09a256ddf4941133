#include <algorithm>
#include <array>
#include <utility>

#include "frictional_contact_sim/collision/narrow_phase.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double TOUCHING = 1e-6;  // times the size: the same depth as the deepest point
constexpr double SAME_GAP = 1e-9;  // times the size: ties go to the earlier point
}  // namespace

void Manifold::reserve(size_t vertices)
{
  const size_t room = vertices + 64;
  points.resize(std::max(points.size(), room));
  is_kept.reserve(room);
  polygon.reserve(room);
  clipped.reserve(room);
  corners.reserve(room);
  side_normals.reserve(room);
  search.reserve(vertices);
}

void sortManifold(Manifold& manifold)
{
  const auto key = [](const PairContact& point) { return std::make_pair(point.feature_a, point.feature_b); };
  for (int i = 1; i < manifold.count; ++i)
    for (int k = i; k > 0 && key(manifold.points[k]) < key(manifold.points[k - 1]); --k)
      std::swap(manifold.points[k], manifold.points[k - 1]);
}

void reduceManifold(const Eigen::Matrix<double, 3, 2>& tangents, double size, Manifold& manifold)
{
  if (manifold.count <= MAX_PAIR_POINTS)
    return;
  std::vector<char>& is_kept = manifold.is_kept;
  is_kept.assign(manifold.count, 0);
  double deepest = manifold.points[0].gap;
  for (int i = 1; i < manifold.count; ++i)
    deepest = std::min(deepest, manifold.points[i].gap);
  const double touching = deepest + TOUCHING * size;
  const auto isTouching = [&](int i) { return manifold.points[i].gap <= touching; };
  int touching_count = 0;
  for (int i = 0; i < manifold.count; ++i)
    touching_count += isTouching(i) ? 1 : 0;
  int kept_count = 0;
  const auto keep = [&](int i)
  {
    if (i >= 0 && !is_kept[i] && kept_count < MAX_PAIR_POINTS)
    {
      is_kept[i] = 1;
      ++kept_count;
    }
  };
  for (int k = 0; k < MAX_PAIR_POINTS && touching_count > MAX_PAIR_POINTS; ++k)
  {
    static const std::array<Eigen::Vector2d, 8> DIRECTIONS = {
        Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0),  Eigen::Vector2d(0, 1),  Eigen::Vector2d(0, -1),
        Eigen::Vector2d(1, 1), Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1), Eigen::Vector2d(-1, 1)};
    const Eigen::Vector3d direction = tangents * DIRECTIONS[k];
    int best = -1;
    double best_reach = 0.0;
    for (int i = 0; i < manifold.count; ++i)
    {
      const double reach = direction.dot(manifold.points[i].position);
      if (isTouching(i) && (best < 0 || reach > best_reach + SAME_GAP * size))
      {
        best = i;
        best_reach = reach;
      }
    }
    keep(best);
  }
  if (touching_count <= MAX_PAIR_POINTS)
    for (int i = 0; i < manifold.count; ++i)
      keep(isTouching(i) ? i : -1);
  while (kept_count < MAX_PAIR_POINTS)
  {
    int best = -1;
    for (int i = 0; i < manifold.count; ++i)
      if (!is_kept[i] && (best < 0 || manifold.points[i].gap < manifold.points[best].gap - SAME_GAP * size))
        best = i;
    keep(best);
  }
  int count = 0;
  for (int i = 0; i < manifold.count; ++i)
    if (is_kept[i])
      manifold.points[count++] = manifold.points[i];
  manifold.count = count;
}

namespace
{
bool isRounded(const ConvexShape& shape)
{
  return shape.kind != ShapeKind::CYLINDER && shape.kind != ShapeKind::HALF_SPACE;
}

/// Result of the pair (b, a) in a's frame becomes that of (a, b) in b's.
void swapBodies(const Eigen::Isometry3d& a_in_b, Manifold& manifold)
{
  for (int i = 0; i < manifold.count; ++i)
  {
    PairContact& point = manifold.points[i];
    point.position = a_in_b * point.position;
    point.normal = -(a_in_b.linear() * point.normal);
    std::swap(point.feature_a, point.feature_b);
  }
}
}  // namespace

void collide(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin,
             Manifold& manifold)
{
  manifold.count = 0;
  const auto inverse = [&] { return a_in_b.inverse(Eigen::Isometry); };
  if (b.kind == ShapeKind::HALF_SPACE)
  {
    collideHalfSpace(a, a_in_b, margin, manifold);
  }
  else if (a.kind == ShapeKind::HALF_SPACE)
  {
    collideHalfSpace(b, inverse(), margin, manifold);
    swapBodies(a_in_b, manifold);
  }
  else if (isRounded(a) && isRounded(b))
  {
    collideRounded(a, b, a_in_b, margin, manifold);
  }
  else if (a.kind == ShapeKind::CYLINDER)
  {
    collideCylinder(a, b, a_in_b, margin, manifold);
  }
  else
  {
    collideCylinder(b, a, inverse(), margin, manifold);
    swapBodies(a_in_b, manifold);
  }
  sortManifold(manifold);
}

}  // namespace frictional_contact_sim
