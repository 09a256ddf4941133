#pragma once
// What a simulator is made of, and the parts of a step; see simulator.h.
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/math/union_find.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state.h"
#include "frictional_contact_sim/simulation/world_model.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct Simulator::Impl
{
  explicit Impl(std::shared_ptr<const WorldModel> world_model);

  // the step, in this order
  void moveToMidpoint();
  double lookAhead() const;
  void solveStep();
  void advance();
  void finishStep();

  /** Finite, and slower than anything that moves. */
  static bool isMotion(const Solution& solution);
  void solve();
  void fail(SolverStatus status, const std::string& message);
  bool handleFailure();  ///< true when the state stands still
  void storeOutcome();
  void storeReport();
  void dumpProblem(const std::string& when);  ///< problem of a failed solve; its name goes into the outcome
  int countIslands();

  void applyState();
  void setStart();
  void impactSolve();
  void solveImpact();
  void restartReport();
  void restartLedger();
  void bookEnergies();
  void updateEnds();

  std::shared_ptr<const WorldModel> world;
  Scenario scenario;
  CollisionWorld collision;
  SimulationState state;
  SimulationState start;  ///< what a reset goes back to
  StepOutcome start_outcome;
  std::vector<Body> bodies;
  StepContext context;
  StepAssembly assembly;
  std::unique_ptr<Solver> solver;
  FailurePolicy policy = FailurePolicy::ACCEPT;
  std::string dump_folder;
  int dumps_left = 0;
  std::string dump_name;  ///< folder and name that no other simulator of this process uses

  Solution guess;
  SolverResult result;
  StepOutcome outcome;
  StepSummary report;
  UnionFind island_of;
};

}  // namespace frictional_contact_sim
