// Bodies wedged between others: nothing can push their overlaps out, a step does not ask in vain every time, and what
// is not wedged is pushed out meanwhile.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_archive.h"
#include "scene.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int STEPS = 200;

/** A block on the ground between two heavier ones that are held: no free motion separates both sides. */
Scenario wedgedBlock(double overlap, double mass)
{
  Scenario scenario = groundScene(0.5);
  scenario.stopping.tolerance = StoppingOptions().tolerance;
  addBody(scenario, "block", boxUrdf({0.1, 0.1, 0.1}, mass), poseAt(0.0, 0.0, 0.05));
  for (const int side : {-1, 1})
  {
    BodySpec& wall = addBody(scenario, side < 0 ? "left" : "right", boxUrdf({0.1, 0.1, 0.1}, 1.0),
                             poseAt(side * (0.1 - overlap), 0.0, 0.05));
    wall.base = BaseType::FIXED;
  }
  return scenario;
}

TEST(WedgedTest, WhatCannotBePushedOutIsNotAskedForInEveryStep)
{
  test_support::Dice dice(4711);
  for (int draw = 0; draw < 8; ++draw)
  {
    const double overlap = dice.logUniform(1e-12, 1e-5);
    const double mass = dice.logUniform(0.01, 100.0);
    Simulator simulator(wedgedBlock(overlap, mass));
    int asking = 0;
    for (int i = 0; i < STEPS; ++i)
    {
      const StepOutcome& outcome = simulator.step();
      ASSERT_TRUE(outcome.converged()) << outcome.message;
      asking += simulator.report().iterations > 10;
      EXPECT_LE(simulator.report().max_penetration, 2.0 * overlap + 1e-12);
      EXPECT_LT(simulator.velocity(0).norm(), 1e-8);
    }
    EXPECT_LE(asking, STEPS / 64 + 2) << overlap << " m, " << mass << " kg";
  }
}

TEST(WedgedTest, WhatIsFreeIsPushedOutWhileOthersAreWedged)
{
  test_support::Dice dice(4712);
  for (int draw = 0; draw < 8; ++draw)
  {
    const double depth = dice.logUniform(1e-8, 1e-6);
    Scenario scenario = wedgedBlock(dice.logUniform(1e-8, 1e-5), dice.logUniform(0.1, 10.0));
    addBody(scenario, "free", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0.0, 1.0, 0.05 - depth));
    Simulator simulator(scenario);
    const int steps = 10 + static_cast<int>(depth / (NormalLaw().recovery_speed * scenario.time_step));
    for (int i = 0; i < steps; ++i)
      ASSERT_TRUE(simulator.step().converged());
    EXPECT_GE(simulator.state().bodies[3].q[2], 0.05 - 1e-9) << depth;
  }
}

TEST(WedgedTest, AFreeBodyIsPushedOutAsBefore)
{
  Scenario scenario = groundScene(0.5);
  addBody(scenario, "block", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0.0, 0.0, 0.05 - 1e-10));
  Simulator simulator(scenario);
  ASSERT_TRUE(simulator.step().converged());
  ASSERT_TRUE(simulator.step().converged());
  EXPECT_LE(simulator.report().max_penetration, 1e-13);
}

TEST(WedgedTest, ALoadedStateGoesOnToTheBitWhileOverlapsAreLeft)
{
  const Scenario scenario = wedgedBlock(2e-7, 1.0);
  Simulator first(scenario);
  for (int i = 0; i < 10; ++i)
    first.step();
  Simulator second(scenario);
  second.setState(first.state());
  for (int i = 0; i < 2 * 64; ++i)
  {
    first.step();
    second.step();
    ASSERT_EQ(first.stateHash(), second.stateHash()) << i;
    ASSERT_EQ(first.report().iterations, second.report().iterations) << i;
  }
}

TEST(WedgedTest, PairsOfAStateFromOutsideAreChecked)
{
  Simulator simulator(wedgedBlock(1e-9, 1.0));
  const auto message = [&](const WedgedPairs& pairs)
  {
    SimulationState state = simulator.state();
    state.wedged = pairs;
    try
    {
      simulator.setState(state);
    }
    catch (const StateError& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double overlap : {std::nan(""), -1e-12, infinity})
    EXPECT_NE(message({{0, 1, overlap, 3}}), "") << overlap;
  EXPECT_NE(message({{0, 1, 1e-9, 0}}), "");
  EXPECT_NE(message({{0, 1000, 1e-9, 3}}), "");
  EXPECT_NE(message({{-1, 1, 1e-9, 3}}), "");
  EXPECT_NE(message({{0, 1, 1e-9, 3}, {0, 1, 1e-9, 3}}), "");
  EXPECT_NE(message({{1, 2, 1e-9, 3}, {0, 1, 1e-9, 3}}), "");
  EXPECT_EQ(message({{0, 1, 1e-9, 3}, {1, 2, 1e-3, 64}}), "");
}
}  // namespace
}  // namespace frictional_contact_sim
