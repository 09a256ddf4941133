#pragma once
/**
 * @file scenario.h
 * @brief What is simulated, as data: the content of a scenario file (docs/interfaces.md) and the defaults
 * that the node's parameters share with it.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/collision/broad_phase_kind.h"
#include "frictional_contact_sim/dynamics/actuation.h"
#include "frictional_contact_sim/dynamics/base_motion.h"
#include "frictional_contact_sim/dynamics/command_schedule.h"
#include "frictional_contact_sim/dynamics/contact_law.h"
#include "frictional_contact_sim/dynamics/material.h"
#include "frictional_contact_sim/dynamics/regime.h"
#include "frictional_contact_sim/model/loop_joint.h"
#include "frictional_contact_sim/model/urdf_loader.h"
#include "frictional_contact_sim/simulation/failure.h"
#include "frictional_contact_sim/simulation/sensor.h"
#include "frictional_contact_sim/solver/solver.h"
#include "frictional_contact_sim/solver/solver_options.h"

namespace frictional_contact_sim
{
struct JointInit
{
  double position = 0.0;
  double velocity = 0.0;
};

struct SpringSpec
{
  double stiffness = 0.0;  ///< [N m/rad] or [N/m], >= 0
  double rest = 0.0;  ///< [rad] or [m]
  double damping = 0.0;  ///< besides the joint's own [N m s/rad] or [N s/m], >= 0
};

struct ElasticSpec;

struct BodySpec
{
  std::string name;
  std::shared_ptr<const ElasticSpec> elastic;  ///< an elastic body in place of a URDF: deformable/elastic_spec.h
  std::string urdf_path;  ///< file, or empty when urdf_xml is given
  std::string urdf_xml;  ///< the document itself (robot_description)
  BaseType base = BaseType::AUTO;
  std::optional<Eigen::Isometry3d> pose;  ///< of the root link; unset: the lowest collision point 1 mm above the ground
  Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();  ///< of the root link origin, world axes [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< world axes [rad/s]
  std::map<std::string, JointInit> joints;
  std::map<std::string, JointCommand> commands;
  std::map<std::string, CommandSchedule> schedules;  ///< of joints in `commands`: their targets over time
  bool hold_initial_position = false;  ///< every actuated joint without a command gets a position servo at its start
  bool gravity_compensation = false;  ///< position and velocity servos also carry the weight of what they move
  std::vector<ExternalWrench> wrenches;
  std::optional<BaseMotion> motion;  ///< of a fixed base
  std::map<std::string, SurfaceMotion> surface_velocity;  ///< by link; its frame is found when the body is loaded
  std::map<std::string, SpringSpec> springs;  ///< by joint
  std::string material = "default";
  std::map<std::string, std::string> link_materials;  ///< by link, where it is not `material`
  std::vector<SensorSpec> sensors;
  bool self_collision = true;  ///< false: no two of its links collide
  std::vector<std::pair<std::string, std::string>> disable_collisions;  ///< pairs of links
  std::optional<double> min_joint_inertia;  ///< see loadUrdf [kg m^2] or [kg] > 0
  std::string source;  ///< where it was read, "FILE:LINE: key 'bodies[0]'", for messages; may be empty
};

/** @brief Where one of two bodies has a loop's joint. */
struct LoopSide
{
  std::string body;  ///< empty: the world
  std::string link;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< in the link; its z axis is the joint's
};

/** @brief A joint beside the trees of the bodies. */
struct LoopSpec
{
  std::string name;
  LoopType type = LoopType::POINT;
  LoopSide a;
  LoopSide b;
  std::string source;  ///< as BodySpec::source
};

struct GroundSpec
{
  double height = 0.0;  ///< [m]
  std::optional<double> friction;  ///< material `ground`; unset: the table decides
};

struct Scenario
{
  std::string name = "scenario";
  double time_step = 0.001;  ///< [s] > 0
  double duration = 2.0;  ///< [s]
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< [m/s^2]
  std::string solver = "portfolio";
  SolverOptions solver_options;  ///< of that method, besides its defaults
  StoppingOptions stopping;
  MaterialTable materials;
  std::optional<GroundSpec> ground;
  std::vector<BodySpec> bodies;
  std::vector<LoopSpec> loops;
  Regime regime = Regime::DYNAMIC;
  FailureOptions failure;
  ContactLawForm contact_law = ContactLawForm::GAP;
  int certify_every = 0;  ///< steps between two verdicts on existence (step_certificate.h), 0: none
  double certify_bound = 0.0;  ///< R of their margin [m/s, rad/s]; 0: ten times what w asks for, at least 1
  BroadPhaseKind broad_phase = BroadPhaseKind::AUTO;  ///< changes the time of a step, nothing else
};

}  // namespace frictional_contact_sim
