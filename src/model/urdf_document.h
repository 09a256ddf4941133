#pragma once
/**
 * @file urdf_document.h
 * @brief A checked URDF document: what urdfdom may be given, and what urdfdom would drop. Private to model/.
 */
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace frictional_contact_sim
{
struct UrdfDocument
{
  std::string text;  ///< for urdfdom: no visuals, capsules written as cylinders
  std::map<std::string, int> joint_order;  ///< joint name -> place in the document (urdfdom sorts by name)
  std::set<std::pair<std::string, int>> capsules;  ///< link, place of the <collision> in the link
  std::map<std::string, double> friction;  ///< link -> Gazebo's mu1 [-]
  std::vector<std::string> warnings;
};

/**
 * @brief Parses and checks a document: XML, names, numbers, the tree of links, limits, mimics.
 * @throws ModelError "source:line: ..." in one line
 */
UrdfDocument readDocument(const std::string& xml, const std::string& source);

}  // namespace frictional_contact_sim
