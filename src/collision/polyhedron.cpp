#include "frictional_contact_sim/collision/polyhedron.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
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
  std::vector<std::vector<int>> lists(polyhedron.vertices.size());
  for (const Polyhedron::Edge& edge : polyhedron.edges)
  {
    lists[edge.vertex[0]].push_back(edge.vertex[1]);
    lists[edge.vertex[1]].push_back(edge.vertex[0]);
  }
  polyhedron.neighbour_first.assign(1, 0);
  for (const std::vector<int>& list : lists)
  {
    polyhedron.neighbours.insert(polyhedron.neighbours.end(), list.begin(), list.end());
    polyhedron.neighbour_first.push_back(static_cast<int>(polyhedron.neighbours.size()));
  }
}
}  // namespace

void completeTopology(const std::vector<std::vector<int>>& loops, Polyhedron& polyhedron)
{
  std::map<std::pair<int, int>, int> edge_index;
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
      const auto key = std::minmax(v0, v1);
      const auto [entry, is_new] = edge_index.try_emplace(key, static_cast<int>(polyhedron.edges.size()));
      if (is_new)
        polyhedron.edges.push_back({{key.first, key.second}});
      polyhedron.face_vertices.push_back(v0);
      polyhedron.face_edges.push_back(entry->second);
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
  const auto key = std::minmax(vertex_0, vertex_1);
  for (size_t e = 0; e < edges.size(); ++e)
    if (edges[e].vertex[0] == key.first && edges[e].vertex[1] == key.second)
      return static_cast<int>(e);
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
