// Mesh files as convex shapes, and what their hulls add to them.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "frictional_contact_sim/collision/convex_shape.h"
#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double NOTABLE = 0.01;  // of the hull's volume: less is no warning
constexpr double NOTABLE_OPEN = 0.05;  // of the size, where there is no volume: loose points are no surface, but dense
constexpr double INSIDE = 1e-9;  // times the size: a part within another one to so much adds nothing
constexpr size_t MOST_BRIDGES = 200;  // triangles of the hull that are sampled, the largest
constexpr double MOST_TESTS = 2e7;  // of a sample against a triangle of the mesh

/// Volume by the divergence theorem, whatever the sense of the triangles as a whole.
double volumeOf(const MeshPart& part)
{
  const Eigen::Vector3d origin = part.vertices.front();
  double volume = 0.0;
  for (const std::array<int, 3>& t : part.triangles)
    volume +=
        (part.vertices[t[0]] - origin).dot((part.vertices[t[1]] - origin).cross(part.vertices[t[2]] - origin)) / 6.0;
  return std::abs(volume);
}

double volumeOf(const Polyhedron& hull)
{
  double volume = 0.0;
  for (const Polyhedron::Face& face : hull.faces)
    volume += face.area * (face.offset - face.normal.dot(hull.interior)) / 3.0;
  return volume;
}

/// Distance to a triangle (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
double distanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                          const Eigen::Vector3d& c)
{
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area_squared = normal.squaredNorm();
  if (area_squared > 0.0)
  {
    const double u = normal.dot((c - b).cross(p - b));
    const double v = normal.dot((a - c).cross(p - c));
    const double w = normal.dot((b - a).cross(p - a));
    if (u >= 0.0 && v >= 0.0 && w >= 0.0)
      return std::abs(normal.dot(p - a)) / std::sqrt(area_squared);
  }
  const auto toSegment = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to)
  {
    const Eigen::Vector3d along = to - from;
    const double length_squared = along.squaredNorm();
    const double t = length_squared > 0.0 ? std::clamp(along.dot(p - from) / length_squared, 0.0, 1.0) : 0.0;
    return (p - from - t * along).norm();
  };
  return std::min({toSegment(a, b), toSegment(b, c), toSegment(c, a)});
}

/// Points of the largest triangles of the hull's faces, which are those across its pockets.
std::vector<Eigen::Vector3d> samplesOf(const Polyhedron& hull, size_t most)
{
  struct Triangle
  {
    double area;
    Eigen::Vector3d a, b, c;
  };
  std::vector<Triangle> triangles;
  for (const Polyhedron::Face& face : hull.faces)
  {
    const auto corner = [&](int k) -> const Eigen::Vector3d&
    { return hull.vertices[hull.face_vertices[face.first + k]]; };
    for (int k = 1; k + 1 < face.size; ++k)
      triangles.push_back(
          {(corner(k) - corner(0)).cross(corner(k + 1) - corner(0)).norm(), corner(0), corner(k), corner(k + 1)});
  }
  const size_t count = std::min(most, triangles.size());
  std::partial_sort(triangles.begin(), triangles.begin() + count, triangles.end(),
                    [](const Triangle& s, const Triangle& t) { return s.area > t.area; });
  constexpr int STEPS = 6;
  std::vector<Eigen::Vector3d> samples;
  for (size_t t = 0; t < count; ++t)
    for (int i = 0; i <= STEPS; ++i)
      for (int k = 0; i + k <= STEPS; ++k)
        samples.push_back(triangles[t].a + (triangles[t].b - triangles[t].a) * i / STEPS +
                          (triangles[t].c - triangles[t].a) * k / STEPS);
  return samples;
}

