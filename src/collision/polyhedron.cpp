#include "frictional_contact_sim/collision/polyhedron.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <utility>

#include "polyhedron_topology.h"

namespace frictional_contact_sim
{
namespace
{
void setBounds(Polyhedron& polyhedron)
{
  Eigen::Vector3d low = polyhedron.vertices.front();
  Eigen::Vector3d high = low;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& vertex : polyhedron.vertices)
  {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
    sum += vertex;
  }
  polyhedron.center = 0.5 * (low + high);
  polyhedron.half_extent = 0.5 * (high - low);
  polyhedron.interior = sum / static_cast<double>(polyhedron.vertices.size());
  for (const Eigen::Vector3d& vertex : polyhedron.vertices)
    polyhedron.size = std::max(polyhedron.size, (vertex - polyhedron.center).norm());
}

void setNeighbours(Polyhedron& polyhedron)
{
  std::vector<int>& first = polyhedron.neighbour_first;
  first.assign(polyhedron.vertices.size() + 1, 0);
  for (const Polyhedron::Edge& edge : polyhedron.edges)
    for (const int vertex : edge.vertex)
      ++first[vertex + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  polyhedron.neighbours.resize(first.back());
  polyhedron.neighbour_edges.resize(first.back());
  std::vector<int> next(first.begin(), first.end() - 1);
  for (size_t e = 0; e < polyhedron.edges.size(); ++e)
    for (const int end : {0, 1})
    {
      const Polyhedron::Edge& edge = polyhedron.edges[e];
      const int place = next[edge.vertex[end]]++;
      polyhedron.neighbours[place] = edge.vertex[1 - end];
      polyhedron.neighbour_edges[place] = static_cast<int>(e);
    }
}

/// Edges in the order in which the loops first come to them. @return of every corner of the loops, one after the other
std::vector<int> numberEdges(const std::vector<std::vector<int>>& loops, Polyhedron& polyhedron)
{
  struct Side
  {
    std::pair<int, int> ends;
    int corner;
    int face;
    bool operator<(const Side& other) const { return ends != other.ends ? ends < other.ends : corner < other.corner; }
  };
  std::vector<Side> sides;
  for (size_t f = 0; f < loops.size(); ++f)
    for (size_t k = 0; k < loops[f].size(); ++k)
      sides.push_back({std::minmax({loops[f][k], loops[f][(k + 1) % loops[f].size()]}), static_cast<int>(sides.size()),
                       static_cast<int>(f)});
  std::vector<Side> sorted = sides;
  std::sort(sorted.begin(), sorted.end());
  std::vector<int> first(sides.size());
  for (size_t k = 0; k < sorted.size(); ++k)
    first[sorted[k].corner] =
        k > 0 && sorted[k].ends == sorted[k - 1].ends ? first[sorted[k - 1].corner] : sorted[k].corner;
  std::vector<int> edge(sides.size());
  for (size_t k = 0; k < sides.size(); ++k)
  {
    const bool is_new = first[k] == static_cast<int>(k);
    edge[k] = is_new ? static_cast<int>(polyhedron.edges.size()) : edge[first[k]];
    if (is_new)
      polyhedron.edges.push_back({{sides[k].ends.first, sides[k].ends.second}, {sides[k].face, -1}});
    else
      polyhedron.edges[edge[k]].face[1] = sides[k].face;
  }
  return edge;
}
}  // namespace

void completeTopology(const std::vector<std::vector<int>>& loops, Polyhedron& polyhedron)
{
  polyhedron.face_edges = numberEdges(loops, polyhedron);
  for (const std::vector<int>& loop : loops)
  {
    const int first = static_cast<int>(polyhedron.face_vertices.size());
    const size_t size = loop.size();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    const Eigen::Vector3d& origin = polyhedron.vertices[loop[0]];
    for (size_t k = 0; k < size; ++k)
    {
      const int v0 = loop[k];
      const int v1 = loop[(k + 1) % size];
      polyhedron.face_vertices.push_back(v0);
      // Newell's normal, about a corner for accuracy: the area-weighted mean over the polygon
      normal += (polyhedron.vertices[v0] - origin).cross(polyhedron.vertices[v1] - origin);
    }
    const double area = 0.5 * normal.norm();
    normal.normalize();
    double offset = normal.dot(origin);
    for (int vertex : loop)
      offset = std::max(offset, normal.dot(polyhedron.vertices[vertex]));
    polyhedron.faces.push_back({normal, offset, first, static_cast<int>(size), area});
  }
  setBounds(polyhedron);
  setNeighbours(polyhedron);
}

int Polyhedron::findEdge(int vertex_0, int vertex_1) const
{
  for (int k = neighbour_first[vertex_0]; k < neighbour_first[vertex_0 + 1]; ++k)
    if (neighbours[k] == vertex_1)
      return neighbour_edges[k];
  return -1;
}

Polyhedron pointPolyhedron()
{
  Polyhedron point;
  point.vertices.push_back(Eigen::Vector3d::Zero());
  completeTopology({}, point);
  return point;
}

Polyhedron segmentPolyhedron(double half_length)
{
  Polyhedron segment;
  segment.vertices = {Eigen::Vector3d(0.0, 0.0, -half_length), Eigen::Vector3d(0.0, 0.0, half_length)};
  segment.edges.push_back({{0, 1}});
  completeTopology({}, segment);
  return segment;
}

Polyhedron boxPolyhedron(const Eigen::Vector3d& half_size)
{
  Polyhedron box;
  for (int corner = 0; corner < 8; ++corner)
  {
    const Eigen::Vector3d sign((corner & 1) ? 1.0 : -1.0, (corner & 2) ? 1.0 : -1.0, (corner & 4) ? 1.0 : -1.0);
    box.vertices.push_back(sign.cwiseProduct(half_size));
  }
  completeTopology({{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}, box);
  for (int face = 0; face < 6; ++face)
  {
    box.faces[face].normal = (face % 2 == 0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(face / 2);
    box.faces[face].offset = half_size[face / 2];
  }
  return box;
}

}  // namespace frictional_contact_sim
