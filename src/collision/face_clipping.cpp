#include <algorithm>
#include <cmath>

#include "core_pair.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double SAME_POINT = 1e-7;  // times the size

struct Reference
{
  const CoreView& view;
  const Polyhedron::Face& face;
  int face_index;
  Eigen::Vector3d normal;  ///< outwards, b's frame

  double height(const Eigen::Vector3d& point) const { return normal.dot(point - view.translation) - face.offset; }
  Feature side(int k) const { return makeFeature(FeatureKind::EDGE, view.core().face_edges[face.first + k]); }
  Feature corner(int k) const { return makeFeature(FeatureKind::VERTEX, view.core().face_vertices[face.first + k]); }
  Feature whole() const { return makeFeature(FeatureKind::FACE, face_index); }
};

/// Corner of the reference where the clipped polygon turns from side j to side k; neighbours share one.
Feature cornerBetween(const Reference& reference, int j, int k)
{
  return reference.corner((k + 1) % reference.face.size == j ? j : k);
}

Feature cutFeature(const Reference& reference, const ClipPoint& from, int k, Feature incident_face, ClipPoint& cut)
{
  if (from.edge >= 0)
  {
    cut.incident = makeFeature(FeatureKind::EDGE, from.edge);
    return reference.side(k);
  }
  cut.incident = incident_face;
  return cornerBetween(reference, -1 - from.edge, k);
}

/// One round of Sutherland-Hodgman: what is inside side k of the reference.
void clipSide(const Reference& reference, int k, Feature incident_face, double tolerance, Manifold& work)
{
  const Eigen::Vector3d normal = work.side_normals[k];
  const Eigen::Vector3d corner = work.corners[k];
  work.clipped.clear();
  const size_t size = work.polygon.size();
  for (size_t i = 0; i < size; ++i)
  {
    const ClipPoint& from = work.polygon[i];
    const ClipPoint& to = work.polygon[(i + 1) % size];
    const double from_outside = normal.dot(from.position - corner);
    const double to_outside = normal.dot(to.position - corner);
    const bool is_from_inside = from_outside <= tolerance;
    const bool is_to_inside = to_outside <= tolerance;
    if (is_from_inside)
      work.clipped.push_back(from);
    if (is_from_inside != is_to_inside)
    {
      // an end within the tolerance outside would put the cut beyond it
      const double t = std::clamp(from_outside / (from_outside - to_outside), 0.0, 1.0);
      ClipPoint cut;
      cut.position = from.position + t * (to.position - from.position);
      cut.reference = cutFeature(reference, from, k, incident_face, cut);
      cut.edge = is_from_inside ? -1 - k : from.edge;
      work.clipped.push_back(cut);
    }
  }
  std::swap(work.polygon, work.clipped);
}

/// The part of a segment inside all sides; both of its ends may be cut.
void clipSegment(const Reference& reference, double tolerance, Manifold& work)
{
  for (int k = 0; k < reference.face.size && !work.polygon.empty(); ++k)
  {
    const double outside_0 = work.side_normals[k].dot(work.polygon[0].position - work.corners[k]);
    const double outside_1 = work.side_normals[k].dot(work.polygon[1].position - work.corners[k]);
    if (outside_0 > tolerance && outside_1 > tolerance)
    {
      work.polygon.clear();
    }
    else if (outside_0 > tolerance || outside_1 > tolerance)
    {
      const double t = std::clamp(outside_0 / (outside_0 - outside_1), 0.0, 1.0);
      const Eigen::Vector3d cut = work.polygon[0].position + t * (work.polygon[1].position - work.polygon[0].position);
      ClipPoint& outer = work.polygon[outside_0 > tolerance ? 0 : 1];
      outer.position = cut;
      outer.incident = makeFeature(FeatureKind::EDGE, 0);
      outer.reference = reference.side(k);
    }
  }
}

void addClipPoint(const CoreView& view, int vertex, int edge, const Reference& reference, Manifold& work)
{
  work.polygon.push_back({view.vertex(vertex), makeFeature(FeatureKind::VERTEX, vertex), reference.whole(), edge});
}

