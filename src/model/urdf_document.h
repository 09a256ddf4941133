#pragma once
/**
 * @file urdf_document.h
 * @brief A checked URDF document: what urdfdom may be given, and what urdfdom would drop. Private to model/.
 */
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/model/loop_joint.h"

namespace frictional_contact_sim
{
/** @brief <loop_joint>, an extension of ours (docs/interfaces.md). */
struct LoopElement
{
  std::string name;
  int line = 0;
  LoopType type = LoopType::POINT;
  std::string parent, child;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  ///< of the joint in the parent
  std::optional<Eigen::Isometry3d> child_origin;  ///< in the child; none: where it is in the zero position
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< in the joint's frame, of AXIS
};

struct UrdfDocument
{
  std::string text;  ///< for urdfdom: no visuals, capsules written as cylinders
  std::map<std::string, int> joint_order;  ///< joint name -> place in the document (urdfdom sorts by name)
  std::set<std::pair<std::string, int>> capsules;  ///< link, place of the <collision> in the link
  std::map<std::string, double> friction;  ///< link -> Gazebo's mu1 [-]
  std::vector<LoopElement> loops;
  std::vector<std::string> warnings;
};

/**
 * @brief Parses and checks a document: XML, names, numbers, the tree of links, limits, mimics.
 * @throws ModelError "source:line: ..." in one line
 */
UrdfDocument readDocument(const std::string& xml, const std::string& source);

}  // namespace frictional_contact_sim
