// Times of the phases of one step for the standing quadruped with four contacts, and of whole steps.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/dynamics/row_sources.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/world_model.h"
#include "frictional_contact_sim/solver/registry.h"

namespace fcs = frictional_contact_sim;

namespace
{
constexpr double SETTLING_TIME = 1.0;  ///< [s] of simulated time before anything is measured

fcs::Scenario quadruped()
{
  return fcs::loadScenarioFile(PROJECT_DIR "/config/scenarios/quadruped.yaml");
}

fcs::Simulator& standing()
{
  static std::unique_ptr<fcs::Simulator> simulator;
  if (!simulator)
  {
    simulator = std::make_unique<fcs::Simulator>(quadruped());
    while (simulator->time() < SETTLING_TIME)
      simulator->step();
  }
  return *simulator;
}

/** The robot of the standing simulation with everything that a phase needs, outside of it. */
struct Stage
{
  Stage()
    : world(fcs::loadWorldModel(quadruped()))
    , state(standing().state())
    , collision(world->collision)
    , bodies(1, fcs::Body(world->bodies[0], state.bodies[0]))
    , assembly(bodies, fcs::makeRowSources(bodies, collision, world->pairs, state.rows), state.rows)
  {
    fcs::moveToMidpoint(bodies[0], context.dt);
    collision.setPoses(0, bodies[0].middle);
    guess = standing().solution();
  }
  std::shared_ptr<const fcs::WorldModel> world;
  fcs::SimulationState state;
  fcs::CollisionWorld collision;
  std::vector<fcs::Body> bodies;
  fcs::StepAssembly assembly;
  fcs::StepContext context;
  fcs::Solution guess;
};

void kinematicsAndMassMatrix(benchmark::State& state)
{
  Stage stage;
  fcs::Body& body = stage.bodies[0];
  for (auto _ : state)
  {
    fcs::forwardKinematics(body.model.tree, body.state.q, body.middle);
    fcs::forwardVelocities(body.model.tree, body.state.v, body.middle);
    fcs::computeMassMatrix(body.model.tree, body.middle);
    benchmark::DoNotOptimize(body.middle.mass_matrix.data());
  }
}

void collision(benchmark::State& state)
{
  Stage stage;
  for (auto _ : state)
  {
    stage.collision.setPoses(0, stage.bodies[0].middle);
    benchmark::DoNotOptimize(stage.collision.detect(1e-3).data());
  }
  state.counters["contacts"] = static_cast<double>(stage.collision.detect(1e-3).size());
}

void assembly(benchmark::State& state)
{
  Stage stage;
  const std::vector<fcs::ContactPoint> points = stage.collision.detect(1e-3);
  for (auto _ : state)
  {
    stage.context.points = &points;
    stage.assembly.begin(stage.context);
    stage.assembly.assembleForces(stage.context);
    stage.assembly.assembleRows(stage.context);
    stage.assembly.assembleProblem(stage.context);
    benchmark::DoNotOptimize(stage.assembly.problem().f.data());
  }
}

void solve(benchmark::State& state, bool warm, const std::string& name)
{
  const fcs::IncrementalProblem problem = standing().problem();
  const fcs::Solution guess = standing().solution();
  const std::unique_ptr<fcs::Solver> solver = fcs::createSolver(name);
  fcs::SolverResult result;
  for (auto _ : state)
    solver->solve(problem, warm ? &guess : nullptr, result);
  state.counters["residual"] = result.residual;
  state.counters["iterations"] = result.iterations;
}

void wholeStep(benchmark::State& state)
{
  fcs::Simulator& simulator = standing();
  for (auto _ : state)
    benchmark::DoNotOptimize(simulator.step().residual);
  state.counters["steps_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

BENCHMARK(kinematicsAndMassMatrix);
BENCHMARK(collision);
BENCHMARK(assembly);
BENCHMARK_CAPTURE(solve, warm_portfolio, true, "portfolio");
BENCHMARK_CAPTURE(solve, cold_portfolio, false, "portfolio");
BENCHMARK_CAPTURE(solve, cold_gauss_seidel, false, "gauss_seidel");
BENCHMARK(wholeStep);
}  // namespace

BENCHMARK_MAIN();
