// Flat against flat, and lines or rims over a flat feature: cylinder on a face, anything on the cap of a cylinder.
#include <algorithm>
#include <array>
#include <cmath>

#include "cylinder_view.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double FLAT_SINE = 1e-7;  // below, the lowest rim point is noise
constexpr double NEAR_FLAT_SINE = 0.1;  // up to here flats overlap as areas
constexpr double GENERATOR_COSINE = 0.5;  // up to here both ends of the generator count
constexpr double SAME_POINT = 1e-7;  // times the size

/// Adds contacts in the order (a, b), dropping points that are there already.
struct Adder
{
  const CorePair& pair;
  const FlatAxis& axis;
  int first;

  void operator()(const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b, Feature feature_a,
                  Feature feature_b) const
  {
    std::vector<PairContact>& points = pair.manifold.points;
    const int before = pair.manifold.count;
    pair.add(point_a, point_b, axis.normal, feature_a, feature_b);
    if (pair.manifold.count > before &&
        std::any_of(points.begin() + first, points.begin() + before,
                    [&](const PairContact& other)
                    { return (other.position - points[before].position).norm() < SAME_POINT * pair.size; }))
      --pair.manifold.count;
  }
};

/// Where the line x + t n meets a plane.
Eigen::Vector3d alongTo(const Eigen::Vector3d& x, const Eigen::Vector3d& n, const Eigen::Vector3d& plane_point,
                        const Eigen::Vector3d& plane_normal)
{
  return x + n * (plane_normal.dot(plane_point - x) / plane_normal.dot(n));
}

Feature rimCut(int cap, int which)
{
  return makeFeature(FeatureKind::CURVE, 2 * RIM_POINTS + 4 + 2 * cap + which);
}

/// Parameters in (0, 1) where the segment p, q crosses the circle of a radius about a centre in its plane.
int circleCuts(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& center, double radius,
               std::array<double, 2>& cuts)
{
  const Eigen::Vector3d d = q - p;
  const double length_squared = d.squaredNorm();
  if (!(length_squared > 0.0))
    return 0;
  const double middle = (center - p).dot(d) / length_squared;
  const double height_squared = (p + middle * d - center).squaredNorm();
  const double half_squared = (radius * radius - height_squared) / length_squared;
  int count = 0;
  for (double sign : {-1.0, 1.0})
  {
    const double s = middle + sign * std::sqrt(std::max(half_squared, 0.0));
    if (half_squared > 0.0 && s > 0.0 && s < 1.0)
      cuts[count++] = s;
  }
  return count;
}

/// The rim points of a cap over something flat: the fixed ones when near flat, and the lowest instead of its neighbour.
template <class Offer>
void offerRimPoints(const CylinderView& cylinder, int cap, const Eigen::Vector3d& down, const Offer& offer)
{
  const double sine = cylinder.sine(down);
  int nearest_fixed = -1;
  if (sine > FLAT_SINE)
  {
    const double angle = cylinder.rim(cap).farthest(down);
    nearest_fixed = (static_cast<int>(std::lround(angle / (0.25 * M_PI))) + RIM_POINTS) % RIM_POINTS;
    offer(cylinder.rimPoint(cap, down), lowestRimFeature(cap));
  }
  for (int k = 0; k < RIM_POINTS && sine < NEAR_FLAT_SINE; ++k)
  {
    if (k != nearest_fixed)
    {
      offer(Eigen::Vector3d(cylinder.capCenter(cap) + cylinder.radius() * (cylinder.view.rotation * rimDirection(k))),
            fixedRimFeature(cap, k));
    }
  }
}

