#include "polyhedron_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "polyhedron_topology.h"

namespace frictional_contact_sim
{
namespace
{
constexpr size_t FEW = 24;  // up to here looking at all of them is faster
constexpr int GRID = 8;  // directions of a side of the cube, along one edge
constexpr double SAME_COSINE = 1e-9;

/// Vertices or faces seen; small, on the stack. More than it holds are a case for a search through all.
template <int Size>
struct SeenList
{
  std::array<int, Size> index;
  int count = 0;
  bool is_full = false;

  bool has(int i) const { return std::find(index.begin(), index.begin() + count, i) != index.begin() + count; }
  void add(int i)
  {
    if (count == Size)
      is_full = true;
    else if (!has(i))
      index[count++] = i;
  }
};

/// Cell of the grid on the cube that a direction points to.
int gridCell(const Eigen::Vector3d& direction)
{
  int axis = 0;
  const double largest = direction.cwiseAbs().maxCoeff(&axis);
  const auto place = [&](double component)
  {
    const double t = largest > 0.0 ? 0.5 * (component / largest + 1.0) * GRID : 0.0;
    return std::clamp(static_cast<int>(t), 0, GRID - 1);
  };
  const int side = 2 * axis + (direction[axis] < 0.0 ? 1 : 0);
  return (side * GRID + place(direction[(axis + 1) % 3])) * GRID + place(direction[(axis + 2) % 3]);
}

Eigen::Vector3d gridDirection(int cell)
{
  const int axis = cell / (2 * GRID * GRID);
  Eigen::Vector3d direction;
  direction[axis] = cell / (GRID * GRID) % 2 == 0 ? 1.0 : -1.0;
  direction[(axis + 1) % 3] = 2.0 * (cell / GRID % GRID + 0.5) / GRID - 1.0;
  direction[(axis + 2) % 3] = 2.0 * (cell % GRID + 0.5) / GRID - 1.0;
  return direction;
}

int climb(const Polyhedron& core, const Eigen::Vector3d& direction, int start)
{
  int best = start;
  double reach = direction.dot(core.vertices[best]);
  bool has_moved = true;
  while (has_moved)
  {
    has_moved = false;
    const int from = best;
    for (int k = core.link_first[from]; k < core.link_first[from + 1]; ++k)
    {
      const double other = direction.dot(core.vertices[core.links[k]]);
      if (other > reach)
      {
        reach = other;
        best = core.links[k];
        has_moved = true;
      }
    }
  }
  return best;
}

int farthestOfAll(const Polyhedron& core, const Eigen::Vector3d& direction)
{
  int best = 0;
  double reach = direction.dot(core.vertices[0]);
  for (size_t v = 1; v < core.vertices.size(); ++v)
  {
    const double other = direction.dot(core.vertices[v]);
    if (other > reach)
    {
      reach = other;
      best = static_cast<int>(v);
    }
  }
  return best;
}

int nearestOfAllFaces(const Polyhedron& core, const Eigen::Vector3d& direction)
{
  int best = -1;
  double largest = -2.0;
  for (size_t f = 0; f < core.faces.size(); ++f)
  {
    const double cosine = core.faces[f].normal.dot(direction);
    if (cosine > largest + SAME_COSINE)
    {
      largest = cosine;
      best = static_cast<int>(f);
    }
  }
  return best;
}

/// Largest cosine to the direction on the arc between two unit vectors.
double largestOnArc(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& direction)
{
  const Eigen::Vector3d axis = from.cross(to);
  const double length = axis.norm();
  const double at_ends = std::max(direction.dot(from), direction.dot(to));
  if (length < 1e-12)
    return at_ends;
  // the direction projected into the plane of the arc, when it falls between the ends
  const bool is_between = axis.cross(from).dot(direction) > 0.0 && to.cross(axis).dot(direction) > 0.0;
  const double height = axis.dot(direction) / length;
  return is_between ? std::sqrt(std::max(0.0, direction.squaredNorm() - height * height)) : at_ends;
}
}  // namespace

void completeSearch(const std::vector<std::array<int, 2>>& pairs, Polyhedron& polyhedron)
{
  std::vector<std::array<int, 2>> directed;
  for (const std::array<int, 2>& pair : pairs)
  {
    directed.push_back(pair);
    directed.push_back({pair[1], pair[0]});
  }
  std::sort(directed.begin(), directed.end());
  directed.erase(std::unique(directed.begin(), directed.end()), directed.end());
  polyhedron.link_first.assign(polyhedron.vertices.size() + 1, 0);
  for (const std::array<int, 2>& link : directed)
  {
    polyhedron.links.push_back(link[1]);
    ++polyhedron.link_first[link[0] + 1];
  }
  for (size_t v = 0; v < polyhedron.vertices.size(); ++v)
    polyhedron.link_first[v + 1] += polyhedron.link_first[v];
  if (polyhedron.vertices.size() <= FEW)
    return;
  int start = 0;
  for (int cell = 0; cell < 6 * GRID * GRID; ++cell)
  {
    start = climb(polyhedron, gridDirection(cell), start);
    polyhedron.starts.push_back(start);
  }
}

int nearlyFarthestVertex(const Polyhedron& core, const Eigen::Vector3d& direction)
{
  if (core.starts.empty())
    return farthestOfAll(core, direction);
  return climb(core, direction, core.starts[gridCell(direction)]);
}

int farthestVertex(const Polyhedron& core, const Eigen::Vector3d& direction)
{
  if (core.starts.empty())
    return farthestOfAll(core, direction);
  int best = nearlyFarthestVertex(core, direction);
  double reach = direction.dot(core.vertices[best]);
  const double slack = core.slack * direction.norm();
  SeenList<48> seen;
  seen.add(best);
  for (int k = 0; k < seen.count && !seen.is_full; ++k)
  {
    const int from = seen.index[k];
    for (int j = core.link_first[from]; j < core.link_first[from + 1]; ++j)
    {
      const int vertex = core.links[j];
      const double other = direction.dot(core.vertices[vertex]);
      if (other >= reach - slack)
        seen.add(vertex);
      if (other > reach || (other == reach && vertex < best))
      {
        reach = other;
        best = vertex;
      }
    }
  }
  return seen.is_full ? farthestOfAll(core, direction) : best;
}

void VertexSearch::reserve(size_t vertices)
{
  found.reserve(vertices);
  if (mark.size() < vertices)
    mark.resize(vertices, search);
}

void verticesBelow(const Polyhedron& core, const Eigen::Vector3d& up, double height, VertexSearch& search)
{
  search.found.clear();
  const auto isBelow = [&](int v, double limit) { return up.dot(core.vertices[v]) <= limit; };
  if (core.starts.empty())
  {
    for (size_t v = 0; v < core.vertices.size(); ++v)
      if (isBelow(static_cast<int>(v), height))
        search.found.push_back(static_cast<int>(v));
    return;
  }
  const int lowest = farthestVertex(core, -up);
  if (!isBelow(lowest, height))
    return;
  search.reserve(core.vertices.size());
  ++search.search;
  const double limit = height + core.slack * up.norm();
  search.found.push_back(lowest);
  search.mark[lowest] = search.search;
  for (size_t k = 0; k < search.found.size(); ++k)
  {
    const int from = search.found[k];
    for (int j = core.link_first[from]; j < core.link_first[from + 1]; ++j)
    {
      const int vertex = core.links[j];
      if (search.mark[vertex] != search.search && isBelow(vertex, limit))
      {
        search.mark[vertex] = search.search;
        search.found.push_back(vertex);
      }
    }
  }
  const auto isAbove = [&](int v) { return !isBelow(v, height); };
  search.found.erase(std::remove_if(search.found.begin(), search.found.end(), isAbove), search.found.end());
  std::sort(search.found.begin(), search.found.end());
}

int nearestFace(const Polyhedron& core, const Eigen::Vector3d& direction)
{
  if (core.starts.empty() || core.faces.size() <= FEW)
    return nearestOfAllFaces(core, direction);
  SeenList<64> cones;
  cones.add(farthestVertex(core, direction));
  double largest = -2.0;
  const auto cosine = [&](int face) { return core.faces[face].normal.dot(direction); };
  for (int k = 0; k < cones.count && !cones.is_full; ++k)
  {
    const int vertex = cones.index[k];
    const int end = core.neighbour_first[vertex + 1];
    for (int j = core.neighbour_first[vertex]; j < end; ++j)
      largest = std::max(largest, cosine(core.edges[core.neighbour_edges[j]].face[0]));
    for (int j = core.neighbour_first[vertex]; j < end; ++j)
      largest = std::max(largest, cosine(core.edges[core.neighbour_edges[j]].face[1]));
    for (int j = core.neighbour_first[vertex]; j < end; ++j)
    {
      const Polyhedron::Edge& edge = core.edges[core.neighbour_edges[j]];
      const double on_arc = largestOnArc(core.faces[edge.face[0]].normal, core.faces[edge.face[1]].normal, direction);
      if (on_arc >= largest - 2.0 * SAME_COSINE)
        cones.add(core.neighbours[j]);
    }
  }
  if (cones.is_full)
    return nearestOfAllFaces(core, direction);
  int best = -1;
  for (int k = 0; k < cones.count; ++k)
  {
    for (int j = core.neighbour_first[cones.index[k]]; j < core.neighbour_first[cones.index[k] + 1]; ++j)
      for (const int face : core.edges[core.neighbour_edges[j]].face)
        if (cosine(face) >= largest - SAME_COSINE && (best < 0 || face < best))
          best = face;
  }
  return best;
}

}  // namespace frictional_contact_sim
