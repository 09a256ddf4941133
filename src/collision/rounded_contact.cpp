// Spheres, capsules, boxes and hulls: cores of vertices, edges and faces with a radius around them.
#include <algorithm>
#include <cmath>

#include "core_pair.h"
#include "polyhedron_search.h"

namespace frictional_contact_sim
{
namespace
{
// A face carries the contact unless another direction separates better by this fraction of the size. Sharp cores: at
// contact the gap is the same, and the face brings all its points. Rounded cores touch at a distance r: the face must
// be the closest feature to second order of r.
constexpr double FACE_PREFERENCE = 1e-6;
constexpr double FACE_PREFERENCE_ROUND = 1e-13;
// The deepest point must be over the face, else the closest feature is beside it.
constexpr double OVER_FACE = 1e-9;
constexpr double OVER_FACE_ROUND = 1e-13;
constexpr double PARALLEL_EDGES = 1e-3;  // sine below which the face normals stand for the product of two edges
// Resting on an edge but nearly along a face: the points over the face are look-ahead contacts up to this tilt.
constexpr double LOOK_AHEAD_ANGLE = 0.1;

}  // namespace

int alignedFace(const CoreView& view, const Eigen::Vector3d& direction)
{
  return nearestFace(view.core(), view.rotation.transpose() * direction);
}

FaceAxis faceAxis(const CorePair& pair, bool is_on_a, int face)
{
  FaceAxis axis;
  if (face < 0)
    return axis;
  const CoreView& view = is_on_a ? pair.a : pair.b;
  const CoreView& other = is_on_a ? pair.b : pair.a;
  const Eigen::Vector3d outwards = view.rotation * view.core().faces[face].normal;
  Eigen::Vector3d nearest;
  other.exactSupport(-outwards, nearest);
  axis.is_on_a = is_on_a;
  axis.face = face;
  axis.normal = is_on_a ? Eigen::Vector3d(-outwards) : outwards;
  axis.separation = outwards.dot(nearest - view.translation) - view.core().faces[face].offset;
  return axis;
}

double angleBetween(const Eigen::Vector3d& n, const Eigen::Vector3d& other)
{
  return n.dot(other) > 0.0 ? n.cross(other).norm() : 2.0;
}

namespace
{
/// Of two axes that separate equally well the larger face (it holds the other's corners), else that of b.
FaceAxis chooseFace(const CorePair& pair, const FaceAxis& on_a, const FaceAxis& on_b)
{
  if (on_a.face < 0 || on_b.face < 0)
    return on_b.face < 0 ? on_a : on_b;
  const double difference = on_a.separation - on_b.separation;
  if (std::abs(difference) > FACE_PREFERENCE * pair.size)
    return difference > 0.0 ? on_a : on_b;
  const bool is_a_larger = pair.a.core().faces[on_a.face].area > 1.01 * pair.b.core().faces[on_b.face].area;
  return is_a_larger ? on_a : on_b;
}

/// First and last different vertex of a simplex.
EdgeEnds distinct(const std::array<int, 4>& vertices, int count, int& number)
{
  EdgeEnds ends{vertices[0], vertices[0]};
  number = 1;
  for (int k = 1; k < count; ++k)
  {
    const bool is_new = std::find(vertices.begin(), vertices.begin() + k, vertices[k]) == vertices.begin() + k;
    ends.second = is_new ? vertices[k] : ends.second;
    number += is_new ? 1 : 0;
  }
  return ends;
}

/// Contact of the features of the simplex: vertices and edges; a face only where rounding hid it from the face axes.
void addSimplexContact(const CorePair& pair, const ClosestPoints& closest, const Eigen::Vector3d& n)
{
  int number_a = 0;
  int number_b = 0;
  const EdgeEnds on_a = distinct(closest.vertex_a, closest.count, number_a);
  const EdgeEnds on_b = distinct(closest.vertex_b, closest.count, number_b);
  const bool has_edges = (number_a == 1 || pair.a.core().findEdge(on_a.first, on_a.second) >= 0) &&
                         (number_b == 1 || pair.b.core().findEdge(on_b.first, on_b.second) >= 0);
  if (number_a <= 2 && number_b <= 2 && has_edges)
  {
    addEdgeContacts(pair, on_a, on_b, n);
    return;
  }
  addSupportContact(pair, n);
}

/// The face manifold, when the deepest point is over the face.
bool tryFace(const CorePair& pair, const FaceAxis& face)
{
  const int first = pair.manifold.count;
  const double tolerance = (pair.radii() > 0.0 ? OVER_FACE_ROUND : OVER_FACE) * pair.size;
  clipAgainstFace(pair, face);
  if (deepestGap(pair, first) <= face.separation - pair.radii() + tolerance)
    return true;
  pair.manifold.count = first;
  return false;
}

/// Tries the faces that separate as well as `best`, the preferred one first.
bool tryFaces(const CorePair& pair, const FaceAxis& preferred, const FaceAxis& other, double best)
{
  const double least = best - (pair.radii() > 0.0 ? FACE_PREFERENCE_ROUND : FACE_PREFERENCE) * pair.size;
  return (preferred.face >= 0 && preferred.separation >= least && tryFace(pair, preferred)) ||
         (other.face >= 0 && other.separation >= least && tryFace(pair, other));
}

/// Adds what is over the face as look-ahead contacts, when it is nearly across the normal.
void addLookAhead(const CorePair& pair, const FaceAxis& face, const Eigen::Vector3d& n, int first)
{
  if (face.face >= 0 && angleBetween(n, face.normal) < LOOK_AHEAD_ANGLE)
  {
    const int found = pair.manifold.count;
    clipAgainstFace(pair, face);
    dropDuplicates(pair, first, found);
  }
}

/// Vertices and edges along n; the support functions have the last word on the gap.
void addFeatureContacts(const CorePair& pair, const ClosestPoints& closest, const Eigen::Vector3d& n, double best,
                        const FaceAxis& face)
{
  const int first = pair.manifold.count;
  addSimplexContact(pair, closest, n);
  const double expected = best - pair.radii();
  if (std::abs(deepestGap(pair, first) - expected) > OVER_FACE * pair.size && expected <= pair.margin)
  {
    pair.manifold.count = first;
    addSupportContact(pair, n);
  }
  addLookAhead(pair, face, n, first);
}

void collideAlong(const CorePair& pair)
{
  ClosestPoints closest;
  const Eigen::Vector3d n = separatingDirection(pair.a, pair.b, closest);
  const double best = separation(pair.a, pair.b, n);
  if (best > pair.margin + pair.radii())
    return;
  const FaceAxis on_a = faceAxis(pair, true, alignedFace(pair.a, -n));
  const FaceAxis on_b = faceAxis(pair, false, alignedFace(pair.b, n));
  const FaceAxis face = chooseFace(pair, on_a, on_b);
  if (!tryFaces(pair, face, face.is_on_a ? on_b : on_a, best))
    addFeatureContacts(pair, closest, n, best, face);
}

/// Separating axis of two boxes among 3 + 3 face normals and 9 products of edges (Gottschalk, Lin, Manocha 1996).
struct BoxAxes
{
  FaceAxis face_a;
  FaceAxis face_b;
  double edge_separation = -std::numeric_limits<double>::infinity();
  Eigen::Vector3d edge_normal = Eigen::Vector3d::UnitZ();
  int edge_a = 0;  ///< direction of the edge, 0 to 2
  int edge_b = 0;
};

BoxAxes boxAxes(const CorePair& pair)
{
  const Eigen::Matrix3d& rotation = pair.a.rotation;
  const Eigen::Vector3d& offset = pair.a.translation;
  const Eigen::Vector3d& half_a = pair.a.shape->half_extent;
  const Eigen::Vector3d& half_b = pair.b.shape->half_extent;
  const Eigen::Matrix3d extent = rotation.cwiseAbs();
  const Eigen::Vector3d offset_a = rotation.transpose() * offset;
  const double tie = 1e-9 * pair.size;
  BoxAxes axes;
  for (int i = 0; i < 3; ++i)
  {
    const double on_b = std::abs(offset[i]) - half_b[i] - extent.row(i).dot(half_a);
    if (on_b > axes.face_b.separation + tie)
    {
      const bool is_positive = offset[i] >= 0.0;
      axes.face_b = {false, 2 * i + (is_positive ? 1 : 0), on_b, (is_positive ? 1.0 : -1.0) * Eigen::Vector3d::Unit(i)};
    }
    const double on_a = std::abs(offset_a[i]) - half_a[i] - extent.col(i).dot(half_b);
    if (on_a > axes.face_a.separation + tie)
    {
      const bool is_positive = offset_a[i] >= 0.0;  // a is on the positive side: its negative face looks at b
      axes.face_a = {true, 2 * i + (is_positive ? 0 : 1), on_a, (is_positive ? 1.0 : -1.0) * rotation.col(i)};
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      const Eigen::Vector3d cross = rotation.col(i).cross(Eigen::Vector3d::Unit(j));
      const double sine = cross.norm();
      if (sine < PARALLEL_EDGES)
        continue;  // parallel edges: the face normals do
      const Eigen::Vector3d n = (cross.dot(offset) < 0.0 ? -1.0 : 1.0) / sine * cross;
      const double reach = (rotation.transpose() * n).cwiseAbs().dot(half_a) + n.cwiseAbs().dot(half_b);
      const double between = n.dot(offset) - reach;
      if (between > axes.edge_separation + tie)
      {
        axes.edge_separation = between;
        axes.edge_normal = n;
        axes.edge_a = i;
        axes.edge_b = j;
      }
    }
  }
  return axes;
}

/// @return whether the crossing of the two edges is within both: then they are the closest features
bool addBoxEdges(const CorePair& pair, const BoxAxes& axes)
{
  Eigen::Vector3d point;
  const int corner_a = pair.a.support(-axes.edge_normal, point);
  const int corner_b = pair.b.support(axes.edge_normal, point);
  const EdgeEnds on_a{corner_a & ~(1 << axes.edge_a), corner_a | (1 << axes.edge_a)};
  const EdgeEnds on_b{corner_b & ~(1 << axes.edge_b), corner_b | (1 << axes.edge_b)};
  const Eigen::Vector3d start_a = pair.a.vertex(on_a.first);
  const Eigen::Vector3d start_b = pair.b.vertex(on_b.first);
  const LineParameters line =
      closestOnLines(start_a, pair.a.vertex(on_a.second) - start_a, start_b, pair.b.vertex(on_b.second) - start_b);
  if (std::min(line.s, line.t) < 0.0 || std::max(line.s, line.t) > 1.0)
    return false;
  addEdgeContacts(pair, on_a, on_b, axes.edge_normal);
  return true;
}

void collideBoxes(const CorePair& pair)
{
  const BoxAxes axes = boxAxes(pair);
  const FaceAxis face = chooseFace(pair, axes.face_a, axes.face_b);
  const double best = std::max(axes.edge_separation, std::max(axes.face_a.separation, axes.face_b.separation));
  if (best > pair.margin || tryFaces(pair, face, face.is_on_a ? axes.face_b : axes.face_a, best))
    return;
  if (axes.edge_separation == best && addBoxEdges(pair, axes))
  {
    addLookAhead(pair, face, axes.edge_normal, 0);
    return;
  }
  // The closest features are a vertex and an edge or vertex, beside the faces: the boxes are apart.
  ClosestPoints closest;
  const Eigen::Vector3d n = separatingDirection(pair.a, pair.b, closest);
  const double distance = separation(pair.a, pair.b, n);
  if (distance <= pair.margin)
    addFeatureContacts(pair, closest, n, distance, face);
}

void collideThin(const CorePair& pair)
{
  const auto lastVertex = [](const CoreView& view) { return static_cast<int>(view.core().vertices.size()) - 1; };
  const Eigen::Vector3d between = pair.a.translation - pair.b.translation;
  const Eigen::Vector3d fallback =
      between.squaredNorm() > 0.0 ? Eigen::Vector3d(between.normalized()) : Eigen::Vector3d::UnitZ();
  addEdgeContacts(pair, {0, lastVertex(pair.a)}, {0, lastVertex(pair.b)}, fallback, false);
}
}  // namespace

void addSupportContact(const CorePair& pair, const Eigen::Vector3d& n)
{
  Eigen::Vector3d low_a;
  Eigen::Vector3d high_b;
  const int vertex_a = pair.a.exactSupport(-n, low_a);
  const int vertex_b = pair.b.exactSupport(n, high_b);
  pair.add(low_a, high_b, n, makeFeature(FeatureKind::VERTEX, std::max(vertex_a, 0)),
           makeFeature(FeatureKind::VERTEX, std::max(vertex_b, 0)));
}

double deepestGap(const CorePair& pair, int first)
{
  double deepest = std::numeric_limits<double>::infinity();
  for (int k = first; k < pair.manifold.count; ++k)
    deepest = std::min(deepest, pair.manifold.points[k].gap);
  return deepest;
}

void dropDuplicates(const CorePair& pair, int first, int found)
{
  std::vector<PairContact>& points = pair.manifold.points;
  int count = found;
  double least = std::numeric_limits<double>::infinity();
  for (int k = first; k < found; ++k)
    least = std::min(least, points[k].gap);
  least -= OVER_FACE * pair.size;
  for (int k = found; k < pair.manifold.count; ++k)
  {
    const bool is_new =
        std::none_of(points.begin() + first, points.begin() + found,
                     [&](const PairContact& other)
                     {
                       return (other.feature_a == points[k].feature_a && other.feature_b == points[k].feature_b) ||
                              (other.position - points[k].position).norm() < 1e-2 * pair.size;
                     });
    if (is_new && points[k].gap >= least)
      points[count++] = points[k];
  }
  pair.manifold.count = count;
}

void reduceAcross(const CorePair& pair)
{
  if (pair.manifold.count > MAX_PAIR_POINTS)
  {
    int axis = 0;
    pair.manifold.points[0].normal.cwiseAbs().maxCoeff(&axis);
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << Eigen::Vector3d::Unit((axis + 1) % 3), Eigen::Vector3d::Unit((axis + 2) % 3);
    reduceManifold(tangents, pair.size, pair.manifold);
  }
}

CorePair::CorePair(const ConvexShape& shape_a, const ConvexShape& shape_b, const Eigen::Isometry3d& a_in_b,
                   double gap_margin, Manifold& contacts)
  : a{&shape_a, a_in_b.linear(), a_in_b.translation(), 1.0}
  , b{&shape_b, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), 1.0}
  , margin(gap_margin)
  , size(smallerSize(shape_a, shape_b))
  , manifold(contacts)
  , radius_a(shape_a.kind == ShapeKind::CYLINDER ? 0.0 : shape_a.radius)
  , radius_b(shape_b.kind == ShapeKind::CYLINDER ? 0.0 : shape_b.radius)
{
}

void CorePair::add(const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b, const Eigen::Vector3d& n,
                   Feature feature_a, Feature feature_b) const
{
  const double gap = n.dot(point_a - point_b) - radii();
  if (gap <= margin)
  {
    const Eigen::Vector3d middle = 0.5 * (point_a + point_b) + 0.5 * (radius_b - radius_a) * n;
    manifold.add({middle, n, gap, feature_a, feature_b});
  }
}

void collideRounded(const ConvexShape& a, const ConvexShape& b, const Eigen::Isometry3d& a_in_b, double margin,
                    Manifold& manifold)
{
  const CorePair pair(a, b, a_in_b, margin, manifold);
  const auto isThin = [](const ConvexShape& shape) { return shape.core.faces.empty(); };
  if (isThin(a) && isThin(b))
    collideThin(pair);
  else if (a.kind == ShapeKind::BOX && b.kind == ShapeKind::BOX)
    collideBoxes(pair);
  else
    collideAlong(pair);
  reduceAcross(pair);
}

}  // namespace frictional_contact_sim
