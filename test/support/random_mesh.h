#pragma once
/**
 * @file random_mesh.h
 * @brief Meshes as robots have them, from a seed: spheres, tori, plates with filleted edges (soles), cones, thin open
 * shells, needles; from a dozen to some ten thousand vertices, from 1 mm to 100 m, turned and off the origin.
 *
 * All are rings of points around an axis. The volume of their convex hull is exact, from the rings: the area A of a
 * ring's polygon, frustums dz/3 (A_1 + sqrt(A_1 A_2) + A_2) between them; a filleted plate is the Minkowski sum of a
 * box (half sizes a, b, c) and a round body P of such rings: 8abc + 8r(ab + bc + ca) + 2(a A_x + b A_y + c A_z) + V(P),
 * A_i the areas of its projections.
 */
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "support/dice.h"

namespace frictional_contact_sim
{
namespace test_support
{
enum class MeshKind
{
  SPHERE,
  TORUS,
  FILLETED_PLATE,
  CONE,
  SHELL,  ///< part of a sphere, open
  NEEDLE,  ///< spheroid, 20 to 1000 times as long as it is wide
  KINDS
};

struct RandomMesh
{
  std::string name;  ///< "torus_17"
  MeshKind kind = MeshKind::SPHERE;
  std::vector<Eigen::Vector3d> vertices;  ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise from outside
  double size = 0.0;  ///< largest distance of a vertex from the middle of the bounding box [m]
  bool is_closed = true;
  bool is_convex = true;  ///< to the last vertex: the hull is the mesh
  double hull_volume = 0.0;  ///< [m^3]
};

/** @brief The same mesh for the same seed; sizes from 1e-3 to 1e2 m. Kind: seed mod 6. */
RandomMesh makeRandomMesh(std::uint32_t seed);
/** @brief One of a kind and size, around the origin, for scenes: axis z, the plate flat on it; not turned. */
RandomMesh makeRandomMesh(MeshKind kind, double size, Dice& dice);

/** @brief Binary STL, single precision. */
void writeStl(const RandomMesh& mesh, const std::string& path);
/** @brief OBJ with 9 digits, one object for each mesh. */
void writeObj(const std::vector<RandomMesh>& meshes, const std::string& path);

}  // namespace test_support
}  // namespace frictional_contact_sim
