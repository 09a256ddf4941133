// Vertex-vertex, vertex-edge, edge-edge: closed forms.
#include <algorithm>
#include <array>
#include <cmath>

#include "core_pair.h"

namespace frictional_contact_sim
{
namespace
{
// Sine of the angle below which two sharp edges count as parallel (one normal, two ends).
constexpr double PARALLEL_SHARP = 1e-3;
// Rounded edges have a normal at every point: up to here the ends of the overlap are reported as well.
constexpr double PARALLEL_ROUND = 0.1;
constexpr double PARALLEL_EXACT = 1e-7;  // the crossing of the lines is noise
constexpr double NO_DISTANCE = 1e-10;  // times the size: the difference of the points has no direction

struct EdgeLine
{
  Eigen::Vector3d start;
  Eigen::Vector3d direction;  ///< not normalised; zero for a vertex
  Feature edge;
  Feature ends[2];

  Eigen::Vector3d at(double t) const { return start + t * direction; }
  Feature featureAt(double t) const { return t <= 0.0 ? ends[0] : t >= 1.0 ? ends[1] : edge; }
  double nearest(const Eigen::Vector3d& point) const
  {
    const double length_squared = direction.squaredNorm();
    return length_squared > 0.0 ? (point - start).dot(direction) / length_squared : 0.0;
  }
};

EdgeLine makeLine(const CoreView& view, const EdgeEnds& ends)
{
  EdgeLine line;
  line.start = view.vertex(ends.first);
  line.direction = view.rotation * (view.core().vertices[ends.second] - view.core().vertices[ends.first]);
  line.ends[0] = makeFeature(FeatureKind::VERTEX, ends.first);
  line.ends[1] = makeFeature(FeatureKind::VERTEX, ends.second);
  line.edge = ends.first == ends.second ? line.ends[0]
                                        : makeFeature(FeatureKind::EDGE, view.core().findEdge(ends.first, ends.second));
  return line;
}

double clamped(double t)
{
  return std::clamp(t, 0.0, 1.0);
}

struct Side
{
  const Eigen::Vector3d& direction;  ///< from b to a
  bool is_known;
};

/// One contact of two points that are closest to each other on their features.
void addNearest(const CorePair& pair, const EdgeLine& a, double s, const EdgeLine& b, double t, const Side& side)
{
  const Eigen::Vector3d point_a = a.at(s);
  const Eigen::Vector3d point_b = b.at(t);
  const Eigen::Vector3d difference = point_a - point_b;
  const double distance = difference.norm();
  Eigen::Vector3d n = side.direction;
  if (distance > NO_DISTANCE * pair.size)
  {
    // Cores that overlap: the difference of their points is against the normal.
    n = (side.is_known && difference.dot(side.direction) < 0.0 ? -1.0 : 1.0) / distance * difference;
  }
  pair.add(point_a, point_b, n, a.featureAt(s), b.featureAt(t));
}

/// Closest points of two segments (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
LineParameters closestOnSegments(const EdgeLine& a, const EdgeLine& b)
{
  LineParameters closest = closestOnLines(a.start, a.direction, b.start, b.direction);
  closest.s = clamped(closest.s);
  closest.t = b.nearest(a.at(closest.s));
  if (closest.t < 0.0 || closest.t > 1.0)
  {
    closest.t = clamped(closest.t);
    closest.s = clamped(a.nearest(b.at(closest.t)));
  }
  return closest;
}

/// Ends of the common stretch of two near-parallel edges. @return number added
int addOverlapEnds(const CorePair& pair, const EdgeLine& a, const EdgeLine& b, const Side& side)
{
  const double at_0 = a.nearest(b.at(0.0));
  const double at_1 = a.nearest(b.at(1.0));
  const double low = std::max(0.0, std::min(at_0, at_1));
  const double high = std::min(1.0, std::max(at_0, at_1));
  if (high - low <= NO_DISTANCE)
    return 0;
  for (double s : {low, high})
  {
    const bool is_end_of_a = s <= 0.0 || s >= 1.0;
    const double t = is_end_of_a ? clamped(b.nearest(a.at(s))) : (std::abs(s - at_0) < std::abs(s - at_1) ? 0.0 : 1.0);
    addNearest(pair, a, s, b, t, side);
  }
  return 2;
}
}  // namespace

LineParameters closestOnLines(const Eigen::Vector3d& p, const Eigen::Vector3d& d, const Eigen::Vector3d& q,
                              const Eigen::Vector3d& e)
{
  // the cross product keeps all digits at small angles, where dd ee - (de)^2 cancels
  const Eigen::Vector3d normal = d.cross(e);
  const double scale = normal.squaredNorm();
  if (scale == 0.0)
    return {0.0, 0.0};
  const Eigen::Vector3d between = q - p;
  return {between.cross(e).dot(normal) / scale, between.cross(d).dot(normal) / scale};
}

void addEdgeContacts(const CorePair& pair, const EdgeEnds& on_a, const EdgeEnds& on_b, const Eigen::Vector3d& n,
                     bool is_side_known)
{
  const Side side{n, is_side_known};
  const EdgeLine a = makeLine(pair.a, on_a);
  const EdgeLine b = makeLine(pair.b, on_b);
  const double lengths = a.direction.norm() * b.direction.norm();
  if (lengths == 0.0)
  {
    const double t = clamped(b.nearest(a.start));
    const double s = clamped(a.nearest(b.at(t)));
    addNearest(pair, a, s, b, t, side);
    return;
  }
  const Eigen::Vector3d cross = a.direction.cross(b.direction);
  const double sine = cross.norm() / lengths;
  const double parallel = pair.radii() > 0.0 ? PARALLEL_ROUND : PARALLEL_SHARP;
  const bool has_crossing = sine > (pair.radii() > 0.0 ? PARALLEL_EXACT : PARALLEL_SHARP);
  const int first = pair.manifold.count;
  const int ends = sine < parallel ? addOverlapEnds(pair, a, b, side) : 0;
  if (!has_crossing && ends > 0)
    return;
  const LineParameters line = closestOnLines(a.start, a.direction, b.start, b.direction);
  const bool is_inside = has_crossing && line.s > 0.0 && line.s < 1.0 && line.t > 0.0 && line.t < 1.0;
  if (is_inside)
  {
    const Eigen::Vector3d normal = (cross.dot(n) < 0.0 ? -1.0 : 1.0) / cross.norm() * cross;
    pair.add(a.at(line.s), b.at(line.t), normal, a.edge, b.edge);
  }
  else
  {
    const LineParameters closest = closestOnSegments(a, b);
    addNearest(pair, a, closest.s, b, closest.t, side);
  }
  if (pair.manifold.count == first)
    return;  // the closest point is beyond the margin
  // the closest point may be one of the ends
  const Eigen::Vector3d last = pair.manifold.points[pair.manifold.count - 1].position;
  for (int k = first; k < pair.manifold.count - 1; ++k)
  {
    if ((pair.manifold.points[k].position - last).norm() < 1e-6 * pair.size)
    {
      --pair.manifold.count;
      break;
    }
  }
}

}  // namespace frictional_contact_sim
