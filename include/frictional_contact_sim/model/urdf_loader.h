#pragma once
/**
 * @file urdf_loader.h
 * @brief URDF (urdfdom) to MultibodyModel.
 *
 * Links joined by fixed joints become one body named after its first link; every link stays a Frame. Bodies come depth
 * first, joints in the order of the document (so joint_states keep that order). A capsule's length is that of its
 * cylindrical part. Gazebo's mu1 is read where mu2 is absent or equal.
 * Inertia is judged after lumping and joint by joint: what a joint moves counts, not its own link. A joint that moves
 * none gets min_joint_inertia or follows its mimic; both are warnings. Not finite or negative ones are refused.
 * Visuals are not read: their meshes may be missing.
 */
#include <optional>
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

/// Of a joint that moves none, where nothing is said and the body has no mass, see loadUrdf [kg m^2] or [kg].
constexpr double DEFAULT_JOINT_INERTIA = 1e-6;

struct LoadedModel
{
  MultibodyModel model;
  std::vector<std::string> warnings;  ///< one line each: what the file has and this package does not honour (yet)
};

/**
 * @brief Reads a URDF document.
 * @param xml the document
 * @param source name for messages (a path or "robot_description"); relative mesh paths are relative to its folder
 * @param min_joint_inertia > 0, given to joints that move no inertia [kg m^2], [kg] where they slide; unset: 1e-6 of
 * the body's mass (times its radius of gyration squared), DEFAULT_JOINT_INERTIA where it has none
 * @throws ModelError broken XML, two roots, negative inertia, unknown mesh, ...
 */
LoadedModel loadUrdf(const std::string& xml, const std::string& source, BaseType base,
                     const std::optional<double>& min_joint_inertia = {});
/** @brief The same for a file. */
LoadedModel loadUrdfFile(const std::string& path, BaseType base, const std::optional<double>& min_joint_inertia = {});

/** @brief "auto", "floating" or "fixed". @throws std::invalid_argument listing them */
BaseType parseBaseType(const std::string& text);

/**
 * @brief package://name/path (ROS_PACKAGE_PATH, through rospack), file:///path, absolute, or relative to `folder`. More
 * slashes than needed are one; a path that only exists percent-decoded is decoded.
 * @throws ModelError when the package or the file does not exist
 */
std::string resolvePath(const std::string& uri, const std::string& folder);

}  // namespace frictional_contact_sim
