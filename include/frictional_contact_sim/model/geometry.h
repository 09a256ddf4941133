#pragma once
/**
 * @file geometry.h
 * @brief Collision shapes as the URDF describes them, before any mesh is loaded (collision/ does that).
 */
#include <Eigen/Core>
#include <string>
#include <variant>

namespace frictional_contact_sim
{
struct Sphere
{
  double radius;  ///< [m] >= 0, 0 = a point
};
struct Box
{
  Eigen::Vector3d half_size;  ///< half edge lengths [m] > 0
};
/// Axis z, centred at the origin (URDF's convention).
struct Cylinder
{
  double radius;  ///< [m] > 0
  double half_length;  ///< [m] > 0
};
/// Cylinder of the half length with a half sphere at each end, axis z.
struct Capsule
{
  double radius;  ///< [m] > 0
  double half_length;  ///< of the cylindrical part [m] >= 0
};
/// Convex hull of the vertices of a mesh file.
struct Mesh
{
  std::string path;  ///< absolute path of the file, resolved by the loader
  Eigen::Vector3d scale;  ///< factor per axis [-]
};
/// The half space z <= 0 of its frame: the ground.
struct HalfSpace
{
};

using Geometry = std::variant<Sphere, Box, Cylinder, Capsule, Mesh, HalfSpace>;

}  // namespace frictional_contact_sim
