#pragma once
/**
 * @file simulator.h
 * @brief The simulator without ROS: a scenario in, one step at a time out. Deterministic; one thread a simulator.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/model/multibody_model.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/simulation/run_settings.h"
#include "frictional_contact_sim/simulation/scenario.h"
#include "frictional_contact_sim/simulation/state.h"
#include "frictional_contact_sim/simulation/step_report.h"
#include "frictional_contact_sim/simulation/world_model.h"

namespace frictional_contact_sim
{
/** @brief A URDF link of a body by its index; body -1 is the world, whatever the name. */
struct LinkRef
{
  int body = -1;
  std::string link;
};

class Simulator
{
public:
  /**
   * @brief Loads all bodies and sets the initial state.
   * @throws ModelError, ScenarioError, std::invalid_argument with one line that names what is wrong
   */
  explicit Simulator(const Scenario& scenario);
  /** @brief Another simulation of a world that is loaded; the world may be simulated in many threads at once. */
  explicit Simulator(std::shared_ptr<const WorldModel> world);
  ~Simulator();

  /**
   * @brief One time step (docs/architecture.md), all or nothing: CONVERGED with residual and energy within their
   * bounds, or another status and a reason, and the failure policy says what is left (simulation/failure.h). Nothing is
   * thrown. No allocation after warm-up while contacts persist.
   */
  const StepOutcome& step();
  /** @brief The scenario's start again, commands and wrenches too; time and step count go on; the ledger starts anew.
   */
  const StepOutcome& reset();
  /** @brief From now on a reset goes back to the present state (with commands given before the first step, say). */
  void setStart();
  /** @brief From now on a reset gives this body the commands that it has now. */
  void setStartCommands(int body);
  /** @brief Time back to zero; the scenario's clock, which wrench windows see, is not touched. */
  void resetTime();
  /** @brief From now on. @throws std::invalid_argument unless finite and > 0 */
  void setTimeStep(double dt);
  /** @brief From the next step on; the ledger's zero moves with the potential energy, so that it stays balanced.
   *  @param gravity [m/s^2] @throws std::invalid_argument unless finite */
  void setGravity(const Eigen::Vector3d& gravity);
  /** @brief Tolerance and budgets of every solve, from the next step on. @throws std::invalid_argument naming the field
   */
  void setStopping(const StoppingOptions& stopping);
  /**
   * @brief Friction of all pairs of two groups of surfaces, from the next step on; the last word on a pair is what
   * counts. Like all settings no part of the state: a reset keeps it. A state file has it beside the state.
   * @param a, b a material, a body, body/link, or "ground"
   * @param friction [-] >= 0
   * @param restitution [-] in [0, 1], none: as it is
   * @throws std::invalid_argument naming what is unknown or out of range, or a pair with the creep law
   */
  void setFriction(const std::string& a, const std::string& b, double friction,
                   std::optional<double> restitution = std::nullopt);
  /** @brief Of every material without its own entry. @throws std::invalid_argument as setFriction */
  void setDefaultFriction(double friction);

  const SimulationState& state() const;
  /** @brief Goes on from a state of this world, to the bit. Where its dt is another one, this simulator's stays, or
   * that of the settings.
   *  @param settings taken over before; what is not set there stays as it is here
   *  @throws StateError when its sizes are not this world's or a number is not finite, and std::invalid_argument as the
   *  settings; nothing has changed then */
  const StepOutcome& setState(const SimulationState& state, const RunSettings& settings = {});
  /** @brief What was set since the simulator was made, by setTimeStep to setDefaultFriction and setSolver. */
  RunSettings settings() const;
  /** @brief Of the last step, reset, load or set; at the start that of its impact solve. */
  const StepOutcome& outcome() const;

  const StepSummary& report() const;
  const std::vector<ContactState>& contacts() const;  ///< of the last step, ordered by shapes and feature
  const ShapeInfo& shape(int handle) const;
  int shapeCount() const;
  double time() const;
  const Scenario& scenario() const;
  const std::vector<std::string>& warnings() const;  ///< from loading, one line each; after a spawn the new body's
  double loadingSeconds() const;

  int bodyCount() const;  ///< in the order of the scenario
  const std::string& bodyName(int body) const;
  int findBody(const std::string& name) const;  ///< -1 where there is none
  const MultibodyModel& model(int body) const;
  const MultibodyData& data(int body) const;  ///< poses and velocities at the end of the step
  const Body& workspace(int body) const;  ///< of the last step: its midpoint, the velocity it started from
  Eigen::VectorXd& position(int body);  ///< nq; call stateChanged() after writing
  const Eigen::VectorXd& position(int body) const;
  const Eigen::VectorXd& velocity(int body) const;  ///< nv
  Eigen::VectorXd& velocity(int body);
  /** @brief Effort of a joint's drive over the last step, after saturation [N m] or [N]. */
  double effort(int body, int joint) const;
  /**
   * @brief After a position or velocity was written: impact solve at q, warm starts dropped, ledger anew; the report's
   * max_penetration is that at q.
   * Where that fails the failure policy says what is left: under STOP and PAUSE, and whenever a number is not finite,
   * the state goes back to the one before anything was written.
   */
  const StepOutcome& stateChanged();

