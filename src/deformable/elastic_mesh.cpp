#include "frictional_contact_sim/deformable/elastic_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
using Cell = std::array<int, 4>;

/** Volume and gradients (rows) of the shape functions of a simplex, in the axes of the dimension. */
struct Simplex
{
  double volume;  ///< with sign
  Eigen::Matrix<double, 4, 3> gradients = Eigen::Matrix<double, 4, 3>::Zero();
};

Simplex simplexOf(const std::vector<Eigen::Vector3d>& nodes, const Cell& cell, int dimension)
{
  const std::vector<int>& axes = axesOf(dimension);
  Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
  for (int a = 0; a < dimension; ++a)
    for (int i = 0; i < dimension; ++i)
      edges(i, a) = nodes[cell[a + 1]][axes[i]] - nodes[cell[0]][axes[i]];
  constexpr double FACTORIAL[] = {1.0, 1.0, 2.0, 6.0};
  Simplex simplex{edges.determinant() / FACTORIAL[dimension]};
  if (simplex.volume == 0.0)
    return simplex;
  const Eigen::Matrix3d inverse = edges.inverse();
  for (int a = 0; a < dimension; ++a)
    for (int i = 0; i < dimension; ++i)
    {
      simplex.gradients(a + 1, i) = inverse(a, i);
      simplex.gradients(0, i) -= inverse(a, i);
    }
  return simplex;
}

/** The facet opposite to a node, its normal outwards; see Facet. */
std::array<int, 3> facetOf(const ElasticMesh& mesh, const Cell& cell, int opposite)
{
  std::array<int, 3> facet{-1, -1, -1};
  int count = 0;
  for (int a = 0; a <= mesh.dimension; ++a)
    if (a != opposite)
      facet[count++] = cell[a];
  if (count == 1)
    return facet;
  const Eigen::Vector3d edge = mesh.nodes[facet[1]] - mesh.nodes[facet[0]];
  const Eigen::Vector3d normal = count == 2 ? edge.cross(Eigen::Vector3d::UnitY())
                                            : Eigen::Vector3d(edge.cross(mesh.nodes[facet[2]] - mesh.nodes[facet[0]]));
  if (normal.dot(mesh.nodes[cell[opposite]] - mesh.nodes[facet[0]]) > 0.0)
    std::swap(facet[0], facet[1]);
  return facet;
}

/** Whether an even number of swaps sorts the nodes of a facet: cells on its two sides have it in opposite orders. */
bool isEven(const std::array<int, 3>& facet, int count)
{
  int swaps = 0;
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b)
      swaps += facet[a] > facet[b] ? 1 : 0;
  return swaps % 2 == 0;
}

/** A facet of the cells seen so far. */
struct SharedFacet
{
  std::array<int, 3> nodes;  ///< as its first cell has it
  size_t cell;  ///< the first one
  int cells = 1;
};
}  // namespace

const std::vector<int>& axesOf(int dimension)
{
  static const std::vector<int> AXES[] = {{}, {0}, {0, 2}, {0, 1, 2}};
  return AXES[dimension];
}

void closeMesh(ElasticMesh& mesh)
{
  std::map<std::array<int, 3>, SharedFacet> seen;  // by its sorted nodes
  for (size_t c = 0; c < mesh.cells.size(); ++c)
  {
    Cell& cell = mesh.cells[c];
    const double volume = simplexOf(mesh.nodes, cell, mesh.dimension).volume;
    if (!(std::abs(volume) > 0.0) || !std::isfinite(volume))
      throw ModelError("cell " + std::to_string(c + 1) + " has no volume");
    if (volume < 0.0)
      std::swap(cell[0], cell[1]);
    for (int opposite = 0; opposite <= mesh.dimension; ++opposite)
    {
      const std::array<int, 3> facet = facetOf(mesh, cell, opposite);
      std::array<int, 3> sorted = facet;
      std::sort(sorted.begin(), sorted.end());
      const auto [entry, is_new] = seen.try_emplace(sorted, SharedFacet{facet, c});
      SharedFacet& shared = entry->second;
      if (!is_new && (++shared.cells > 2 ||
                      (mesh.dimension > 1 && isEven(facet, mesh.dimension) == isEven(shared.nodes, mesh.dimension))))
        throw ModelError("cells " + std::to_string(shared.cell + 1) + " and " + std::to_string(c + 1) +
                         " lie on one side of a facet that they share, expected every cell once and none in another");
    }
  }
  mesh.facets.clear();
  for (const auto& entry : seen)
    if (entry.second.cells == 1)
      mesh.facets.push_back(entry.second.nodes);
}

