#pragma once
/**
 * @file random_robot.h
 * @brief A random robot as URDF text: a tree of 1 to 25 links with every joint type, chains of mimic joints, limits,
 * dry friction, damping, masses that differ by up to 900 within a robot; see random_scene.h. On request most shapes are
 * meshes (random_mesh.h): whole robots of them, feet, single bodies.
 */
#include <Eigen/Core>
#include <string>
#include <vector>

#include "frictional_contact_sim/model/urdf_loader.h"
#include "support/dice.h"
#include "support/random_mesh.h"

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief A joint as written, and where it is to start. */
struct RandomJoint
{
  std::string name, type;
  int parent = -1;
  bool single = false;  ///< one coordinate, follows no other
  double lower = -10.0, upper = 10.0, start = 0.0;
  bool limited = false;
};

/** @brief A mesh that the text names. */
struct NamedMesh
{
  std::string file;  ///< name in the text, without a folder
  std::string frame;  ///< link that it belongs to
  RandomMesh mesh;
};

struct RandomRobot
{
  std::string xml;
  double size = 0.0;  ///< of a link, about [m]
  double mass = 0.0;  ///< of all links [kg]
  std::vector<RandomJoint> joints;
  std::vector<NamedMesh> meshes;
};

/** @param mesh_prefix where not empty: most shapes are meshes with file names that begin so */
RandomRobot randomRobot(Dice& dice, const std::string& mesh_prefix = "");

/** @brief Where a body with the pose of its root at the origin ends: circle about z, and heights. */
struct Extent
{
  double radius = 0.0, low = 1e9, high = -1e9;
};

/** @brief With `joints` at their starts and the root turned by roll, pitch, yaw. */
Extent extentOf(const RandomRobot& robot, BaseType base, const Eigen::Vector3d& rpy);

}  // namespace test_support
}  // namespace frictional_contact_sim
