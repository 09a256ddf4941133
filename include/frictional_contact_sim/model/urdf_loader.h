#pragma once
/**
 * @file urdf_loader.h
 * @brief URDF (urdfdom) to MultibodyModel.
 *
 * Links joined by fixed joints become one body named after its first link; every link stays a Frame. Bodies come depth
 * first, joints in the order of the document (so joint_states keep that order). A capsule's length is that of its
 * cylindrical part. Gazebo's mu1 is read where mu2 is absent or equal.
 * Inertia is judged after lumping: a moving body needs mass and three positive principal moments, or what it carries
 * must keep the mass matrix positive definite (then it is named in a warning). The body of a fixed base needs none.
 * Visuals are not read: their meshes may be missing.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/model/model_error.h"
#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
enum class BaseType
{
  AUTO,  ///< Gazebo's convention: fixed when the root link is named `world`, else floating
  FLOATING,
  FIXED
};

struct LoadedModel
{
  MultibodyModel model;
  std::vector<std::string> warnings;  ///< one line each: what the file has and this package does not honour (yet)
};

/**
 * @brief Reads a URDF document.
 * @param xml the document
 * @param source name for messages (a path or "robot_description"); relative mesh paths are relative to its folder
 * @throws ModelError broken XML, two roots, zero or not positive definite inertia of a moving body, unknown mesh, ...
 */
LoadedModel loadUrdf(const std::string& xml, const std::string& source, BaseType base);
/** @brief The same for a file. */
LoadedModel loadUrdfFile(const std::string& path, BaseType base);

/** @brief "auto", "floating" or "fixed". @throws std::invalid_argument listing them */
BaseType parseBaseType(const std::string& text);

/**
 * @brief package://name/path (ROS_PACKAGE_PATH, through rospack), file://path, absolute, or relative to `folder`.
 * @throws ModelError when the package or the file does not exist
 */
std::string resolvePath(const std::string& uri, const std::string& folder);

}  // namespace frictional_contact_sim
