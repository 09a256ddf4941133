#pragma once
/**
 * @file elastic_mesh.h
 * @brief Meshes of simplices for linear elasticity, and their matrices.
 *
 * A mesh has dimension 1 (bars along x), 2 (triangles in the x-z plane of the body) or 3 (tetrahedra). Displacements
 * are linear on each cell (P1). With shape functions N_a of gradient g_a, constant on a cell of volume V,
 *
 *     K_ab = V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I),    M_ab = rho V (1 + delta_ab) / ((d + 1)(d + 2))
 * I
 *
 * lambda, mu Lame's constants; plane stress has 2 lambda mu/(lambda + 2 mu) for lambda, a bar E - 2 mu, so that E is
 * its modulus. In the plane V is area times thickness, of a bar length times cross-section. Source: Hughes, The Finite
 * Element Method (2000), sections 2.7, 2.9, 7.3.
 */
#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
enum class PlaneModel
{
  STRAIN,
  STRESS
};

struct ElasticMaterial
{
  double young_modulus = 0.0;  ///< [Pa] > 0
  double poisson_ratio = 0.0;  ///< [-] in [0, 0.5)
  double density = 0.0;  ///< [kg/m^3] > 0
  PlaneModel plane = PlaneModel::STRAIN;
  double thickness = 1.0;  ///< of plane bodies [m] > 0
  double area = 1.0;  ///< cross-section of bars [m^2] > 0
};

struct ElasticMesh
{
  int dimension = 3;
  std::vector<Eigen::Vector3d> nodes;  ///< body frame [m]
  std::vector<std::array<int, 4>> cells;  ///< dimension + 1 nodes, then -1; positive volume
  std::vector<std::array<int, 3>> facets;  ///< of the boundary, dimension nodes, then -1; see Facet for the order
  std::map<std::string, std::vector<int>> groups;  ///< of nodes, by the name that the file has for them
};

/** @brief Which displacement components the nodes have: x; x, z; or x, y, z. */
const std::vector<int>& axesOf(int dimension);

/** @brief A bar along x about the origin. @param length [m] > 0, cells >= 1 */
ElasticMesh barMesh(double length, int cells);
/** @brief A rectangle in x and z (two sizes) or a block (three), about the origin, of cells in two triangles (whose
 * diagonals alternate) or six tetrahedra (Kuhn). @param size [m] > 0, cells >= 1, as many */
ElasticMesh boxMesh(const std::vector<double>& size, const std::vector<int>& cells);
/**
 * @brief A mesh of Gmsh, formats 2.2 and 4.1 in ASCII: tetrahedra, or else triangles in a plane z = constant, whose y
 * becomes the body's z. Physical groups with a name become groups.
 * @throws ModelError with file and line, what was found and what was expected
 */
ElasticMesh readGmsh(const std::string& path);

/** @brief Orders the nodes of every cell to positive volume, finds facets. @throws ModelError for a cell without volume
 */
void closeMesh(ElasticMesh& mesh);

/** @brief What a linear elastic body is made of, before supports. */
struct ElasticParts
{
  int dimension = 3;
  std::vector<Eigen::Vector3d> nodes;  ///< N, body frame [m]
  std::vector<std::array<int, 4>> cells;  ///< may be empty: matrices of unknown origin
  std::vector<int> surface;  ///< nodes that touch, ascending
  std::vector<std::array<int, 3>> facets;
  SparseRows mass;  ///< dimension N square, node by node [kg]
  SparseRows stiffness;  ///< [N/m]
  std::map<std::string, std::vector<int>> groups;
};

ElasticParts assembleElastic(const ElasticMesh& mesh, const ElasticMaterial& material);

/**
 * @brief Matrices that a finite-element program has exported.
 * @param mass, stiffness Matrix Market files, coordinate real, general or symmetric
 * @param nodes CSV with the columns x, y, z and, where given, surface and fixed (0 or 1); a line a node in the order of
 * the matrices, which have 1, 2 (x and z) or 3 rows a node
 * @throws ModelError with file and line, what was found and what was expected
 */
ElasticParts readMatrices(const std::string& mass, const std::string& stiffness, const std::string& nodes);

/** @brief Nodes of a group, or on a side of the bounding box: left, right (x), front, back (y), bottom, top (z).
 *  @throws ModelError listing what there is */
std::vector<int> nodesNamed(const ElasticParts& parts, const std::string& name);

/** @brief Gradients of the shape functions of a cell's nodes, rows in body axes [1/m]; zero along what the mesh has
 * not.
 */
Eigen::Matrix<double, 4, 3> cellGradients(const ElasticParts& parts, const std::array<int, 4>& cell);

}  // namespace frictional_contact_sim
