#pragma once
// What a simulator is made of, and the parts of a step; see simulator.h.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/dynamics/contact_set.h"
#include "frictional_contact_sim/math/union_find.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state.h"
#include "frictional_contact_sim/simulation/world_model.h"
#include "step_solver.h"

namespace frictional_contact_sim
{
/** What a step is told by a scenario. */
StepContext makeContext(const Scenario& scenario);

struct Simulator::Impl
{
  explicit Impl(std::shared_ptr<const WorldModel> world_model);
  /// Without an impact solve: what is to be taken over follows.
  Impl(std::shared_ptr<const WorldModel> world_model, std::shared_ptr<StepSolver> step_solver);
  void takeOver(const Impl& old, const std::vector<int>& new_body);
  void bookArrival(int body, double sign, const Impl& of);
  bool checkPlace(int body);

  // the step, in this order
  void moveToMidpoint();
  void solveStep();
  void judgeEquilibrium();  ///< statics of rigid bodies: rest, or the proof that there is none
  void advance();
  void finishStep();

  void beginRows();
  bool mayRecoverLess() const;
  bool dropRestitution();
  std::vector<const ContactPoint*> unmetPushes() const;
  bool pushesOut() const;
  bool pushesOut(const ContactPoint& point) const;
  void askLess();
  void setUnsatisfied();
  void fail(SolverStatus status, const std::string& message);
  bool acceptable() const;  ///< whether ACCEPT may take the answer
  void take();  ///< the answer becomes the state
  void hold();  ///< in place of take()
  void standStill();  ///< the answer of a step that is held
  void rememberGood();
  void storeOutcome();
  void certifyStep();
  void certify(CertifyOptions options, StepCertificate& result) const;
  void foresee(CertifyOptions options, StepCertificate& result) const;
  std::string sideName(int shape) const;
  NamedRow nameRow(const RowOrigin& origin, const ContactPoint* point) const;
  std::vector<NamedRow> nameRows(const std::vector<int>& laws, const std::vector<int>& bilaterals) const;
  void storeReport();
  void dumpProblem(const std::string& when);  ///< problem of a failed solve; its name goes into the outcome
  int countIslands();

  void applyState();
  void weld(const Closure& weld);
  void joinWelded();  ///< tells the collision world which shapes are one rigid thing, after the list of welds changed
  void goBack(const SimulationState& before);
  void setStart();
  void impactSolve();
  void solveImpact();
  void finishImpact();  ///< its answer, or what the failure policy says
  void restartReport();
  void restartLedger();
  void moveLedgerZero(double potential);  ///< after bookEnergies. @param potential what the ledger had so far [J]
  void setMaterials(const MaterialTable& materials);
  PairTable pairsOf(const MaterialTable& materials) const;
  void checkSettings(const RunSettings& settings) const;
  StoppingOptions changedStopping(const RunSettings& settings) const;
  MaterialTable changedMaterials(const RunSettings& settings) const;
  void bookEnergies();
  void updateEnds();

  std::shared_ptr<const WorldModel> world;
  Scenario scenario;
  RunSettings changed;  ///< without the friction of pairs, which is scenario.materials.rules
  PairTable pairs;  ///< the world's until materials are set
  CollisionWorld collision;
  SimulationState state;
  SimulationState start;  ///< what a reset goes back to
  StepOutcome start_outcome;
  std::vector<Body> bodies;
  StepContext context;
  ContactSet contact_set;
  StepAssembly assembly;
  std::shared_ptr<StepSolver> solver_owner;  ///< when bodies come and go, both worlds for a moment
  StepSolver& solver;
  std::string dump_folder;
  int dumps_left = 0;
  std::string dump_name;  ///< folder and name that no other simulator of this process uses

  /// q and v of the bodies as the simulator left them: what a bad state from outside goes back to
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> good;
  Solution guess;
  SolverResult result;
  int failed_pushes = 0;  ///< solves of this step without an answer that pushed overlaps out
  bool is_solved = false;  ///< assembly.problem() and result belong together
  StepOutcome outcome;
  StepSummary report;
  MarginTrend trend;
  UnionFind island_of;
};

}  // namespace frictional_contact_sim
