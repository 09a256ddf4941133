// Steps of 6 x 6 x 6 balls that fall on the ground and spread there (SimBenchmark's "666": radius 0.1 m, 10 kg, pitch
// 0.21 m with up to 1 mm of noise, frictionless, inelastic, 1 ms), beside the quadruped's of the same run: all steps of
// the first two seconds, the share of the solves in them, and the same for other edge lengths.
//     benchmark_ball_pile [--benchmark_filter=...]
// `quadruped_steps` is the goal's number: step of the pile over step of the quadruped, processor time of one process.
#include <benchmark/benchmark.h>
#include <time.h>

#include <chrono>
#include <random>
#include <string>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace fcs = frictional_contact_sim;

namespace
{
constexpr double RADIUS = 0.1;  ///< [m]
constexpr double PITCH = 0.21;  ///< [m]
constexpr double NOISE = 1e-3;  ///< [m]
constexpr int STEPS = 2000;
constexpr int REPEATS = 3;  ///< the fastest counts: others use the machine too

const char* const BALL =
    "<robot name='ball'><link name='ball'><inertial><mass value='10'/>"
    "<inertia ixx='0.04' iyy='0.04' izz='0.04' ixy='0' ixz='0' iyz='0'/></inertial>"
    "<collision><geometry><sphere radius='0.1'/></geometry></collision></link></robot>";

fcs::Scenario pile(int edge, fcs::BroadPhaseKind kind)
{
  fcs::Scenario scenario;
  scenario.name = "pile";
  scenario.ground.emplace();
  scenario.materials.fallback.friction = 0.0;
  scenario.failure.policy = fcs::FailurePolicy::ACCEPT;
  scenario.broad_phase = kind;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-NOISE, NOISE);
  for (int k = 0; k < edge * edge * edge; ++k)
  {
    fcs::BodySpec body;
    body.name = "ball_" + std::to_string(k);
    body.urdf_xml = BALL;
    body.pose.emplace(Eigen::Isometry3d::Identity());
    const Eigen::Vector3d cell(k % edge, k / edge % edge, k / edge / edge);
    const double x = noise(random), y = noise(random), z = noise(random);
    body.pose->translation() = PITCH * cell + Eigen::Vector3d(x, y, z + RADIUS + 0.01);
    scenario.bodies.push_back(body);
  }
  return scenario;
}

double processorTime()
{
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Cost
{
  double step = 0.0;  ///< [s], mean
  double solve = 0.0;  ///< [s], mean, as the report says: wall clock
  double wall = 0.0;  ///< [s], mean
  double contacts = 0.0;
  int failed = 0;
};

Cost measure(const fcs::Scenario& scenario, int steps)
{
  fcs::Simulator simulator(scenario);
  Cost cost;
  const double start = processorTime();
  const auto wall = std::chrono::steady_clock::now();
  for (int k = 0; k < steps; ++k)
  {
    simulator.step();
    cost.solve += simulator.report().solve_time / steps;
    cost.contacts += static_cast<double>(simulator.report().contacts) / steps;
    cost.failed += simulator.outcome().converged() ? 0 : 1;
  }
  cost.step = (processorTime() - start) / steps;
  cost.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count() / steps;
  return cost;
}

void keepFastest(const Cost& cost, Cost& fastest)
{
  if (fastest.step == 0.0 || cost.step < fastest.step)
    fastest = cost;
}

void ballPile(benchmark::State& state, fcs::BroadPhaseKind kind)
{
  const int edge = static_cast<int>(state.range(0));
  Cost cost;
  Cost quadruped;
  for (auto _ : state)
  {
    for (int k = 0; k < REPEATS; ++k)
    {
      keepFastest(measure(fcs::loadScenarioFile(PROJECT_DIR "/config/scenarios/quadruped.yaml"), STEPS), quadruped);
      keepFastest(measure(pile(edge, kind), STEPS), cost);
    }
    state.SetIterationTime(cost.step);
  }
  state.counters["balls"] = edge * edge * edge;
  state.counters["contacts"] = cost.contacts;
  state.counters["failed_steps"] = cost.failed;
  state.counters["step_us"] = 1e6 * cost.step;
  state.counters["step_per_ball_us"] = 1e6 * cost.step / (edge * edge * edge);
  state.counters["solve_share"] = cost.solve / cost.wall;
  state.counters["quadruped_us"] = 1e6 * quadruped.step;
  state.counters["quadruped_steps"] = cost.step / quadruped.step;
}

BENCHMARK_CAPTURE(ballPile, automatic, fcs::BroadPhaseKind::AUTO)
    ->Arg(3)
    ->Arg(6)
    ->Arg(10)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ballPile, fcl, fcs::BroadPhaseKind::FCL)
    ->Arg(6)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ballPile, list, fcs::BroadPhaseKind::LIST)
    ->Arg(6)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
}  // namespace

BENCHMARK_MAIN();
