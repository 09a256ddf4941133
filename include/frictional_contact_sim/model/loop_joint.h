#pragma once
/**
 * @file loop_joint.h
 * @brief What closes a kinematic loop: a joint between two links beside the tree.
 */
#include <Eigen/Geometry>
#include <string>

namespace frictional_contact_sim
{
enum class LoopType
{
  POINT,  ///< two points are one: a ball joint, 3 rows
  AXIS,  ///< their z axes are one too: a hinge, 5 rows
  WELD  ///< no relative motion, 6 rows
};
const char* toString(LoopType type);

/** @brief How many rows it has. */
inline int rowsOf(LoopType type)
{
  return type == LoopType::POINT ? 3 : type == LoopType::AXIS ? 5 : 6;
}

/** @brief Of one body: its URDF's <loop_joint>. */
struct LoopJoint
{
  std::string name;
  LoopType type = LoopType::POINT;
  int frame_a = -1;  ///< the child, a frame of the model
  int frame_b = -1;  ///< the parent
  Eigen::Isometry3d anchor = Eigen::Isometry3d::Identity();  ///< the joint in frame a; its z axis is that of AXIS
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< the joint in frame b
};

/** @brief An orientation whose z axis is `axis` (any length but zero), the identity for (0, 0, 1). */
Eigen::Matrix3d orientationAlong(const Eigen::Vector3d& axis);

}  // namespace frictional_contact_sim
