// Cylinders against spheres, capsules, boxes, hulls and cylinders.
#include <algorithm>
#include <cmath>

#include "cylinder_view.h"

namespace frictional_contact_sim
{
namespace
{
// Flat on flat (sharp rims): the flat axis wins as for polyhedra, see rounded_contact.cpp.
constexpr double FLAT_PREFERENCE = 1e-6;
constexpr double OVER_FLAT = 1e-9;
// Where a curved side or a rounded shape touches a flat, the flat must be the closest feature to second order.
constexpr double FLAT_PREFERENCE_ROUND = 1e-13;
constexpr double OVER_FLAT_ROUND = 1e-13;
constexpr double LOOK_AHEAD_ANGLE = 0.1;
constexpr double SHALLOW = 1e-3;  // times the size
constexpr double PARALLEL = 0.1;  // angle up to which lines along each other bring the ends of their overlap

void collideSphere(const ConvexShape& cylinder, const ConvexShape& sphere, const Eigen::Isometry3d& a_in_b,
                   double margin, Manifold& manifold)
{
  const Eigen::Vector3d center = -(a_in_b.linear().transpose() * a_in_b.translation());
  const double radial = std::hypot(center.x(), center.y());
  const double over_side = radial - cylinder.radius;
  const double over_cap = std::abs(center.z()) - cylinder.half_length;
  const Eigen::Vector3d outwards =
      radial > 0.0 ? Eigen::Vector3d(center.x() / radial, center.y() / radial, 0.0) : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d up = (center.z() < 0.0 ? -1.0 : 1.0) * Eigen::Vector3d::UnitZ();
  const int cap = center.z() < 0.0 ? 0 : 1;
  double distance = 0.0;
  Eigen::Vector3d direction;  // from the cylinder to the sphere, cylinder frame
  Feature feature;
  if (over_side > 0.0 && over_cap > 0.0)
  {
    distance = std::hypot(over_side, over_cap);
    direction = (over_side * outwards + over_cap * up) / distance;
    feature = lowestRimFeature(cap);
  }
  else if (over_side > over_cap)
  {
    distance = over_side;
    direction = outwards;
    feature = sideFeature(0);
  }
  else
  {
    distance = over_cap;
    direction = up;
    feature = capFeature(cap);
  }
  const double gap = distance - sphere.radius;
  if (gap <= margin)
  {
    const Eigen::Vector3d n = -(a_in_b.linear() * direction);  // from the sphere (b) to the cylinder (a)
    manifold.add({(sphere.radius + 0.5 * gap) * n, n, gap, feature, makeFeature(FeatureKind::VERTEX, 0)});
  }
}

FlatAxis capAxis(const CorePair& pair, bool is_on_a, const Eigen::Vector3d& n)
{
  const CylinderView cylinder{is_on_a ? pair.a : pair.b};
  FlatAxis axis;
  axis.is_on_a = is_on_a;
  axis.cap = cylinder.capTowards(is_on_a ? Eigen::Vector3d(-n) : n);
  axis.normal = (is_on_a ? -1.0 : 1.0) * cylinder.capNormal(axis.cap);
  axis.separation = separation(pair.a, pair.b, axis.normal);
  return axis;
}

/// Face or cap of b near n.
FlatAxis flatOfB(const CorePair& pair, const Eigen::Vector3d& n)
{
  if (pair.b.shape->kind == ShapeKind::CYLINDER)
    return capAxis(pair, false, n);
  const FaceAxis face = faceAxis(pair, false, alignedFace(pair.b, n));
  FlatAxis flat;
  flat.face = face.face;
  flat.separation = face.separation;
  flat.normal = face.normal;
  return flat;
}

/// Whether a curved side or a rounded shape rests on the flat: then its place is not decided within a tolerance.
bool touchesRound(const CorePair& pair, const FlatAxis& flat)
{
  const CylinderView on{flat.is_on_a ? pair.b : pair.a};
  return pair.radii() > 0.0 || (on.view.shape->kind == ShapeKind::CYLINDER && on.sine(flat.normal) > LOOK_AHEAD_ANGLE);
}

/// The manifold of a flat axis that separates as well as `best`, when the deepest point is over the flat.
bool tryFlat(const CorePair& pair, const FlatAxis& flat, double best)
{
  const bool is_round = touchesRound(pair, flat);
  if (!(flat.separation >= best - (is_round ? FLAT_PREFERENCE_ROUND : FLAT_PREFERENCE) * pair.size))
    return false;
  const int first = pair.manifold.count;
  addFlatContacts(pair, flat);
  const double tolerance = (is_round ? OVER_FLAT_ROUND : OVER_FLAT) * pair.size;
  if (deepestGap(pair, first) <= flat.separation - pair.radii() + tolerance)
    return true;
  pair.manifold.count = first;
  return false;
}

void addCurve(const CorePair& pair, const CurveContact& curve)
{
  pair.add(curve.point_a, curve.point_b, curve.normal, curve.feature_a, curve.feature_b);
}

/// The closest pair; where lines lie along each other on the sides, the ends of their overlap; then look-ahead points.
void addCurveContacts(const CorePair& pair, const CurveContacts& curves, const FlatAxis& flat)
{
  const int first = pair.manifold.count;
  const CurveContact& best = curves.best;
  const bool is_lying = std::abs(pair.a.rotation.col(2).dot(best.normal)) < PARALLEL;
  if (!best.is_crossing || curves.end_count == 0)
    addCurve(pair, best);
  for (int k = 0; k < curves.end_count && is_lying; ++k)
  {
    if (angleBetween(curves.ends[k].normal, best.normal) < PARALLEL)
    {
      const int found = pair.manifold.count;
      addCurve(pair, curves.ends[k]);
      dropDuplicates(pair, first, found);
    }
  }
  if (angleBetween(best.normal, flat.normal) < LOOK_AHEAD_ANGLE)
  {
    const int found = pair.manifold.count;
    addFlatContacts(pair, flat);
    dropDuplicates(pair, first, found);
  }
}
/// Face axis of a box or cap of a cylinder that separates best; face and cap -1 for other shapes.
FlatAxis bestOfFew(const CorePair& pair)
{
  const CylinderView a{pair.a};
  FlatAxis best = capAxis(pair, true, a.axis());
  const auto offer = [&](const FlatAxis& flat)
  { best = flat.separation > best.separation - FLAT_PREFERENCE * pair.size ? flat : best; };
  offer(capAxis(pair, true, -a.axis()));
  if (pair.b.shape->kind == ShapeKind::CYLINDER)
  {
    offer(capAxis(pair, false, Eigen::Vector3d::UnitZ()));
    offer(capAxis(pair, false, -Eigen::Vector3d::UnitZ()));
  }
  for (int face = 0; pair.b.shape->kind == ShapeKind::BOX && face < 6; ++face)
  {
    const FaceAxis axis = faceAxis(pair, false, face);
    FlatAxis flat;
    flat.face = axis.face;
    flat.separation = axis.separation;
    flat.normal = axis.normal;
    offer(flat);
  }
  return best;
}

/**
 * The common cases without GJK, which is slow on curved shapes that touch. When two points of the shapes are as far
 * apart as s(n) along n, no other direction separates better and no points are closer: a proof for s >= 0, and for a
 * shallow overlap as good as one.
 */
bool collideByCertificate(const CorePair& pair)
{
  const double shallow = -SHALLOW * pair.size;
  const FlatAxis flat = bestOfFew(pair);
  const double limit = pair.margin + pair.radii();
  if (flat.separation > limit)
    return true;
  if (flat.separation >= shallow && tryFlat(pair, flat, flat.separation))
    return true;
  if (pair.b.shape->kind != ShapeKind::CYLINDER)
    return false;
  const LineParameters line =
      closestOnLines(pair.a.translation, pair.a.rotation.col(2), pair.b.translation, pair.b.rotation.col(2));
  const double half_a = pair.a.shape->half_length;
  const double half_b = pair.b.shape->half_length;
  const Eigen::Vector3d between = pair.a.translation + std::clamp(line.s, -half_a, half_a) * pair.a.rotation.col(2) -
                                  pair.b.translation - std::clamp(line.t, -half_b, half_b) * pair.b.rotation.col(2);
  if (between.norm() < SHALLOW * pair.size)
    return false;
  const CurveContacts curves = findCurveContacts(pair, between.normalized(), ClosestPoints());
  const CurveContact& best = curves.best;
  const double gap = best.normal.dot(best.point_a - best.point_b);
  const double across = (best.point_a - best.point_b - gap * best.normal).norm();
  const double tolerance = OVER_FLAT_ROUND * pair.size;
  if (best.separation < shallow || !best.is_proper || std::abs(gap - best.separation) > tolerance ||
      (!best.is_crossing && across > OVER_FLAT * pair.size))
    return false;
  if (best.separation <= limit)
    addCurveContacts(pair, curves, flat);
  return true;
}
}  // namespace

void collideCylinder(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin,
                     Manifold& manifold)
{
  if (b.kind == ShapeKind::SPHERE)
  {
    collideSphere(a, b, a_in_b, margin, manifold);
    return;
  }
  const CorePair pair(a, b, a_in_b, margin, manifold);
  if (collideByCertificate(pair))
  {
    reduceAcross(pair);
    return;
  }
  ClosestPoints closest;
  const Eigen::Vector3d n = separatingDirection(pair.a, pair.b, closest);
  if (separation(pair.a, pair.b, n) > margin + pair.radii())
    return;
  const FlatAxis on_b = flatOfB(pair, n);
  const FlatAxis on_a = capAxis(pair, true, n);
  const CurveContacts curves = findCurveContacts(pair, n, closest);
  const double best = std::max(curves.best.separation, std::max(on_a.separation, on_b.separation));
  const bool prefers_a = on_a.separation > on_b.separation + FLAT_PREFERENCE * pair.size;
  const FlatAxis& first = prefers_a ? on_a : on_b;
  const FlatAxis& second = prefers_a ? on_b : on_a;
  if (best <= margin + pair.radii() && !tryFlat(pair, first, best) && !tryFlat(pair, second, best))
    addCurveContacts(pair, curves, first);
  reduceAcross(pair);
}

}  // namespace frictional_contact_sim
