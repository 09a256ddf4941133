#pragma once
/**
 * @file body.h
 * @brief A body of a scenario (a robot, a prop): what never changes, its state, and the workspace of a step.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/actuation.h"
#include "frictional_contact_sim/dynamics/base_motion.h"
#include "frictional_contact_sim/dynamics/command_schedule.h"
#include "frictional_contact_sim/dynamics/dynamic_body.h"
#include "frictional_contact_sim/dynamics/joint_trajectory.h"
#include "frictional_contact_sim/dynamics/regime.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
/** @brief A spring at a joint with one coordinate: effort stiffness (rest - q), beside any command. */
struct JointSpring
{
  int joint = -1;
  double stiffness = 0.0;  ///< [N m/rad] or [N/m], >= 0
  double rest = 0.0;  ///< [rad] or [m]
};

/** @brief The constant part, shared by all simulations of it. */
struct BodyModel
{
  /** @param mechanics of a body that is no tree: `multibody_model` then has its links and shapes, and no joint */
  explicit BodyModel(MultibodyModel multibody_model, std::shared_ptr<const DynamicBody> mechanics = nullptr);

  std::string name;  ///< in the scenario
  MultibodyModel tree;
  std::shared_ptr<const DynamicBody> solid;  ///< nullptr: a tree of rigid links
  int nq;
  int nv;  ///< of the tree, or of the solid
  Regime regime = Regime::DYNAMIC;
  Eigen::VectorXd damping;  ///< nv, viscous joint damping [N m s/rad]
  std::vector<double> servo_inertia;  ///< joints: what a servo moves, at the initial position
  std::vector<std::vector<int>> chains;  ///< links: velocity coordinates that move it, ascending
  std::vector<double> extents;  ///< links: farthest shape point from the link origin [m]
  /// Links: extents, or without shapes the distance of the centre of mass plus its radius of gyration [m].
  std::vector<double> sizes;
  /// nv: farthest that a point of the moved links can be from the joint [m], from sizes, placements and the limits of
  /// sliding joints (those without limits count as zero); 1 for coordinates along which the links slide.
  Eigen::VectorXd reach;
  bool free_link;  ///< one floating link: stepped about its centre of mass, see free_link.h
  bool isotropic;  ///< the root link's principal moments are equal
  BaseMotion base_motion;
  std::vector<SurfaceMotion> surfaces;  ///< of links whose surface moves
  std::vector<JointSpring> springs;
  std::vector<CommandSchedule> schedules;  ///< joints: commands over time, empty where there is none
  bool gravity_compensation = false;  ///< servos also carry what hangs on their joints (servo_rows.h)

  /** @brief Only in motion is a single link stepped about its centre of mass. */
  void setRegime(Regime steps)
  {
    regime = steps;
    free_link = free_link && steps == Regime::DYNAMIC;
  }
  /** @brief What meshes add to extents, sizes and reach: CollisionWorld::meshReach. Until then they count as nothing.
   */
  void setMeshReach(const std::vector<double>& mesh_reach);
  /** @brief True for joints with exactly one coordinate that do not mimic another: those take commands. */
  bool isActuated(int joint) const;
  /** @brief No coordinate and no prescribed motion moves the link. Those of a deformable body have no chains, and move,
   * but for the root where there are supports. */
  bool isFixed(int link) const
  {
    return chains[link].empty() && !base_motion.active && (!solid || (link == 0 && solid->isSupported()));
  }
  /** @brief Index in v of a joint with one coordinate. */
  int velocityIndex(int joint) const { return tree.joints[joint].v_index; }
};

/** @brief The drive of one joint: its command, and what it did in the last step. */
struct JointDrive
{
  JointCommand command;  ///< gains set; follows a schedule or trajectory: with the target of the last step
  bool is_scheduled = false;  ///< the target is that of BodyModel::schedules, until another command is given
  JointTrajectory trajectory;  ///< of a POSITION command: its target, until another command is given; empty = none
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
  Eigen::VectorXd v_start;  ///< nv, at the start of the step in the problem's columns; a free link's is an image
  Eigen::VectorXd v_free;  ///< nv, at the end of the step without any row, in the problem's columns
  Eigen::VectorXd v_middle;  ///< nv, mean of v_start and the new velocity once the step is solved
  Eigen::VectorXd external;  ///< nv, generalized force of external wrenches at the midpoint
  Eigen::VectorXd bias;  ///< nv, at the midpoint, what f was assembled with
  Eigen::VectorXd next_bias;  ///< nv, at the mean velocity of an answer
  Eigen::VectorXd change;  ///< nv, scratch: change of velocity
  Eigen::VectorXd implicit;  ///< nv, servo stiffness and damping on the diagonal of M
  double speed = 0.0;  ///< largest speed of a point of its links at v_start and v_free [m/s]
  double speed_change = 0.0;  ///< largest change of such a speed by one step's smooth forces, at least 1e-12 [m/s]
  int v_offset = 0;  ///< of its velocities in the problem
  BaseVelocity base;  ///< of a moving base: over the step, from its midpoint to the next one; at the end mean about it
  Eigen::Matrix3d base_turn;  ///< of a moving base: with the arm from its origin what base.angular adds to a point
  std::vector<Eigen::Matrix3d> surface_turns;  ///< BodyModel::surfaces: the same, axes of the link
  BaseVelocity base_rate;  ///< its change [m/s^2], [rad/s^2], mean over the step
  std::unique_ptr<BodyWork> work;  ///< of a solid
  double base_time = 0.0;  ///< of the state, on the scenario's clock [s]
};

