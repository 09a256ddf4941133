#pragma once
// The simulator's state and the parts of a step; see simulator.h.
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/world.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct Simulator::Impl
{
  explicit Impl(const Scenario& description);

  // the step, in this order
  void moveToMidpoint();
  double lookAhead() const;
  void prepareActuators();
  void guessCreep(const std::vector<ContactPoint>& points);
  void solveStep(const std::vector<ContactPoint>& points);
  void advance();
  void finishStep(const std::vector<ContactPoint>& points);

  /** Last contact of the same id, or nullptr where there was none or it was an impact. */
  const ContactState* lastContact(std::uint64_t id) const;
  void makeGuess(const std::vector<ContactPoint>& points);
  bool boundOverloadedServos();
  /** Finite, and slower than anything that moves. */
  static bool isMotion(const Solution& solution);
  void solve();
  bool handleFailure();  ///< true when the state stands still
  void storeContacts(const std::vector<ContactPoint>& points);
  void storeJointImpulses();
  void storeReport();
  void dumpProblem();
  int countIslands();

  void applyState();
  void impactSolve();
  void restartLedger();

  Scenario scenario;
  World world;
  StepSettings settings;
  StepAssembly assembly;
  std::unique_ptr<Solver> solver;
  FailurePolicy policy = FailurePolicy::ACCEPT;
  std::string dump_folder;
  double loading_seconds = 0.0;
  double time = 0.0;

  std::vector<Eigen::VectorXd> q_initial;
  std::vector<Eigen::VectorXd> v_initial;
  std::vector<Eigen::Isometry3d> base_initial;

  Solution guess;
  SolverResult result;
  bool step_failed = false;
  StepSummary report;
  double energy_start = 0.0;
  std::vector<ContactState> contacts;
  std::vector<std::pair<std::uint64_t, int>> contact_index;  ///< id to position in contacts, sorted
  std::vector<std::vector<std::array<double, 4>>> joint_impulses;  ///< robot, joint, JointRow::Kind
  std::vector<int> island_of;
};

}  // namespace frictional_contact_sim
