// Quickhull by libqhull (triangulated output), then coplanar triangles are merged to polygonal faces.
#include <libqhull_r/libqhull_r.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "frictional_contact_sim/collision/polyhedron.h"
#include "polyhedron_topology.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double WELD_TOLERANCE = 1e-6;  // times the size: single-precision files
constexpr double COPLANAR_TOLERANCE = 2e-6;  // times the size
constexpr size_t MAX_VERTICES = 4000;  // feature numbers of contact ids have 14 bits: 3 V - 6 edges < 16384

using Triangle = std::array<int, 3>;

/// One point of every cluster; a grid of the tolerance keeps it O(n log n), and the order of the file decides.
std::vector<Eigen::Vector3d> weld(const std::vector<Eigen::Vector3d>& points, double tolerance)
{
  std::map<std::array<long, 3>, int> cells;
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector3d& point : points)
  {
    std::array<long, 3> cell;
    for (int i = 0; i < 3; ++i)
      cell[i] = std::lround(point[i] / tolerance);
    bool is_new = true;
    for (int k = 0; k < 27 && is_new; ++k)
    {
      const auto found = cells.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
      is_new = found == cells.end() || (kept[found->second] - point).norm() > tolerance;
    }
    if (is_new)
    {
      cells[cell] = static_cast<int>(kept.size());
      kept.push_back(point);
    }
  }
  return kept;
}

struct QhullDeleter
{
  void operator()(qhT* qh) const
  {
    int current = 0;
    int total = 0;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &current, &total);
    delete qh;
  }
};

std::vector<Triangle> hullTriangles(std::vector<Eigen::Vector3d>& points)
{
  std::unique_ptr<qhT, QhullDeleter> qh(new qhT);
  const std::unique_ptr<FILE, int (*)(FILE*)> sink(std::fopen("/dev/null", "w"), &std::fclose);
  qh_zero(qh.get(), sink.get());
  char options[] = "qhull Qt Pp";
  const int failed = qh_new_qhull(qh.get(), 3, static_cast<int>(points.size()), points.data()->data(), 0, options,
                                  sink.get(), sink.get());
  if (failed)
    throw std::invalid_argument("its vertices lie in one plane (no convex hull)");
  Eigen::Vector3d inside = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points)
    inside += point / static_cast<double>(points.size());
  std::vector<Triangle> triangles;
  for (facetT* facet = qh->facet_list; facet && facet->next; facet = facet->next)
  {
    Triangle triangle;
    for (int k = 0; k < 3; ++k)
      triangle[k] = qh_pointid(qh.get(), SETelemt_(facet->vertices, k, vertexT)->point);
    const Eigen::Vector3d& origin = points[triangle[0]];
    const Eigen::Vector3d normal = (points[triangle[1]] - origin).cross(points[triangle[2]] - origin);
    if (normal.dot(origin - inside) < 0.0)
      std::swap(triangle[1], triangle[2]);
    triangles.push_back(triangle);
  }
  return triangles;
}

Eigen::Vector3d areaVector(const std::vector<Eigen::Vector3d>& points, const Triangle& triangle)
{
  return (points[triangle[1]] - points[triangle[0]]).cross(points[triangle[2]] - points[triangle[0]]);
}

using HalfEdges = std::map<std::pair<int, int>, int>;

/// Face number of every triangle. Largest triangles first: their planes are the most accurate.
std::vector<int> mergeCoplanar(const std::vector<Eigen::Vector3d>& points, const std::vector<Triangle>& triangles,
                               const HalfEdges& half_edges, double tolerance, int& face_count)
{
  std::vector<int> order(triangles.size());
  std::vector<double> area(triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t)
  {
    order[t] = static_cast<int>(t);
    area[t] = areaVector(points, triangles[t]).norm();
  }
  std::stable_sort(order.begin(), order.end(), [&](int s, int t) { return area[s] > area[t]; });
  std::vector<int> face(triangles.size(), -1);
  face_count = 0;
  for (int seed : order)
  {
    if (face[seed] >= 0)
      continue;
    const Eigen::Vector3d normal = areaVector(points, triangles[seed]).normalized();
    const double offset = normal.dot(points[triangles[seed][0]]);
    std::vector<int> stack = {seed};
    face[seed] = face_count;
    while (!stack.empty())
    {
      const Triangle triangle = triangles[stack.back()];
      stack.pop_back();
      for (int k = 0; k < 3; ++k)
      {
        const auto opposite = half_edges.find({triangle[(k + 1) % 3], triangle[k]});
        const int next = opposite == half_edges.end() ? seed : opposite->second;
        const bool is_coplanar =
            std::all_of(triangles[next].begin(), triangles[next].end(),
                        [&](int v) { return std::abs(normal.dot(points[v]) - offset) <= tolerance; });
        if (face[next] < 0 && is_coplanar)
        {
          face[next] = face_count;
          stack.push_back(next);
        }
      }
    }
    ++face_count;
  }
  return face;
}

