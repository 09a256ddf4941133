// The library without ROS: one world loaded once, eight simulations of it in two threads, each with its own push.
//   many_simulations SCENARIO.yaml [STEPS]
// Prints a line a simulation: its number, the hash of its state, where its last body ended.
#include <atomic>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace fcs = frictional_contact_sim;

namespace
{
constexpr int SIMULATIONS = 8;
constexpr int THREADS = 2;

/** One simulation, to its end: nothing is shared but the world. */
std::string simulate(const std::shared_ptr<const fcs::WorldModel>& world, int number, int steps)
{
  fcs::Simulator simulator(world);
  const int body = simulator.bodyCount() - 1;
  fcs::ExternalWrench push;
  push.link = simulator.model(body).frames.front().name;
  push.force = Eigen::Vector3d(0.5 * number, 0.0, 0.0);  // [N]
  push.until = 0.1;  // [s]
  simulator.addWrench(body, push);
  for (int step = 0; step < steps; ++step)
    if (const fcs::StepOutcome& outcome = simulator.step(); !outcome.converged())
      std::fprintf(stderr, "simulation %d, step %d: %s\n", number, step, outcome.message.c_str());
  char line[160];
  const Eigen::Vector3d end = simulator.data(body).link_pose.front().translation();
  std::snprintf(line, sizeof line, "%d %016llx %s at (%.6f, %.6f, %.6f)", number,
                static_cast<unsigned long long>(simulator.stateHash()), simulator.bodyName(body).c_str(), end.x(),
                end.y(), end.z());
  return line;
}
}  // namespace

int main(int argc, char** argv)
{
  if (argc < 2)
  {
    std::fprintf(stderr, "usage: many_simulations SCENARIO.yaml [STEPS]\n");
    return 2;
  }
  try
  {
    const int steps = argc > 2 ? std::stoi(argv[2]) : 500;
    const std::shared_ptr<const fcs::WorldModel> world = fcs::loadWorldModel(fcs::loadScenarioFile(argv[1]));
    if (world->bodies.empty())
      throw std::invalid_argument(std::string(argv[1]) + " has no bodies");
    std::vector<std::string> lines(SIMULATIONS);
    std::atomic<int> next{0};
    std::vector<std::thread> threads;
    for (int thread = 0; thread < THREADS; ++thread)
      threads.emplace_back(
          [&]
          {
            for (int number = next++; number < SIMULATIONS; number = next++)
              lines[number] = simulate(world, number, steps);  // nothing is thrown: the push is finite, the link exists
          });
    for (std::thread& thread : threads)
      thread.join();
    for (const std::string& line : lines)
      std::puts(line.c_str());
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "many_simulations: %s\n", error.what());
    return 2;
  }
  return 0;
}
