#pragma once
/**
 * @file polyhedron.h
 * @brief Convex polyhedra with their faces, edges and vertices: boxes, hulls, and the degenerate ones with one vertex
 * (core of a sphere) or two (core of a capsule).
 *
 * Hulls: Quickhull (Barber, Dobkin, Huhdanpaa 1996) by libqhull; its triangles are merged into polygonal faces because
 * contact manifolds need whole faces. Triangles merge when their vertices are within 2e-6 of the size of one plane:
 * mesh files are in single precision, a flat side comes with 1e-7 of noise.
 */
#include <Eigen/Core>
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
  };

  std::vector<Eigen::Vector3d> vertices;  ///< [m]
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<int> face_vertices;  ///< loops, counter-clockwise seen from outside
  std::vector<int> face_edges;  ///< edge from corner k to corner k + 1 of the loop
  std::vector<int> neighbour_first;  ///< vertices + 1: where the neighbours of a vertex start
  std::vector<int> neighbours;  ///< vertices at the other end of its edges
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the bounding box [m]
  Eigen::Vector3d half_extent = Eigen::Vector3d::Zero();  ///< of the bounding box [m]
  Eigen::Vector3d interior = Eigen::Vector3d::Zero();  ///< mean of the vertices: a point inside [m]
  double size = 0.0;  ///< largest distance of a vertex from center [m]

  /** @brief Edge between two vertices, -1 when there is none. */
  int findEdge(int vertex_0, int vertex_1) const;
};

Polyhedron pointPolyhedron();
/** @brief From (0, 0, -half_length) to (0, 0, half_length). */
Polyhedron segmentPolyhedron(double half_length);
Polyhedron boxPolyhedron(const Eigen::Vector3d& half_size);

/**
 * @brief Convex hull; vertices nearer than 1e-6 of the size are one, corners inside a face or on an edge are dropped.
 * @throws std::invalid_argument with the reason: fewer than four points not in one plane, not finite
 */
Polyhedron convexHull(const std::vector<Eigen::Vector3d>& points);

/**
 * @brief Vertices of a mesh file (STL, DAE, OBJ, ... through assimp), metres.
 *
 * Conventions of rviz and Gazebo: the transforms of the nodes and the <unit> of a DAE are applied, its <up_axis> is not
 * (robot descriptions are written for the coordinates as they stand in the file). STL and OBJ have neither.
 * @throws ModelError naming the file and the reason
 */
std::vector<Eigen::Vector3d> readMesh(const std::string& path, const Eigen::Vector3d& scale);

/** @brief convexHull(readMesh(...)). @throws ModelError naming the file and the reason */
Polyhedron loadMeshHull(const std::string& path, const Eigen::Vector3d& scale);

}  // namespace frictional_contact_sim