/// A finely meshed round part rolls over small faces: vertices next to the incident face count as well.
void addNeighbours(const CoreView& view, const Polyhedron::Face& face, const Reference& reference, double highest,
                   double tolerance, Manifold& work)
{
  const Polyhedron& core = view.core();
  for (int k = 0; k < face.size; ++k)
  {
    const int vertex = core.face_vertices[face.first + k];
    for (int j = core.neighbour_first[vertex]; j < core.neighbour_first[vertex + 1]; ++j)
    {
      const int other = core.neighbours[j];
      const Feature feature = makeFeature(FeatureKind::VERTEX, other);
      const auto has_it = [&](const ClipPoint& point) { return point.incident == feature; };
      const Eigen::Vector3d position = view.vertex(other);
      if (reference.height(position) <= highest && isInsideSides(position, tolerance, work) &&
          std::none_of(work.polygon.begin(), work.polygon.end(), has_it))
        addClipPoint(view, other, 0, reference, work);
    }
  }
}

void clipIncident(const CorePair& pair, const Reference& reference, const CoreView& incident)
{
  Manifold& work = pair.manifold;
  // boxes of one size, stacked, keep their four corners: those on a side count as inside
  const double tolerance = SIDE_TOLERANCE * pair.size;
  const Polyhedron& core = incident.core();
  setSides(reference.view, reference.face, reference.normal, work);
  work.polygon.clear();
  if (core.vertices.size() <= 2)
  {
    for (size_t v = 0; v < core.vertices.size(); ++v)
      addClipPoint(incident, static_cast<int>(v), 0, reference, work);
    if (work.polygon.size() == 2)
      clipSegment(reference, tolerance, work);
    else if (!isInsideSides(work.polygon[0].position, tolerance, work))
      work.polygon.clear();
    return;
  }
  const int face_index = alignedFace(incident, -reference.normal);
  const Polyhedron::Face& face = core.faces[face_index];
  for (int k = 0; k < face.size; ++k)
    addClipPoint(incident, core.face_vertices[face.first + k], core.face_edges[face.first + k], reference, work);
  for (int k = 0; k < reference.face.size && !work.polygon.empty(); ++k)
    clipSide(reference, k, makeFeature(FeatureKind::FACE, face_index), tolerance, work);
  if (incident.shape->kind == ShapeKind::HULL)
    addNeighbours(incident, face, reference, pair.margin + pair.radii(), tolerance, work);
}
}  // namespace

void setSides(const CoreView& view, const Polyhedron::Face& face, const Eigen::Vector3d& outwards, Manifold& work)
{
  work.corners.clear();
  work.side_normals.clear();
  for (int k = 0; k < face.size; ++k)
    work.corners.push_back(view.vertex(view.core().face_vertices[face.first + k]));
  for (int k = 0; k < face.size; ++k)
  {
    const Eigen::Vector3d edge = work.corners[(k + 1) % face.size] - work.corners[k];
    work.side_normals.push_back(edge.cross(outwards).normalized());
  }
}

bool isInsideSides(const Eigen::Vector3d& point, double tolerance, const Manifold& work)
{
  for (size_t k = 0; k < work.corners.size(); ++k)
    if (work.side_normals[k].dot(point - work.corners[k]) > tolerance)
      return false;
  return true;
}

bool clipAgainstFace(const CorePair& pair, const FaceAxis& axis)
{
  const CoreView& view = axis.is_on_a ? pair.a : pair.b;
  const CoreView& incident = axis.is_on_a ? pair.b : pair.a;
  const Eigen::Vector3d outwards = axis.is_on_a ? Eigen::Vector3d(-axis.normal) : axis.normal;
  const Reference reference{view, view.core().faces[axis.face], axis.face, outwards};
  clipIncident(pair, reference, incident);
  Manifold& work = pair.manifold;
  const int first = work.count;
  for (const ClipPoint& point : work.polygon)
  {
    const double height = reference.height(point.position);
    const Eigen::Vector3d foot = point.position - height * outwards;
    const Eigen::Vector3d across = point.position - 0.5 * height * outwards;
    const bool is_new = std::none_of(
        work.points.begin() + first, work.points.begin() + work.count,
        [&](const PairContact& other)
        { return (other.position - across).squaredNorm() < SAME_POINT * SAME_POINT * pair.size * pair.size; });
    if (is_new && axis.is_on_a)
      pair.add(foot, point.position, axis.normal, point.reference, point.incident);
    else if (is_new)
      pair.add(point.position, foot, axis.normal, point.incident, point.reference);
  }
  return work.count > first;
}

}  // namespace frictional_contact_sim