/// Walks the boundary of one face; corners shared by less than three faces lie inside an edge and are left out.
std::vector<int> faceLoop(int first, const std::map<int, int>& next, const std::vector<int>& faces_at_vertex)
{
  std::vector<int> loop;
  int vertex = first;
  do
  {
    if (faces_at_vertex[vertex] >= 3)
      loop.push_back(vertex);
    vertex = next.at(vertex);
  } while (vertex != first && loop.size() <= next.size());
  return loop;
}

Polyhedron assemble(const std::vector<Eigen::Vector3d>& points, const std::vector<Triangle>& triangles,
                    double tolerance)
{
  HalfEdges half_edges;
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      half_edges[{triangles[t][k], triangles[t][(k + 1) % 3]}] = static_cast<int>(t);
  int face_count = 0;
  const std::vector<int> face = mergeCoplanar(points, triangles, half_edges, tolerance, face_count);
  std::vector<std::map<int, int>> boundary(face_count);
  std::vector<int> faces_at_vertex(points.size(), 0);
  for (const auto& [edge, triangle] : half_edges)
  {
    const auto opposite = half_edges.find({edge.second, edge.first});
    if (opposite == half_edges.end() || face[opposite->second] != face[triangle])
    {
      boundary[face[triangle]][edge.first] = edge.second;
      ++faces_at_vertex[edge.first];
    }
  }
  std::vector<int> renumbered(points.size(), -1);
  Polyhedron hull;
  std::vector<std::vector<int>> loops;
  for (const std::map<int, int>& next : boundary)
  {
    std::vector<int> loop = next.empty() ? std::vector<int>() : faceLoop(next.begin()->first, next, faces_at_vertex);
    if (loop.size() < 3)
      throw std::runtime_error("faces of its convex hull degenerate");
    for (int& vertex : loop)
    {
      if (renumbered[vertex] < 0)
      {
        renumbered[vertex] = static_cast<int>(hull.vertices.size());
        hull.vertices.push_back(points[vertex]);
      }
      vertex = renumbered[vertex];
    }
    loops.push_back(loop);
  }
  completeTopology(loops, hull);
  return hull;
}
}  // namespace

Polyhedron convexHull(const std::vector<Eigen::Vector3d>& points)
{
  if (points.size() < 4)
    throw std::invalid_argument("it has " + std::to_string(points.size()) + " vertices, at least 4 are needed");
  Eigen::Vector3d low = points.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& point : points)
  {
    if (!point.allFinite())
      throw std::invalid_argument("a vertex is not finite");
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const Eigen::Vector3d center = 0.5 * (low + high);
  const double size = 0.5 * (high - low).norm();
  if (!(size > 0.0))
    throw std::invalid_argument("all its vertices are one point");
  // A fine mesh of a round part is thinned until its features fit the contact ids.
  for (double factor = 1.0; factor < 1e5; factor *= 4.0)
  {
    std::vector<Eigen::Vector3d> welded = weld(points, factor * WELD_TOLERANCE * size);
    if (welded.size() < 4)
      break;
    for (Eigen::Vector3d& point : welded)
      point -= center;  // far from the origin digits would be lost
    const std::vector<Triangle> triangles = hullTriangles(welded);
    for (Eigen::Vector3d& point : welded)
      point += center;
    try
    {
      Polyhedron hull = assemble(welded, triangles, factor * COPLANAR_TOLERANCE * size);
      if (hull.vertices.size() <= MAX_VERTICES && hull.faces.size() >= 4)
        return hull;
    }
    catch (const std::runtime_error&)
    {
      // slivers at the tolerance: the next, coarser one takes them away
    }
  }
  throw std::invalid_argument("it has fewer than 4 vertices that are not in one plane");
}

}  // namespace frictional_contact_sim