/** @brief The state is at `time` of the scenario's clock: velocities of a moving base for the step that begins there,
 * or (where no step has begun) for that instant. */
void setBaseTime(Body& body, double time, double dt, bool in_step);

/** @brief Where a fixed base is `dt` after base_pose on its prescribed path; base_pose itself without one. */
Eigen::Isometry3d basePose(const Body& body, double dt);

/** @brief What the body's springs have stored [J]. */
double springEnergy(const Body& body);

/** @brief Poses and velocities of `body.end` at (q, v). */
void updateEnd(Body& body);

/** @brief q_middle = q (+) dt/2 v of any state of the body. */
void moveHalfStep(const Body& body, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double dt,
                  Eigen::VectorXd& q_middle);

/** @brief Where the answer `v` (nv) of a step ends: q_end, v_end may be the state's own. */
void moveStep(const Body& body, const VectorIn& v, double dt, Eigen::VectorXd& q_end, Eigen::VectorXd& v_end);

/** @brief Midpoint q (+) dt/2 v, its poses and mass matrix in `body.middle`. */
void moveToMidpoint(Body& body, double dt);

/** @brief v_start from the state. In an impact (no motion) the state's own velocity. Needs the midpoint. */
void setStartVelocity(Body& body, bool impact);

/** @brief State, base and `body.end` at the end of the step. @param v nv, the answer */
void moveToEnd(Body& body, const VectorIn& v, double dt);

/** @brief Poses of `data` at q, its base_pose set. */
void setPoses(const BodyModel& model, const Eigen::VectorXd& q, MultibodyData& data);
/** @brief Of these the links' alone, for who looks ahead and asks for no mass matrix. */
void setLinkPoses(const BodyModel& model, const Eigen::VectorXd& q, MultibodyData& data);

/** @brief Poses and mass matrix of `body.middle` at the state itself, for an impact. */
void moveToImpact(Body& body);

/** @brief Factor of the mass matrix of the step, Body::implicit on its diagonal. @return false where not positive
 * definite */
bool factorizeMass(Body& body);
/** @brief v <- M^-1 v, after factorizeMass. */
void solveMass(const Body& body, Eigen::VectorXd& v);

/** @brief sign times the columns of a point's velocity, without the body's offset; appends to `columns`. */
void addPointColumns(const Body& body, const BodyPoint& point, double sign, PointColumns& columns);

/** @brief [J], of `body.end`. Solids: in the frame of their base. */
double kineticEnergy(const Body& body);
double potentialEnergy(const Body& body, const Eigen::Vector3d& gravity);  ///< springs too [J]

/** @brief Bias forces (nv) at mean velocity `v` of the step, in the problem's columns. Writes middle.link_velocity. */
void computeBias(Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity, Eigen::VectorXd& bias);

/** @brief Largest speed of a point of the links, bound by sizes [m/s]. Writes middle.link_velocity. */
double pointSpeed(Body& body, const Eigen::VectorXd& v);

/** @brief Body::speed and speed_change from v_start and v_free, after computeBias at v_start. Uses its scratch. */
void setSpeeds(Body& body);

/** @brief Generalized force of the wrenches that act at scenario time `now` [s]. Needs body.middle. */
void applyWrenches(Body& body, double now);

/** @brief Why a wrench cannot act: a number that is not finite, or what the body does not take; empty where it can. */
std::string wrenchRefusal(const BodyModel& model, const ExternalWrench& wrench);

/** @brief Forgets the wrenches that have expired at scenario time `now` [s]: part of a step that is taken. */
void removeExpiredWrenches(Body& body, double now);

/** @brief Inertia that a servo of `joint` has to move: its own composite one, plus, on a floating base, the rest of
 *  the body at the distance of the joint's reach (it is the rest that moves when the limb stands on the ground).
 *  Needs mass matrix and poses in `data`. [kg m^2] or [kg] */
double servoInertia(const BodyModel& model, const MultibodyData& data, int joint);

/** @brief The drive's command in a step whose middle is at scenario time `middle` [s]: from its trajectory or schedule
 * if it follows one, within the joint's limits and MAX_TRAVEL, MAX_SPEED then. */
JointCommand commandAt(const Body& body, int joint, double middle);
/** @brief Takes a target of a servo into the joint's limits, at most MAX_TRAVEL from where it is, also if beyond them.
 * @param position of the joint [rad] or [m] */
double reachableTarget(const JointLimit& limit, double position, double target);
/** @brief Takes a velocity into the joint's limit and MAX_SPEED. */
double reachableSpeed(const JointLimit& limit, double speed);

/** @brief Checks a command and fills its gains. @throws std::invalid_argument naming the joint and the number */
JointDrive makeDrive(const BodyModel& model, int joint, const JointCommand& command);

}  // namespace frictional_contact_sim
