#pragma once
/**
 * @file multibody_model.h
 * @brief A tree of rigid links in Lagrangian coordinates: the constant part (Model of Model / Data / free functions).
 *
 * Links are URDF links after lumping fixed joints; link i moves relative to its parent (-1 = world) by joint i, and
 * parents come before children. Link 0 is the root; its joint is FLOATING or FIXED (the base). Every URDF link, lumped
 * or not, is a Frame of its link.
 *
 * Coordinates of a joint, in its joint frame on the parent (q: nq numbers, v: nv numbers):
 *   REVOLUTE, CONTINUOUS  angle [rad]                                     | angular velocity about the axis
 *   PRISMATIC             displacement [m]                                | velocity along the axis
 *   PLANAR                x, y [m] along planarAxes(axis), angle          | their time derivatives
 *   FLOATING              x, y, z [m], quaternion x y z w                 | velocity of the child origin, angular
 *                                                                           velocity, both in the axes of the joint
 *                                                                           frame on the parent (the world for a base)
 *   FIXED (base only)     -                                               | -
 * Integration of a floating joint: p <- p + dt v, quaternion <- exp(dt w) quaternion.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <vector>

#include "frictional_contact_sim/model/geometry.h"
#include "frictional_contact_sim/model/loop_joint.h"

namespace frictional_contact_sim
{
enum class JointType
{
  REVOLUTE,
  CONTINUOUS,
  PRISMATIC,
  PLANAR,
  FLOATING,
  FIXED
};

/** @brief Width of a joint type in q. */
int positionSize(JointType type);
/** @brief Width of a joint type in v. */
int velocitySize(JointType type);

/**
 * @brief The two in-plane directions of a PLANAR joint: columns, unit, with the normal a right-handed triad.
 * Normal z gives x and y; any other normal turns them by the least rotation that takes z to the normal (z to -z: about
 * x).
 */
Eigen::Matrix<double, 3, 2> planarAxes(const Eigen::Vector3d& normal);

struct RigidInertia
{
  double mass = 0.0;  ///< [kg]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< centre of mass in the link frame [m]
  Eigen::Matrix3d rotational = Eigen::Matrix3d::Zero();  ///< about the centre of mass, link axes [kg m^2]
};

/** @brief URDF's <limit>; without one, positions are unbounded and effort is unlimited. */
struct JointLimit
{
  double lower = -std::numeric_limits<double>::infinity();  ///< [rad] or [m]
  double upper = std::numeric_limits<double>::infinity();  ///< [rad] or [m]
  double effort = std::numeric_limits<double>::infinity();  ///< [N m] or [N]
  double velocity = std::numeric_limits<double>::infinity();  ///< [rad/s] or [m/s]
};

struct Mimic
{
  int joint = -1;  ///< index of the joint that is followed, -1 = none
  double multiplier = 1.0;  ///< q = multiplier q_joint + offset
  double offset = 0.0;
};

struct Joint
{
  std::string name;  ///< URDF name; the base's is empty
  JointType type = JointType::FIXED;
  int parent = -1;  ///< link this joint hangs on, -1 = world
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< joint frame in the parent link frame
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector, joint frame (PLANAR: plane normal)
  int q_index = 0;  ///< first coordinate in q
  int v_index = 0;  ///< first coordinate in v
  JointLimit limit;
  double damping = 0.0;  ///< viscous [N m s/rad] or [N s/m]
  double dry_friction = 0.0;  ///< Coulomb threshold [N m] or [N]
  Mimic mimic;
};

/** @brief A moving link: one or more URDF links rigidly joined. */
struct Link
{
  std::string name;  ///< of its root link
  RigidInertia inertia;
};

/** @brief A URDF link in the link that carries it. */
struct Frame
{
  Frame() = default;
  Frame(const std::string& link_name, int carrier, const Eigen::Isometry3d& pose)
    : name(link_name), link(carrier), placement(pose)
  {
  }

  std::string name;
  int link = 0;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< link frame in the link frame
  int parent = -1;  ///< frame that its URDF joint hangs on, -1 = none; parents come before children
  std::string joint;  ///< that joint, of any type; empty for the root
  RigidInertia inertia;  ///< of this URDF link alone, in its own frame; those of a link sum up to the link's
};

struct CollisionShape
{
  std::string name;  ///< URDF collision name, or link_collision_k
  int frame = 0;  ///< index of the URDF link
  int link = 0;
  Geometry geometry;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< shape frame in the link frame
  double friction = -1.0;  ///< Gazebo's mu1 where given, else negative: the material decides
};

struct MultibodyModel
{
  std::string name;
  std::vector<Link> links;  ///< parents first
  std::vector<Joint> joints;  ///< joint i moves link i
  std::vector<Frame> frames;
  std::vector<CollisionShape> shapes;
  std::vector<LoopJoint> loops;  ///< no part of the tree: rows of the simulation
  int nq = 0;
  int nv = 0;
  std::vector<int> dof_parent;  ///< nv: the velocity coordinate before this one on the way to the root, -1 at the root
  std::vector<int> dof_run;  ///< nv: first coordinate of the unbroken run (dof_parent[i] = i - 1) that ends here
  std::vector<int> dof_link;  ///< nv: link moved by the coordinate
  std::vector<int> link_dof;  ///< links: last velocity coordinate on the way from the root to the link, -1 = none
  /// nv: on the diagonal of the mass matrix, of coordinates whose links move none at some position, as a rotor that
  /// turns with the joint would have it; see model/joint_inertia.h [kg m^2] or [kg]
  Eigen::VectorXd armature;

  /** @return index or -1 */
  int findJoint(const std::string& joint_name) const;
  int findFrame(const std::string& link_name) const;
  double totalMass() const;
};

/**
 * @brief Fills nq, nv, q_index, v_index, dof_parent, dof_run, dof_link, link_dof from the joints, armature with zeros.
 * Call after editing joints by hand.
 * @throws std::invalid_argument when joints and links differ in number, a parent does not come first, or an axis is
 * not a unit vector
 */
void finalize(MultibodyModel& model);

}  // namespace frictional_contact_sim
