#pragma once
/**
 * @file scenario.h
 * @brief What is simulated, as data: the content of a scenario file (../shared INTERFACES section 4) and the defaults
 * that the node's parameters share with it.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/model/urdf_loader.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct Material
{
  double friction = 0.8;     ///< Coulomb coefficient [-] >= 0
  double restitution = 0.0;  ///< normal, Moreau [-] in [0, 1]
};

struct MaterialTable
{
  Material fallback;                                              ///< `default`
  std::map<std::string, Material> materials;                      ///< single materials by name
  std::map<std::pair<std::string, std::string>, Material> pairs;  ///< names in alphabetical order
};

/** @brief Servo or effort on one joint. Unset numbers (NaN) get defaults from the joint's inertia (dynamics/servo.h). */
struct JointCommand
{
  enum class Mode
  {
    EFFORT,
    POSITION,
    VELOCITY
  };
  Mode mode = Mode::EFFORT;
  double target = 0.0;                                           ///< [N m] / [rad] / [rad/s], or [N] / [m] / [m/s]
  double kp = std::numeric_limits<double>::quiet_NaN();          ///< stiffness [N m/rad] or [N/m]
  double kd = std::numeric_limits<double>::quiet_NaN();          ///< damping [N m s/rad] or [N s/m]
  double max_effort = std::numeric_limits<double>::infinity();   ///< besides the URDF's effort limit
};

/** @brief A wrench on a link during [from, until). */
struct ExternalWrench
{
  std::string link;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< in the link frame [m]
  bool world_frame = true;                           ///< axes of force and torque: world, else the link's
  double from = 0.0;                                 ///< [s]
  double until = std::numeric_limits<double>::infinity();
};

struct JointInit
{
  double position = 0.0;
  double velocity = 0.0;
};

struct BodySpec
{
  std::string name;
  std::string urdf_path;  ///< file, or empty when urdf_xml is given
  std::string urdf_xml;   ///< the document itself (robot_description)
  BaseType base = BaseType::AUTO;
  std::optional<Eigen::Isometry3d> pose;  ///< of the root link; unset: the lowest collision point 1 mm above the ground
  Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   ///< of the root link origin, world axes [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< world axes [rad/s]
  std::map<std::string, JointInit> joints;
  std::map<std::string, JointCommand> commands;
  bool hold_initial_position = false;  ///< every actuated joint without a command gets a position servo at its start
  std::vector<ExternalWrench> wrenches;
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> motion;  ///< fixed base: linear, angular velocity
  std::string material = "default";
  std::vector<std::pair<std::string, std::string>> disable_collisions;  ///< pairs of links
};

struct GroundSpec
{
  double height = 0.0;           ///< [m]
  std::optional<double> friction;  ///< material `ground`; unset: the table decides
};

enum class ContactLawForm
{
  GAP,      ///< DESIGN.md: u_N >= -max(gap, 0)/dt and its companions
  VELOCITY  ///< the thesis's plain law: u_N >= 0 where gap <= 0 (Cadoux 2009, ch. 2.2)
};

struct Scenario
{
  std::string name = "scenario";
  double time_step = 0.001;                            ///< [s] > 0
  double duration = 2.0;                               ///< [s]
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};            ///< [m/s^2]
  std::string solver = "portfolio";
  StoppingOptions stopping;
  MaterialTable materials;
  std::optional<GroundSpec> ground;
  std::vector<BodySpec> bodies;
  ContactLawForm contact_law = ContactLawForm::GAP;
};

}  // namespace frictional_contact_sim
