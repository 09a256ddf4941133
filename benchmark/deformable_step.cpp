// Times of whole steps of deformable bodies: an elastic block of 2400 nodes, 1000 of them on its surface and 100 on the
// ground, at rest and being dragged, and a hundred rods of six pieces. `solve_share` is the solver's part.
#include <benchmark/benchmark.h>

#include <chrono>
#include <random>
#include <sstream>
#include <string>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace fcs = frictional_contact_sim;

namespace
{
const char* const BLOCK = R"(
time_step: 0.001
ground: {friction: 0.5}
bodies:
  - name: block
    elastic: {box: [0.18, 0.18, 0.46], cells: [9, 9, 23], young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000,
              damping: 0.002MORE}
    pose: {xyz: [0, 0, 0.23]}
)";

std::string block(const std::string& more)
{
  std::string yaml = BLOCK;
  return yaml.replace(yaml.find("MORE"), 4, more);
}

/** A hundred curled hairs on a support that is shaken, as in config/scenarios/hair.yaml. */
std::string hairs()
{
  std::ostringstream yaml;
  std::mt19937 random(1);
  const auto curl = [&random] { return -12.0 + 24.0 * static_cast<double>(random() % 1000) / 999.0; };
  yaml << "time_step: 0.001\nmaterials: {default: {friction: 0.2}}\nbodies:\n";
  for (int i = 0; i < 10; ++i)
    for (int k = 0; k < 10; ++k)
    {
      yaml << "  - name: hair_" << i << '_' << k
           << "\n    rod: {length: 0.2, radius: 0.001, pieces: 6, sections: 4, density: 1300, young_modulus: 1.0e8, "
              "damping: 0.005, natural: ["
           << curl() << ", " << curl() << ", " << curl();
      yaml << "]}\n    pose: {xyz: [" << 0.012 * i << ", " << 0.012 * k
           << ", 0.4], rpy: [0, 1.5707963, 0]}\n    motion: {type: sine, axis: [1, 0, 0], amplitude: 0.02, frequency: "
              "2}\n";
    }
  return yaml.str();
}

/** @param settle steps before anything is measured */
void step(benchmark::State& state, const std::string& yaml, int settle)
{
  fcs::Simulator simulator(fcs::loadScenario(yaml, "benchmark"));
  for (int i = 0; i < settle; ++i)
    simulator.step();
  double solving = 0.0;
  double contacts = 0.0;
  double iterations = 0.0;
  double failures = 0.0;
  const auto begin = std::chrono::steady_clock::now();
  for (auto _ : state)
  {
    failures += simulator.step().converged() ? 0.0 : 1.0;
    solving += simulator.report().solve_time;
    contacts += simulator.report().contacts;
    iterations += simulator.report().iterations;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto steps = static_cast<double>(state.iterations());
  state.counters["velocities"] = simulator.report().velocities;
  state.counters["contacts"] = contacts / steps;
  state.counters["iterations"] = iterations / steps;
  state.counters["failures"] = failures;
  state.counters["solve_share"] = solving / seconds;
}

BENCHMARK_CAPTURE(step, block_at_rest, block(""), 100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, block_dragged, block(", fixed: [top]") + "    motion: {linear: [0.1, 0, -0.02]}\n", 20)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(100);
BENCHMARK_CAPTURE(step, hundred_rods, hairs(), 50)->Unit(benchmark::kMillisecond)->Iterations(20);
}  // namespace

BENCHMARK_MAIN();
