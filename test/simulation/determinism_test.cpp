// The same input gives the same bits, whatever the load; a step allocates nothing.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/allocation_counter.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
Scenario quadruped()
{
  return loadScenarioFile(std::string(PROJECT_DIR) + "/config/scenarios/quadruped.yaml");
}

/** Hash over the hashes of all steps. */
std::uint64_t runHash()
{
  AuditedSimulator simulator(quadruped());
  std::uint64_t hash = 0;
  for (int i = 0; i < 1000; ++i)
  {
    simulator.step();
    hash = hash * 1099511628211ULL + simulator.stateHash();
  }
  return hash;
}

TEST(DeterminismTest, TwoRunsGiveTheSameBits)
{
  EXPECT_EQ(runHash(), runHash());
}

TEST(DeterminismTest, LoadOnTheOtherCoresChangesNothing)
{
  const std::uint64_t quiet = runHash();
  std::atomic<bool> stop{false};
  std::atomic<double> sink{0.0};
  std::vector<std::thread> load;
  for (int i = 0; i < 3; ++i)
    load.emplace_back(
        [&]
        {
          double x = 1.0;
          while (!stop)
            sink = x = x * 1.0000001 + 1e-9;
        });
  const std::uint64_t loaded = runHash();
  stop = true;
  for (std::thread& thread : load)
    thread.join();
  EXPECT_EQ(quiet, loaded);
}

TEST(DeterminismTest, ResetRepeatsTheRunAndTimeGoesOn)
{
  AuditedSimulator simulator(quadruped());
  for (int i = 0; i < 200; ++i)
    simulator.step();
  const Eigen::VectorXd first = simulator.position(0);
  const double time = simulator.time();
  simulator.reset();
  EXPECT_EQ(simulator.time(), time);
  for (int i = 0; i < 200; ++i)
    simulator.step();
  EXPECT_EQ(first, simulator.position(0));
}

TEST(AllocationTest, StandingQuadrupedStepsWithoutAllocating)
{
  Simulator simulator(quadruped());
  for (int i = 0; i < 1000; ++i)
    simulator.step();
  const test_support::AllocationCounter counter;
  for (int i = 0; i < 100; ++i)
    simulator.step();
  EXPECT_EQ(counter.count(), 0);
}
}  // namespace
}  // namespace frictional_contact_sim