/// Cap of cylinder a over a face of b: disc and polygon overlap along the axis's normal.
void addDiscOnPolygon(const Adder& add, int cap, int face_index)
{
  const CorePair& pair = add.pair;
  const Eigen::Vector3d& n = add.axis.normal;
  const CylinderView a{pair.a};
  const Polyhedron& core = pair.b.core();
  const Polyhedron::Face& face = core.faces[face_index];
  const Eigen::Vector3d outwards = pair.b.rotation * face.normal;
  const Eigen::Vector3d center = a.capCenter(cap);
  const Eigen::Vector3d cap_normal = a.capNormal(cap);
  const Eigen::Vector3d plane_point = pair.b.translation + face.offset * outwards;
  setSides(pair.b, face, outwards, pair.manifold);
  const std::vector<Eigen::Vector3d>& corners = pair.manifold.corners;
  for (int k = 0; k < face.size; ++k)
  {
    const Eigen::Vector3d& corner = corners[k];
    const Eigen::Vector3d& next = corners[(k + 1) % face.size];
    const Eigen::Vector3d on_cap = alongTo(corner, n, center, cap_normal);
    if ((on_cap - center).norm() <= a.radius() + SIDE_TOLERANCE * pair.size)
      add(on_cap, corner, capFeature(cap), makeFeature(FeatureKind::VERTEX, core.face_vertices[face.first + k]));
    std::array<double, 2> cuts;
    const int count = circleCuts(on_cap, alongTo(next, n, center, cap_normal), center, a.radius(), cuts);
    for (int c = 0; c < count; ++c)
    {
      const Eigen::Vector3d on_edge = corner + cuts[c] * (next - corner);
      add(alongTo(on_edge, n, center, cap_normal), on_edge, rimCut(cap, c),
          makeFeature(FeatureKind::EDGE, core.face_edges[face.first + k]));
    }
  }
  offerRimPoints(a, cap, -outwards,
                 [&](const Eigen::Vector3d& point, Feature feature)
                 {
                   const Eigen::Vector3d foot = alongTo(point, n, plane_point, outwards);
                   if (isInsideSides(foot, SIDE_TOLERANCE * pair.size, pair.manifold))
                     add(point, foot, feature, makeFeature(FeatureKind::FACE, face_index));
                 });
}

/// Tilted or lying cylinder a on a face of b: lowest rim point, or the generator line cut at the sides of the face.
void addGeneratorOnFace(const Adder& add, int face_index)
{
  const CorePair& pair = add.pair;
  const Eigen::Vector3d& n = add.axis.normal;
  const CylinderView a{pair.a};
  const Polyhedron::Face& face = pair.b.core().faces[face_index];
  const Eigen::Vector3d plane_point = pair.b.translation + face.offset * n;
  const Feature whole = makeFeature(FeatureKind::FACE, face_index);
  setSides(pair.b, face, n, pair.manifold);
  const int low = a.capTowards(-n);
  const bool is_lying = std::abs(a.axis().dot(n)) < GENERATOR_COSINE;
  std::array<Eigen::Vector3d, 2> ends = {a.rimPoint(low, -n), a.rimPoint(is_lying ? 1 - low : low, -n)};
  std::array<Feature, 2> on_a = {lowestRimFeature(low), lowestRimFeature(1 - low)};
  std::array<Feature, 2> on_b = {whole, whole};
  const double tolerance = SIDE_TOLERANCE * pair.size;
  for (int k = 0; k < face.size; ++k)
  {
    const Eigen::Vector3d& side = pair.manifold.side_normals[k];
    const std::array<double, 2> outside = {side.dot(ends[0] - pair.manifold.corners[k]),
                                           side.dot(ends[1] - pair.manifold.corners[k])};
    if (outside[0] > tolerance && outside[1] > tolerance)
      return;
    for (int e = 0; e < 2; ++e)
    {
      if (outside[e] > tolerance)
      {
        const double t = std::clamp(outside[e] / (outside[e] - outside[1 - e]), 0.0, 1.0);
        ends[e] += t * (ends[1 - e] - ends[e]);
        on_a[e] = sideFeature(0);
        on_b[e] = makeFeature(FeatureKind::EDGE, pair.b.core().face_edges[face.first + k]);
        break;
      }
    }
  }
  for (int e = 0; e < (is_lying ? 2 : 1); ++e)
    add(ends[e], alongTo(ends[e], n, plane_point, n), on_a[e], on_b[e]);
}

/// A segment of the other shape over the cap: what is over the disc. Its points are on the other's core.
void addSegmentOnCap(const Adder& add, const CylinderView& reference, const std::array<Eigen::Vector3d, 2>& ends,
                     const std::array<Feature, 2>& features, Feature cut_feature)
{
  const int cap = add.axis.cap;
  const Eigen::Vector3d center = reference.capCenter(cap);
  const Eigen::Vector3d normal = reference.capNormal(cap);
  const auto foot = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return x - normal * normal.dot(x - center); };
  const auto offer = [&](const Eigen::Vector3d& point, Feature on_cap, Feature on_other)
  { add.axis.is_on_a ? add(foot(point), point, on_cap, on_other) : add(point, foot(point), on_other, on_cap); };
  for (int e = 0; e < 2; ++e)
    if ((foot(ends[e]) - center).norm() <= reference.radius() + SIDE_TOLERANCE * add.pair.size)
      offer(ends[e], capFeature(cap), features[e]);
  std::array<double, 2> cuts;
  const int count = circleCuts(foot(ends[0]), foot(ends[1]), center, reference.radius(), cuts);
  for (int c = 0; c < count; ++c)
    offer(ends[0] + cuts[c] * (ends[1] - ends[0]), rimCut(cap, c), cut_feature);
}

