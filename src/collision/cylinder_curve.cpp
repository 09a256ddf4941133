// Rim and side of a cylinder against vertices, edges, rims and sides: stationary pairs, the best by s(n).
#include <algorithm>
#include <array>
#include <cmath>

#include "cylinder_view.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double NO_DIRECTION = 1e-10;  // times the size
constexpr double PARALLEL_LINES = 1e-7;  // sine below which the crossing of two lines is noise

struct Search
{
  const CorePair& pair;
  const Eigen::Vector3d& hint;
  CurveContacts found;

  /// Takes a stationary pair; its direction counts by the separation of the whole shapes along it.
  void offer(CurveContact contact)
  {
    const double length = contact.normal.norm();
    if (!(length > 0.0) || !std::isfinite(length))
      return;
    contact.normal *= (contact.normal.dot(hint) < 0.0 ? -1.0 : 1.0) / length;
    contact.separation = separation(pair.a, pair.b, contact.normal);
    contact.point_a -= (contact.is_on_axis_a ? pair.a.shape->radius : 0.0) * contact.normal;
    contact.point_b += (contact.is_on_axis_b ? pair.b.shape->radius : 0.0) * contact.normal;
    if (contact.is_end && found.end_count < static_cast<int>(found.ends.size()))
      found.ends[found.end_count++] = contact;
    if (contact.separation > found.best.separation + 1e-15 * pair.size)
      found.best = contact;
  }

  Eigen::Vector3d direction(const Eigen::Vector3d& difference) const
  {
    return difference.norm() > NO_DIRECTION * pair.size ? difference : hint;
  }

  /// Whether a parameter is within 0 and 1, ends included.
  static bool isWithin(double t) { return t >= -SIDE_TOLERANCE && t <= 1.0 + SIDE_TOLERANCE; }
  /// Whether a point is between the planes of the caps.
  bool isBetweenCaps(const CoreView& view, const Eigen::Vector3d& point) const
  {
    const double height = view.rotation.col(2).dot(point - view.translation);
    return std::abs(height) <= view.shape->half_length + SIDE_TOLERANCE * pair.size;
  }
};

Feature vertexOf(int v)
{
  return makeFeature(FeatureKind::VERTEX, v);
}

void offerVertex(Search& search, const CylinderView& a, int vertex)
{
  const Eigen::Vector3d point = search.pair.b.vertex(vertex);
  for (int cap : {0, 1})
  {
    CurveContact contact;
    contact.point_b = point;
    contact.point_a = a.rimPoint(cap, point - a.capCenter(cap));
    contact.normal = search.direction(contact.point_a - point);
    contact.is_proper = true;
    contact.feature_a = lowestRimFeature(cap);
    contact.feature_b = vertexOf(vertex);
    search.offer(contact);
  }
  CurveContact side;
  const Eigen::Vector3d from_center = point - a.view.translation;
  const Eigen::Vector3d radial = from_center - a.axis() * a.axis().dot(from_center);
  side.point_b = point;
  side.normal = radial.norm() > 0.0 ? Eigen::Vector3d(-radial) : search.hint;
  side.point_a = point - radial;
  side.is_on_axis_a = true;
  side.is_end = search.isBetweenCaps(a.view, point);
  side.is_proper = side.is_end;
  side.feature_a = sideFeature(0);
  side.feature_b = vertexOf(vertex);
  search.offer(side);
}

/// n: across both lines; for (nearly) parallel ones from the difference of their points.
Eigen::Vector3d acrossLines(const Search& search, const Eigen::Vector3d& d, const Eigen::Vector3d& e,
                            const Eigen::Vector3d& difference)
{
  const Eigen::Vector3d cross = d.cross(e);
  if (cross.norm() > PARALLEL_LINES * d.norm() * e.norm())
    return cross;
  const Eigen::Vector3d along = e.normalized();
  return search.direction(difference - along * along.dot(difference));
}

/// A line of b with a radius around it: edge of a polyhedron, axis of a capsule or cylinder.
void offerLine(Search& search, const CylinderView& a, const EdgeEnds& ends, Feature feature_b)
{
  const Eigen::Vector3d start = search.pair.b.vertex(ends.first);
  const Eigen::Vector3d direction = search.pair.b.vertex(ends.second) - start;
  const double length_squared = direction.squaredNorm();
  const bool is_cylinder = search.pair.b.shape->kind == ShapeKind::CYLINDER;
  for (int cap : {0, 1})
  {
    const Circle circle = a.rim(cap);
    const double angle = nearestToLine(circle, start, direction, circle.farthest(-search.hint));
    CurveContact contact;
    contact.point_a = circle.at(angle);
    const double t = direction.dot(contact.point_a - start) / length_squared;
    contact.point_b = start + std::clamp(t, 0.0, 1.0) * direction;
    contact.normal = acrossLines(search, circle.tangent(angle), direction, contact.point_a - contact.point_b);
    contact.feature_a = lowestRimFeature(cap);
    contact.feature_b = feature_b;
    contact.is_on_axis_b = is_cylinder;
    contact.is_end = Search::isWithin(t);
    contact.is_proper = contact.is_end;
    search.offer(contact);
  }
  CurveContact side;
  const Eigen::Vector3d axis = a.axis();
  const LineParameters line = closestOnLines(a.view.translation, axis, start, direction);
  side.point_a = a.view.translation + line.s * axis;
  side.is_on_axis_a = true;
  side.point_b = start + line.t * direction;
  side.normal = acrossLines(search, axis, direction, a.view.translation - start);
  side.feature_a = sideFeature(0);
  side.feature_b = feature_b;
  side.is_on_axis_b = is_cylinder;
  side.is_proper = Search::isWithin(line.t) && search.isBetweenCaps(a.view, side.point_a);
  side.is_crossing = axis.cross(direction).norm() < PARALLEL_LINES * direction.norm();
  search.offer(side);
}