ElasticMesh barMesh(double length, int cells)
{
  ElasticMesh mesh;
  mesh.dimension = 1;
  for (int i = 0; i <= cells; ++i)
    mesh.nodes.emplace_back(length * (static_cast<double>(i) / cells - 0.5), 0.0, 0.0);
  for (int i = 0; i < cells; ++i)
    mesh.cells.push_back({i, i + 1, -1, -1});
  closeMesh(mesh);
  return mesh;
}

ElasticMesh boxMesh(const std::vector<double>& size, const std::vector<int>& cells)
{
  ElasticMesh mesh;
  mesh.dimension = static_cast<int>(size.size());
  const bool is_plane = mesh.dimension == 2;
  const std::array<int, 3> count =
      is_plane ? std::array<int, 3>{cells[0], 0, cells[1]} : std::array<int, 3>{cells[0], cells[1], cells[2]};
  const Eigen::Vector3d extent(size[0], is_plane ? 0.0 : size[1], size.back());
  const auto index = [&](int i, int j, int k) { return (k * (count[1] + 1) + j) * (count[0] + 1) + i; };
  const auto share = [&](int axis, int i)
  { return count[axis] == 0 ? 0.0 : static_cast<double>(i) / count[axis] - 0.5; };
  for (int k = 0; k <= count[2]; ++k)
    for (int j = 0; j <= count[1]; ++j)
      for (int i = 0; i <= count[0]; ++i)
        mesh.nodes.emplace_back(extent.x() * share(0, i), extent.y() * share(1, j), extent.z() * share(2, k));
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < std::max(1, count[1]); ++j)
      for (int i = 0; i < count[0]; ++i)
      {
        if (is_plane)
        {
          const int a = index(i, 0, k);
          const int b = index(i + 1, 0, k);
          const int c = index(i + 1, 0, k + 1);
          const int d = index(i, 0, k + 1);
          if ((i + k) % 2 == 0)
            mesh.cells.insert(mesh.cells.end(), {Cell{a, b, c, -1}, Cell{a, c, d, -1}});
          else
            mesh.cells.insert(mesh.cells.end(), {Cell{a, b, d, -1}, Cell{b, c, d, -1}});
          continue;
        }
        // Kuhn: one tetrahedron for each order in which the three steps from corner to corner are taken
        std::array<int, 3> order{0, 1, 2};
        do
        {
          std::array<int, 3> at{i, j, k};
          Cell cell{index(i, j, k), 0, 0, 0};
          for (int step = 0; step < 3; ++step)
          {
            ++at[order[step]];
            cell[step + 1] = index(at[0], at[1], at[2]);
          }
          mesh.cells.push_back(cell);
        } while (std::next_permutation(order.begin(), order.end()));
      }
  closeMesh(mesh);
  return mesh;
}