/// Two discs, near flat: rim points of each over the other, and where the circles cross.
void addDiscOnDisc(const Adder& add, const CylinderView& reference, const CylinderView& other, int other_cap)
{
  const int cap = add.axis.cap;
  const double tolerance = SIDE_TOLERANCE * add.pair.size;
  const Eigen::Vector3d normal = reference.capNormal(cap);
  const Eigen::Vector3d center = reference.capCenter(cap);
  const Eigen::Vector3d other_center = other.capCenter(other_cap);
  const Eigen::Vector3d other_normal = other.capNormal(other_cap);
  const auto offer = [&](const Eigen::Vector3d& on_reference, const Eigen::Vector3d& on_other,
                         Feature reference_feature, Feature other_feature)
  {
    add.axis.is_on_a ? add(on_reference, on_other, reference_feature, other_feature)
                     : add(on_other, on_reference, other_feature, reference_feature);
  };
  offerRimPoints(other, other_cap, -normal,
                 [&](const Eigen::Vector3d& point, Feature feature)
                 {
                   const Eigen::Vector3d foot = alongTo(point, normal, center, normal);
                   if ((foot - center).norm() <= reference.radius() + tolerance)
                   {
                     offer(foot, point, capFeature(cap), feature);
                   }
                 });
  for (int k = 0; k < RIM_POINTS; ++k)
  {
    const Eigen::Vector3d point = center + reference.radius() * (reference.view.rotation * rimDirection(k));
    const Eigen::Vector3d above = alongTo(point, normal, other_center, other_normal);
    if ((above - other_center).norm() <= other.radius() + tolerance)
      offer(point, above, fixedRimFeature(cap, k), capFeature(other_cap));
  }
  // crossings of the circles, in the plane of the reference cap
  const Eigen::Vector3d between = alongTo(other_center, normal, center, normal) - center;
  const double distance = between.norm();
  const double along =
      (distance * distance + reference.radius() * reference.radius() - other.radius() * other.radius()) /
      (2.0 * distance);
  const double half_squared = reference.radius() * reference.radius() - along * along;
  if (distance > tolerance && half_squared > 0.0)
  {
    const Eigen::Vector3d direction = between / distance;
    for (int which : {0, 1})
    {
      const Eigen::Vector3d across = (which == 0 ? 1.0 : -1.0) * normal.cross(direction);
      const Eigen::Vector3d point = center + along * direction + std::sqrt(half_squared) * across;
      offer(point, alongTo(point, normal, other_center, other_normal), rimCut(cap, which), rimCut(other_cap, which));
    }
  }
}

void addCylinderOnCap(const Adder& add, const CylinderView& reference, const CylinderView& other)
{
  const Eigen::Vector3d down = -reference.capNormal(add.axis.cap);
  const int low = other.capTowards(down);
  if (other.sine(down) < NEAR_FLAT_SINE)
  {
    addDiscOnDisc(add, reference, other, low);
    return;
  }
  const bool is_lying = std::abs(other.axis().dot(down)) < GENERATOR_COSINE;
  const int far = is_lying ? 1 - low : low;
  addSegmentOnCap(add, reference, {other.rimPoint(low, down), other.rimPoint(far, down)},
                  {lowestRimFeature(low), lowestRimFeature(far)}, sideFeature(0));
}
}  // namespace

bool addFlatContacts(const CorePair& pair, const FlatAxis& axis)
{
  const int first = pair.manifold.count;
  const Adder add{pair, axis, first};
  const CylinderView a{pair.a};
  if (axis.face >= 0)
  {
    if (a.sine(axis.normal) < NEAR_FLAT_SINE)
      addDiscOnPolygon(add, a.capTowards(-axis.normal), axis.face);
    else
      addGeneratorOnFace(add, axis.face);
  }
  else if (pair.b.shape->kind == ShapeKind::CYLINDER)
  {
    const CylinderView b{pair.b};
    addCylinderOnCap(add, axis.is_on_a ? a : b, axis.is_on_a ? b : a);
  }
  else if (pair.b.core().faces.empty())
  {
    addSegmentOnCap(add, a, {pair.b.vertex(0), pair.b.vertex(1)},
                    {makeFeature(FeatureKind::VERTEX, 0), makeFeature(FeatureKind::VERTEX, 1)},
                    makeFeature(FeatureKind::EDGE, 0));
  }
  else
  {
    addDiscOnPolygon(add, axis.cap, alignedFace(pair.b, axis.normal));
  }
  return pair.manifold.count > first;
}

}  // namespace frictional_contact_sim
