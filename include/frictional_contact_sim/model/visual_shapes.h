#pragma once
/**
 * @file visual_shapes.h
 * @brief What a URDF draws: its <visual> elements, for pictures only. Nothing of it is needed to simulate, so what
 * cannot be read is left out without a word.
 */
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "frictional_contact_sim/model/geometry.h"

namespace frictional_contact_sim
{
struct VisualShape
{
  std::string link;  ///< URDF link
  Geometry geometry;  ///< the path of a mesh is its URI as it is written; a relative one is made absolute
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< in the frame of the URDF link
  std::optional<Eigen::Vector4d> color;  ///< red, green, blue, opacity, 0 to 1
};

/** @param xml the document. @param folder where relative mesh paths start */
std::vector<VisualShape> readVisualShapes(const std::string& xml, const std::string& folder);

}  // namespace frictional_contact_sim