/// Largest distance of the hull's surface from the mesh, over samples: a lower bound.
double largestDistance(const MeshPart& part, const Polyhedron& hull)
{
  const double triangles = static_cast<double>(std::max<size_t>(part.triangles.size(), 1));
  const size_t most = static_cast<size_t>(std::clamp(MOST_TESTS / (28.0 * triangles), 4.0, double(MOST_BRIDGES)));
  double largest = 0.0;
  for (const Eigen::Vector3d& sample : samplesOf(hull, most))
  {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::array<int, 3>& t : part.triangles)
    {
      const Eigen::Vector3d& a = part.vertices[t[0]];
      const Eigen::Vector3d& b = part.vertices[t[1]];
      const Eigen::Vector3d& c = part.vertices[t[2]];
      const double radius = std::sqrt(std::max((b - a).squaredNorm(), (c - a).squaredNorm()));
      if ((sample - a).norm() - radius < nearest)
        nearest = std::min(nearest, distanceToTriangle(sample, a, b, c));
      if (nearest <= largest)
        break;
    }
    for (size_t v = 0; v < part.vertices.size() && !part.is_closed && nearest > largest; ++v)
      nearest = std::min(nearest, (sample - part.vertices[v]).norm());  // some are in no triangle
    largest = std::max(largest, std::isfinite(nearest) ? nearest : 0.0);
  }
  return largest;
}

/// What hulls add, over the parts that are not convex.
struct Additions
{
  int count = 0;
  double volume = 0.0;  ///< [m^3]
  double hull_volume = 0.0;
  double distance = 0.0;  ///< [m]
  std::string worst;  ///< part with the largest distance
  bool has_open = false;

  void add(const MeshPart& part, const Polyhedron& hull)
  {
    const double hull_volume_of_part = volumeOf(hull);
    const double added = hull_volume_of_part - volumeOf(part);
    if (hull.is_flat || (part.is_closed && added <= NOTABLE * hull_volume_of_part))
      return;
    const double far = largestDistance(part, hull);
    if (!part.is_closed && far <= NOTABLE_OPEN * hull.size)
      return;
    ++count;
    hull_volume += hull_volume_of_part;
    volume += part.is_closed ? std::max(added, 0.0) : 0.0;
    has_open = has_open || !part.is_closed;
    if (far > distance)
    {
      distance = far;
      worst = part.name;
    }
  }
};

std::string number(const char* format, double value)
{
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string describe(const Additions& additions, size_t parts)
{
  const std::string what = parts == 1 ? "it is not convex; its convex hull"
                                      : std::to_string(additions.count) + " of its " + std::to_string(parts) +
                                            " parts are not convex; their convex hulls, used instead,";
  const double share = 100.0 * additions.volume / additions.hull_volume;
  const std::string volume = additions.has_open ? " (no volume, the surface is open)"
                                                : " adds " + number("%.3g m^3, ", additions.volume) +
                                                      number("%.0f %% of its own volume, and", share);
  return what + (parts == 1 ? ", used instead," : "") + volume + " is at least " +
         number("%.3g m", additions.distance) + " away from the mesh somewhere" +
         (parts > 1 ? " (part '" + additions.worst + "')" : "");
}

bool isWithin(const Polyhedron& inner, const Polyhedron& outer)
{
  const double tolerance = INSIDE * outer.size;
  const Eigen::Vector3d offset = (inner.center - outer.center).cwiseAbs() + inner.half_extent - outer.half_extent;
  if ((offset.array() > tolerance).any())
    return false;
  for (const Polyhedron::Face& face : outer.faces)
    for (const Eigen::Vector3d& vertex : inner.vertices)
      if (face.normal.dot(vertex) - face.offset > tolerance)
        return false;
  return true;
}
}  // namespace

std::vector<Polyhedron> loadMeshHulls(const std::string& path, const Eigen::Vector3d& scale, std::string& addition)
{
  const std::vector<MeshPart> parts = readMeshParts(path, scale);
  std::vector<Polyhedron> hulls;
  Additions additions;
  for (const MeshPart& part : parts)
  {
    try
    {
      hulls.push_back(convexHull(part.vertices));
    }
    catch (const std::invalid_argument& error)
    {
      const std::string which = parts.size() == 1 ? "mesh" : "part '" + part.name + "' of the mesh";
      throw ModelError(path + ": " + which + " has no convex hull: " + error.what());
    }
    additions.add(part, hulls.back());
  }
  addition = additions.count > 0 ? describe(additions, parts.size()) : "";
  std::vector<Polyhedron> kept;
  for (size_t i = 0; i < hulls.size(); ++i)
  {
    bool is_new = true;
    for (size_t k = 0; k < hulls.size() && is_new; ++k)
      // of two that are the same the first stays
      is_new = k == i || !isWithin(hulls[i], hulls[k]) || (k > i && isWithin(hulls[k], hulls[i]));
    if (is_new)
      kept.push_back(hulls[i]);
  }
  return kept;
}

}  // namespace frictional_contact_sim