ElasticParts assembleElastic(const ElasticMesh& mesh, const ElasticMaterial& material)
{
  const int d = mesh.dimension;
  ElasticParts parts{d, mesh.nodes, mesh.cells, {}, mesh.facets, {}, {}, mesh.groups};
  const double mu = 0.5 * material.young_modulus / (1.0 + material.poisson_ratio);
  double lambda = 2.0 * mu * material.poisson_ratio / (1.0 - 2.0 * material.poisson_ratio);
  if (d == 1)
    lambda = material.young_modulus - 2.0 * mu;
  else if (d == 2 && material.plane == PlaneModel::STRESS)
    lambda = 2.0 * lambda * mu / (lambda + 2.0 * mu);
  const double across = d == 1 ? material.area : d == 2 ? material.thickness : 1.0;
  std::vector<Eigen::Triplet<double>> mass;
  std::vector<Eigen::Triplet<double>> stiffness;
  for (const Cell& cell : mesh.cells)
  {
    const Simplex simplex = simplexOf(mesh.nodes, cell, d);
    const double volume = across * simplex.volume;
    const double share = material.density * volume / ((d + 1) * (d + 2));
    for (int a = 0; a <= d; ++a)
      for (int b = 0; b <= d; ++b)
      {
        const auto g = simplex.gradients.row(a);
        const auto h = simplex.gradients.row(b);
        for (int i = 0; i < d; ++i)
        {
          for (int j = 0; j < d; ++j)
            stiffness.emplace_back(d * cell[a] + i, d * cell[b] + j,
                                   volume * (lambda * g[i] * h[j] + mu * g[j] * h[i] + (i == j ? mu * g.dot(h) : 0.0)));
          mass.emplace_back(d * cell[a] + i, d * cell[b] + i, share * (a == b ? 2.0 : 1.0));
        }
      }
  }
  const auto size = static_cast<Eigen::Index>(mesh.nodes.size()) * d;
  parts.mass.resize(size, size);
  parts.mass.setFromTriplets(mass.begin(), mass.end());
  parts.stiffness.resize(size, size);
  parts.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  for (const std::array<int, 3>& facet : mesh.facets)
    for (const int node : facet)
      if (node >= 0)
        parts.surface.push_back(node);
  std::sort(parts.surface.begin(), parts.surface.end());
  parts.surface.erase(std::unique(parts.surface.begin(), parts.surface.end()), parts.surface.end());
  return parts;
}

std::vector<int> nodesNamed(const ElasticParts& parts, const std::string& name)
{
  const auto group = parts.groups.find(name);
  if (group != parts.groups.end())
    return group->second;
  static const char* const SIDES[] = {"left", "right", "front", "back", "bottom", "top"};
  const auto side = std::find(std::begin(SIDES), std::end(SIDES), name) - std::begin(SIDES);
  const int axis = static_cast<int>(side) / 2;
  if (side == 6)
  {
    std::string known;
    for (const char* const one : SIDES)
      known += std::string(known.empty() ? "" : ", ") + one;
    for (const auto& entry : parts.groups)
      known += ", " + entry.first;
    throw ModelError("fixed: found '" + name + "', expected one of " + known);
  }
  const double sign = side % 2 == 0 ? -1.0 : 1.0;
  double farthest = -std::numeric_limits<double>::infinity();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& node : parts.nodes)
  {
    farthest = std::max(farthest, sign * node[axis]);
    nearest = std::min(nearest, sign * node[axis]);
  }
  std::vector<int> found;
  for (size_t i = 0; i < parts.nodes.size(); ++i)
    if (sign * parts.nodes[i][axis] >= farthest - 1e-9 * (farthest - nearest))
      found.push_back(static_cast<int>(i));
  return found;
}

Eigen::Matrix<double, 4, 3> cellGradients(const ElasticParts& parts, const std::array<int, 4>& cell)
{
  const Simplex simplex = simplexOf(parts.nodes, cell, parts.dimension);
  const std::vector<int>& axes = axesOf(parts.dimension);
  Eigen::Matrix<double, 4, 3> gradients = Eigen::Matrix<double, 4, 3>::Zero();
  for (int i = 0; i < parts.dimension; ++i)
    gradients.col(axes[i]) = simplex.gradients.col(i);
  return gradients;
}

}  // namespace frictional_contact_sim
