#pragma once
/**
 * @file polyhedron.h
 * @brief Convex polyhedra with their faces, edges and vertices: boxes, hulls, flat polygons (two faces, back to back),
 * and the degenerate ones with one vertex (core of a sphere) or two (core of a capsule).
 *
 * Hulls: Quickhull (Barber, Dobkin, Huhdanpaa 1996) by libqhull; its triangles are merged into polygonal faces because
 * contact manifolds need whole faces. Triangles merge when their vertices are within 5e-7 of the size of one plane:
 * mesh files are in single precision, a flat side comes with 1e-7 of noise. There is no limit to the number of
 * vertices.
 */
#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
struct Polyhedron
{
  struct Face
  {
    Eigen::Vector3d normal;  ///< unit, outwards
    double offset;  ///< normal . x <= offset for all points [m]
    int first;  ///< position of its loop in face_vertices and face_edges
    int size;  ///< number of corners
    double area;  ///< [m^2]
  };
  struct Edge
  {
    int vertex[2];
    int face[2] = {-1, -1};  ///< on both sides
  };

  std::vector<Eigen::Vector3d> vertices;  ///< [m]
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<int> face_vertices;  ///< loops, counter-clockwise seen from outside
  std::vector<int> face_edges;  ///< edge from corner k to corner k + 1 of the loop
  std::vector<int> neighbour_first;  ///< vertices + 1: where the neighbours of a vertex start
  std::vector<int> neighbours;  ///< vertices at the other end of its edges
  std::vector<int> neighbour_edges;  ///< these edges
  bool is_flat = false;  ///< a polygon

  // Hulls and flat polygons, for searches along the surface (polyhedron_search.h).
  std::vector<int> link_first;  ///< vertices + 1: where the links of a vertex start
  std::vector<int> links;  ///< vertices joined to it in the triangles of the hull: edges, and diagonals of its faces
  std::vector<int> starts;  ///< vertices farthest along the directions of a grid on a cube
  double slack = 0.0;  ///< the triangles are those of a convex surface to so much [m]

  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the bounding box [m]
  Eigen::Vector3d half_extent = Eigen::Vector3d::Zero();  ///< of the bounding box [m]
  Eigen::Vector3d interior = Eigen::Vector3d::Zero();  ///< mean of the vertices: a point inside [m]
  double size = 0.0;  ///< largest distance of a vertex from center [m]

  /** @brief Edge between two vertices, -1 when there is none. */
  int findEdge(int vertex_0, int vertex_1) const;
};

/** @brief Workspace of searches for vertices: no allocation once it is large enough. */
struct VertexSearch
{
  std::vector<int> found;
  std::vector<unsigned> mark;  ///< of every vertex: the search that came by last
  unsigned search = 0;

  void reserve(size_t vertices);
};

Polyhedron pointPolyhedron();
/** @brief From (0, 0, -half_length) to (0, 0, half_length). */
Polyhedron segmentPolyhedron(double half_length);
Polyhedron boxPolyhedron(const Eigen::Vector3d& half_size);

/**
 * @brief Convex hull. Vertices nearer than 2.5e-7 of the size are one, corners inside a face or on an edge (within 5e-7
 * of the size) are left out, so that no point is farther outside than 1e-6 of the size; more where the coordinates are
 * so large that single precision leaves more. Points in one plane (5e-7 of the size) give a flat polygon.
 * @throws std::invalid_argument with the reason: all points on one line, not finite
 */
Polyhedron convexHull(const std::vector<Eigen::Vector3d>& points);

/** @brief An object of a mesh file. */
struct MeshPart
{
  std::string name;
  std::vector<Eigen::Vector3d> vertices;  ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< polygons as fans
  bool is_closed = false;  ///< every side of a triangle has one neighbour: it has an inside
};

/**
 * @brief The parts of a mesh file (STL, DAE, OBJ, ... through assimp), metres: an `o` or `g` of an OBJ, a node of a
 * DAE, a solid of an STL each, whatever its materials. Objects that are no closed surfaces make one part together, the
 * last one: pieces of one surface are no bodies of their own.
 *
 * Conventions of rviz and Gazebo: the transforms of the nodes and the <unit> of a DAE are applied, its <up_axis> is not
 * (robot descriptions are written for the coordinates as they stand in the file). STL and OBJ have neither.
 * @throws ModelError naming the file and the reason
 */
std::vector<MeshPart> readMeshParts(const std::string& path, const Eigen::Vector3d& scale);
/** @brief The vertices of all parts. */
std::vector<Eigen::Vector3d> readMesh(const std::string& path, const Eigen::Vector3d& scale);

/**
 * @brief The hulls of the parts of a mesh file, without those inside another one.
 * @param addition what the hulls add to parts that are not convex, one line; empty when that is below 1 % of the
 * volume, or below 5 % of the size where a surface is not closed. Its distance is that of the hull's surface from the
 * mesh's, the largest over samples of the hull's largest triangles, so a lower bound.
 * @throws ModelError naming the file and the reason
 */
std::vector<Polyhedron> loadMeshHulls(const std::string& path, const Eigen::Vector3d& scale, std::string& addition);

/** @brief One hull of all parts: convexHull(readMesh(...)). @throws ModelError naming the file and the reason */
Polyhedron loadMeshHull(const std::string& path, const Eigen::Vector3d& scale);

}  // namespace frictional_contact_sim