void offerVertexOrEdge(Search& search, const CylinderView& a, const ClosestPoints& closest)
{
  const Polyhedron& core = search.pair.b.core();
  for (int i = 0; i < closest.count; ++i)
  {
    const int vertex = closest.vertex_b[i];
    offerVertex(search, a, vertex);
    // all its edges: GJK on curved shapes may stop with one vertex where an edge is meant
    for (int k = core.neighbour_first[vertex]; k < core.neighbour_first[vertex + 1]; ++k)
    {
      const EdgeEnds ends{std::min(vertex, core.neighbours[k]), std::max(vertex, core.neighbours[k])};
      offerLine(search, a, ends, makeFeature(FeatureKind::EDGE, core.findEdge(ends.first, ends.second)));
    }
  }
}

/// Rim of b against side of a.
void offerRimOfB(Search& search, const CylinderView& a, const CylinderView& b, int cap)
{
  const Circle circle = b.rim(cap);
  const Eigen::Vector3d axis = a.axis();
  const double angle = nearestToLine(circle, a.view.translation, axis, circle.farthest(search.hint));
  CurveContact contact;
  contact.point_b = circle.at(angle);
  const Eigen::Vector3d from_center = contact.point_b - a.view.translation;
  const Eigen::Vector3d radial = from_center - axis * axis.dot(from_center);
  contact.normal = search.direction(-radial);
  contact.point_a = contact.point_b - radial;
  contact.is_on_axis_a = true;
  contact.is_end = search.isBetweenCaps(a.view, contact.point_b);
  contact.is_proper = contact.is_end;
  contact.feature_a = sideFeature(0);
  contact.feature_b = lowestRimFeature(cap);
  search.offer(contact);
}

void offerRims(Search& search, const CylinderView& a, const CylinderView& b, int cap_a, int cap_b)
{
  const Circle first = a.rim(cap_a);
  const Circle second = b.rim(cap_b);
  double angle_1 = first.farthest(-search.hint);
  double angle_2 = second.farthest(search.hint);
  nearestOnCircles(first, second, angle_1, angle_2);
  CurveContact contact;
  contact.point_a = first.at(angle_1);
  contact.point_b = second.at(angle_2);
  contact.normal =
      acrossLines(search, first.tangent(angle_1), second.tangent(angle_2), contact.point_a - contact.point_b);
  contact.is_proper = true;
  contact.feature_a = lowestRimFeature(cap_a);
  contact.feature_b = lowestRimFeature(cap_b);
  search.offer(contact);
}
}  // namespace

CurveContacts findCurveContacts(const CorePair& pair, const Eigen::Vector3d& n, const ClosestPoints& closest)
{
  Search search{pair, n, CurveContacts()};
  const CylinderView a{pair.a};
  if (pair.b.shape->kind == ShapeKind::CYLINDER)
  {
    const CylinderView b{pair.b};
    offerLine(search, a, {0, 1}, sideFeature(0));
    for (int cap_b : {0, 1})
    {
      offerRimOfB(search, a, b, cap_b);
      offerRims(search, a, b, 0, cap_b);
      offerRims(search, a, b, 1, cap_b);
    }
  }
  else
  {
    offerVertexOrEdge(search, a, closest);
  }
  // The features found must carry the direction GJK found; else its supporting points are the contact.
  CurveContact& best = search.found.best;
  const double at_hint = separation(pair.a, pair.b, n);
  const double gap = best.normal.dot(best.point_a - best.point_b);
  const double tolerance = 1e-9 * pair.size;
  const bool misses_hint = best.separation < at_hint - tolerance;
  if (misses_hint || std::abs(gap - best.separation) > tolerance)
  {
    CurveContact support;
    support.normal = misses_hint ? n : best.normal;
    support.separation = std::max(at_hint, best.separation);
    pair.a.exactSupport(-support.normal, support.point_a);
    pair.b.exactSupport(support.normal, support.point_b);
    best = support;
  }
  return search.found;
}

}  // namespace frictional_contact_sim