  /**
   * @brief Command of one joint, from the next step on. Unset gains are filled from the joint's inertia.
   * @throws std::invalid_argument for a non-finite number or a mimic / fixed joint, naming it
   */
  void setCommand(int body, int joint, const JointCommand& command);
  const JointCommand& command(int body, int joint) const;
  /**
   * @brief From the next step on the joint follows `next` once `begin` has come, until then what it follows now;
   * continued() says how. A joint that is not under position control stays where it is until then.
   * @param servo gains and effort limit of the servo that follows
   * @param begin on the scenario's clock, as the times of `next` [s]
   * @throws std::invalid_argument as setCommand, and as JointTrajectory::validate
   */
  void followTrajectory(int body, int joint, const JointCommand& servo, double begin, const JointTrajectory& next);
  /** @brief A trajectory ends here: the joint's servo holds the position that is desired now. */
  void stopTrajectory(int body, int joint);
  /** @brief The trajectory given last, also after its end; empty when another command came. */
  const JointTrajectory& trajectory(int body, int joint) const;
  /** @brief What the joint's servo wants at present; where it does not hold a position the present motion. */
  JointMotion desiredMotion(int body, int joint) const;
  double scenarioTime() const;  ///< since the start or the last reset [s]
  /** @brief Adds a wrench; its times are on the scenario's clock. @throws std::invalid_argument naming an unknown link,
   * a number that is not finite, or a torque on an elastic body, whose nodes do not turn */
  void addWrench(int body, const ExternalWrench& wrench);
  /** @brief Puts the wrench in place of the last one that this set on its link, from now on until the next; zero only
   * ends that one. @throws std::invalid_argument as addWrench */
  void replaceWrench(int body, const ExternalWrench& wrench);
  void clearWrenches();
  /** @brief Of one body. @param frame of its model, -1 = all */
  void clearWrenches(int body, int frame = -1);

  /**
   * @brief Welds two links where they are: from now on they do not move against each other, nor collide. Their
   * velocities become one by an inelastic impact; the energy it takes is booked as impact. Where that has no answer
   * the failure policy says what is left, as after stateChanged().
   * @param a_in_b pose of link a in link b (or the world) that they shall have, at most 1 mm and 1 mrad from what they
   * have: closed at 0.1 m/s and 1 rad/s at most
   * @throws std::invalid_argument for an unknown link, a deformable body, two links that are joined already, two that
   * cannot move,
   * a pose that is too far away; nothing has changed then
   */
  const StepOutcome& attach(const LinkRef& a, const LinkRef& b,
                            const std::optional<Eigen::Isometry3d>& a_in_b = std::nullopt);
  /** @brief Ends a weld, in whatever order its links are named. @throws std::invalid_argument when they are not welded
   */
  const StepOutcome& detach(const LinkRef& a, const LinkRef& b);
  const std::vector<Closure>& welds() const;  ///< in the order they were made
  /** @brief Mean force and torque (about the origin of link a) on link a over the last step, world axes [N, N m]. */
  Vector6d weldWrench(int weld) const;
  /** @brief What closes kinematic loops: of the URDFs body by body, then of the scenario, then of spawned bodies. */
  const std::vector<Closure>& loops() const;
  const std::string& loopName(int loop) const;
  /** @brief As weldWrench, torque about the anchor. */
  Vector6d loopWrench(int loop) const;

  /**
   * @brief One body more, the last, at the pose and velocities of `spec`, which are also those a reset takes it to.
   * Clocks, the other bodies, their welds and warm starts go on to the bit. Where it touches something that it runs
   * into, the impact is solved; without an answer there outcome().taken says whether the body is there. What
   * references got from this simulator before is void.
   * @throws as the constructor, and std::invalid_argument for a name that is taken, or a place where it is inside
   * another body or the ground (deeper than a thousandth of the smaller shape): who adds a body to a world that moves
   * has to hear of it, he cannot look first. Nothing has changed then
   */
  const StepOutcome& spawn(const BodySpec& spec);
  /**
   * @brief Takes a body out, with its contacts and welds. The others go on; bodies behind it get the number before
   * theirs. @throws std::invalid_argument for an unknown name
   */
  void remove(const std::string& name);

  /** @throws std::invalid_argument listing the valid names */
  void setSolver(const std::string& name);
  /** @brief A method that the registry does not have. */
  void setSolver(std::unique_ptr<Solver> solver);
  /** @brief From the next step on, in place of the scenario's. */
  void setFailurePolicy(FailurePolicy policy);
  FailurePolicy failurePolicy() const;
  /** @brief Policy, fallback and time limit in place of the scenario's. */
  void setFailureOptions(const FailureOptions& options);
  /** @brief A solve ends when `stop` becomes true (a signal): STOPPED_BY_USER, the step is not taken. nullptr = never.
   *  It outlives the simulator. */
  void setStop(const std::atomic<bool>* stop);
  /** @brief The first `most` problems of failed steps are written here as FCLib files; empty = nowhere. */
  void setDumpFolder(const std::string& folder, int most = 20);
  /** @brief The problem of the last step and its answer (for FCLib files and tests). */
  const IncrementalProblem& problem() const;
  const Solution& solution() const;
  /** @brief False before the first solve, and after a state was set for which nothing was to be solved. */
  bool isProblemSolved() const;
  /** @brief The verdict on that problem. @throws std::invalid_argument when there is none, or an option is bad */
  StepCertificate certify(const CertifyOptions& options = {}) const;
  /** @brief Such a verdict in the report of every so many steps, and of each that has no answer; 0: never, and no cost.
   * A setting as the tolerance is one. @throws std::invalid_argument when negative */
  void setCertifyEvery(int steps);
  /** @brief hashOf(state()). */
  std::uint64_t stateHash() const;

private:
  void takeSettings(const RunSettings& settings);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace frictional_contact_sim
