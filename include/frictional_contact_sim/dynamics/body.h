#pragma once
/**
 * @file body.h
 * @brief A body of a scenario (a robot, a prop): what never changes, its state, and the workspace of a step.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/actuation.h"
#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
/** @brief Prescribed motion of a fixed base, world axes. */
struct BaseMotion
{
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< of the root link origin [m/s]
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< [rad/s]
  bool active = false;
};

/** @brief The constant part, shared by all simulations of it. */
struct BodyModel
{
  explicit BodyModel(MultibodyModel multibody_model);

  std::string name;  ///< in the scenario
  MultibodyModel tree;
  Eigen::VectorXd damping;  ///< nv, viscous joint damping [N m s/rad]
  std::vector<double> servo_inertia;  ///< joints: what a servo moves, at the initial position
  std::vector<std::vector<int>> chains;  ///< links: velocity coordinates that move it, ascending
  std::vector<double> extents;  ///< links: farthest shape point from the link origin [m]
  BaseMotion base_motion;

  /** @brief True for joints with exactly one coordinate that do not mimic another: those take commands. */
  bool isActuated(int joint) const;
  /** @brief Index in v of a joint with one coordinate. */
  int velocityIndex(int joint) const { return tree.joints[joint].v_index; }
};

/** @brief The drive of one joint: its command, and what it did in the last step. */
struct JointDrive
{
  JointCommand command;  ///< gains set
  double effort_limit = 0.0;  ///< the smaller of the URDF's and the command's [N m] or [N], may be infinite
  double effort = 0.0;  ///< mean over the last step, after saturation [N m] or [N]
};

/** @brief Everything about a body that decides its future. */
struct BodyState
{
  BodyState() = default;
  /** @brief At rest in the zero position, no command, no wrench. */
  explicit BodyState(const BodyModel& model);

  Eigen::VectorXd q;  ///< nq
  Eigen::VectorXd v;  ///< nv
  Eigen::Isometry3d base_pose = Eigen::Isometry3d::Identity();  ///< of a fixed base
  std::vector<JointDrive> drives;  ///< one a joint; used for joints with one coordinate
  std::vector<ExternalWrench> wrenches;
};

/** @brief A body in a simulation. */
struct Body
{
  /** @param body_state lives as long as the body; may be assigned, never moved */
  Body(const BodyModel& body_model, BodyState& body_state);

  const BodyModel& model;
  BodyState& state;
  MultibodyData middle;  ///< at the midpoint of the step
  MultibodyData end;  ///< at the end of the step
  Eigen::VectorXd q_middle;  ///< nq
  Eigen::VectorXd v_middle;  ///< nv, mean of old and new velocity once the step is solved
  Eigen::VectorXd external;  ///< nv, generalized force of external wrenches at the midpoint
  Eigen::VectorXd bias;  ///< nv, at the midpoint
  Eigen::VectorXd implicit;  ///< nv, servo stiffness and damping on the diagonal of M
  int v_offset = 0;  ///< of its velocities in the problem
};

/** @brief Where a fixed base is `dt` after base_pose on its prescribed path; base_pose itself without one. */
Eigen::Isometry3d basePose(const Body& body, double dt);

/** @brief Poses and velocities of `body.end` at (q, v). */
void updateEnd(Body& body);

/** @brief Midpoint q (+) dt/2 v, its poses and mass matrix in `body.middle`. */
void moveToMidpoint(Body& body, double dt);

/** @brief Generalized force of the wrenches that act at scenario time `now` [s]. Needs body.middle. */
void applyWrenches(Body& body, double now);

/** @brief Forgets the wrenches that have expired at scenario time `now` [s]: part of a step that is taken. */
void removeExpiredWrenches(Body& body, double now);

/** @brief Inertia that a servo of `joint` has to move: its own composite one, plus, on a floating base, the rest of
 *  the body at the distance of the joint's reach (it is the rest that moves when the limb stands on the ground).
 *  Needs mass matrix and poses in `data`. [kg m^2] or [kg] */
double servoInertia(const BodyModel& model, const MultibodyData& data, int joint);

/** @brief Checks a command and fills its gains. @throws std::invalid_argument naming the joint and the number */
JointDrive makeDrive(const BodyModel& model, int joint, const JointCommand& command);

}  // namespace frictional_contact_sim
