#pragma once
/**
 * @file robot.h
 * @brief A robot in a simulation: its model, its state, and what acts on it.
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

/** @brief The drive of one joint and what it did in the last step. */
struct Actuator
{
  JointCommand command;  ///< gains set
  double effort_limit = 0.0;  ///< the smaller of the URDF's and the command's [N m] or [N], may be infinite
  ServoImpulse impulse;  ///< of this step
  double effort = 0.0;  ///< mean over the last step, after saturation [N m] or [N]
  bool bounded = false;  ///< solved as a bounded row in this step
};

struct Robot
{
  explicit Robot(MultibodyModel multibody_model);

  std::string name;
  MultibodyModel model;  ///< joints[0].placement moves along a prescribed base motion, nothing else changes
  MultibodyData middle;  ///< at the midpoint of the step
  MultibodyData end;  ///< at the end of the step
  Eigen::VectorXd q;  ///< nq
  Eigen::VectorXd v;  ///< nv
  Eigen::VectorXd q_middle;  ///< nq
  Eigen::VectorXd v_middle;  ///< nv, mean of old and new velocity once the step is solved
  Eigen::VectorXd external;  ///< nv, generalized force of external wrenches at the midpoint
  Eigen::VectorXd bias;  ///< nv, at the midpoint
  Eigen::VectorXd implicit;  ///< nv, servo stiffness and damping on the diagonal of M
  Eigen::VectorXd damping;  ///< nv, viscous joint damping, constant [N m s/rad]
  std::vector<Actuator> actuators;  ///< one a joint; used for joints with one coordinate
  std::vector<double> servo_inertia;  ///< joints: what a servo moves, at the initial position
  std::vector<std::vector<int>> chains;  ///< bodies: velocity coordinates that move it, ascending
  std::vector<double> extents;  ///< bodies: farthest shape point from the body origin [m]
  std::vector<ExternalWrench> wrenches;
  std::vector<int> wrench_frames;  ///< link of each wrench
  BaseMotion base_motion;
  Eigen::Isometry3d base_pose = Eigen::Isometry3d::Identity();  ///< of a fixed base at the start of the step
  int v_offset = 0;  ///< of its velocities in the problem

  /** @brief True for joints with exactly one coordinate that do not mimic another: those take commands. */
  bool isActuated(int joint) const;
  /** @brief Index in v of a joint with one coordinate. */
  int velocityIndex(int joint) const { return model.joints[joint].v_index; }
};

/** @brief Puts the base of `robot` on its prescribed path, `dt` after base_pose. No effect without a base motion. */
void placeBase(Robot& robot, double dt);

/** @brief Inertia that a servo of `joint` has to move: its own composite one, plus, on a floating base, the rest of
 *  the robot at the distance of the joint's reach (it is the rest that moves when the limb stands on the ground).
 *  Needs mass matrix and poses in `data`. [kg m^2] or [kg] */
double servoInertia(const Robot& robot, const MultibodyData& data, int joint);

}  // namespace frictional_contact_sim
