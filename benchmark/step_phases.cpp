// Times of the phases of one step for the standing quadruped with four contacts, and of whole steps.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/world.h"
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
  Stage() : world(fcs::loadWorld(quadruped())), assembly(world.robots, world.collision, world.pairs)
  {
    world.robots[0].q = standing().position(0);
    world.robots[0].v = standing().velocity(0);
    fcs::Robot& robot = world.robots[0];
    robot.q_middle = robot.q;
    fcs::forwardKinematics(robot.model, robot.q_middle, robot.middle);
    fcs::computeMassMatrix(robot.model, robot.middle);
    world.collision.setPoses(0, robot.middle);
    guess = standing().solution();
    for (size_t j = 0; j < robot.actuators.size(); ++j)
      if (robot.isActuated(static_cast<int>(j)))
        robot.actuators[j].impulse =
            fcs::servoImpulse(robot.actuators[j].command, robot.q[robot.model.joints[j].q_index],
                              robot.v[robot.model.joints[j].v_index], settings.dt);
  }
  fcs::World world;
  fcs::StepAssembly assembly;
  fcs::StepSettings settings;
  fcs::Solution guess;
};

void kinematicsAndMassMatrix(benchmark::State& state)
{
  Stage stage;
  fcs::Robot& robot = stage.world.robots[0];
  for (auto _ : state)
  {
    fcs::forwardKinematics(robot.model, robot.q, robot.middle);
    fcs::forwardVelocities(robot.model, robot.v, robot.middle);
    fcs::computeMassMatrix(robot.model, robot.middle);
    benchmark::DoNotOptimize(robot.middle.mass_matrix.data());
  }
}

void collision(benchmark::State& state)
{
  Stage stage;
  for (auto _ : state)
  {
    stage.world.collision.setPoses(0, stage.world.robots[0].middle);
    benchmark::DoNotOptimize(stage.world.collision.detect(1e-3).data());
  }
  state.counters["contacts"] = static_cast<double>(stage.world.collision.detect(1e-3).size());
}

void assembly(benchmark::State& state)
{
  Stage stage;
  const std::vector<fcs::ContactPoint> points = stage.world.collision.detect(1e-3);
  for (auto _ : state)
  {
    stage.assembly.assembleRows(points, stage.settings);
    stage.assembly.assembleDynamics(stage.guess, stage.settings);
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
