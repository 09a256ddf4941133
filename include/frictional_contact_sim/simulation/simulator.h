#pragma once
/**
 * @file simulator.h
 * @brief The simulator without ROS: a scenario in, one step at a time out. Deterministic; one thread.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/model/multibody_data.h"
#include "frictional_contact_sim/model/multibody_model.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/simulation/scenario.h"
#include "frictional_contact_sim/simulation/step_report.h"

namespace frictional_contact_sim
{
/** @brief What to do when a step's solve has not converged. */
enum class FailurePolicy
{
  STOP,  ///< the caller ends the run
  PAUSE,  ///< the caller pauses
  HOLD,  ///< the state stays as it was before the step (velocities set to zero)
  ACCEPT  ///< take the best iterate and go on
};

class Simulator
{
public:
  /**
   * @brief Loads all robots and sets the initial state.
   * @throws ModelError, ScenarioError, std::invalid_argument with one line that names what is wrong
   */
  explicit Simulator(const Scenario& scenario);
  ~Simulator();

  /** @brief One time step (DESIGN.md, "The time step"). No allocation after warm-up while contacts persist. */
  const StepSummary& step();
  /** @brief Initial state again; time and step count go on; the energy ledger starts anew. */
  void reset();
  /** @brief Time back to zero. */
  void resetTime();

  const StepSummary& report() const;
  const std::vector<ContactState>& contacts() const;  ///< of the last step, ordered by shapes and feature
  const ShapeInfo& shape(int handle) const;
  double time() const;
  const Scenario& scenario() const;
  const std::vector<std::string>& warnings() const;  ///< from loading, one line each
  double loadingSeconds() const;

  int bodyCount() const;  ///< robots, in the order of the scenario
  const std::string& bodyName(int body) const;
  const MultibodyModel& model(int body) const;
  const MultibodyData& data(int body) const;  ///< poses and velocities at the end of the step
  Eigen::VectorXd& position(int body);  ///< nq; call stateChanged() after writing
  const Eigen::VectorXd& position(int body) const;
  const Eigen::VectorXd& velocity(int body) const;  ///< nv
  Eigen::VectorXd& velocity(int body);
  /** @brief Effort of a joint's drive over the last step, after saturation [N m] or [N]. */
  double effort(int body, int joint) const;
  /** @brief After a state was written by hand: impact solve at q (DESIGN.md), warm starts dropped. */
  void stateChanged();

  /**
   * @brief Command of one joint, from the next step on. Unset gains are filled from the joint's inertia.
   * @throws std::invalid_argument for a non-finite number or a mimic / fixed joint, naming it
   */
  void setCommand(int body, int joint, const JointCommand& command);
  const JointCommand& command(int body, int joint) const;
  /** @brief Adds a wrench (times are simulation times). @throws std::invalid_argument naming an unknown link */
  void addWrench(int body, const ExternalWrench& wrench);
  void clearWrenches();

  /** @throws std::invalid_argument listing the valid names */
  void setSolver(const std::string& name);
  void setFailurePolicy(FailurePolicy policy);
  /** @brief Problems of failed steps are written here as FCLib files; empty = nowhere. */
  void setDumpFolder(const std::string& folder);
  /** @brief The problem of the last step and its answer (for FCLib files and tests). */
  const IncrementalProblem& problem() const;
  const Solution& solution() const;
  /** @brief FNV-1a over every field of state, contacts and report that is not wall-clock time. */
  std::uint64_t stateHash() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace frictional_contact_sim
