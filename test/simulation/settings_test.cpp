// What is set while a simulation runs: it acts from the next step on, in this simulation alone, and a refusal changes
// nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double MASS = 2.0;  // [kg]
constexpr double PUSH = 10.0;  // [N]: held by friction 0.8 (15.7 N), not by 0.3 (5.9 N)
constexpr double DT = 0.001;  // [s]
constexpr double ROUND_OFF = 1e-9;
constexpr double NOT_A_NUMBER = std::numeric_limits<double>::quiet_NaN();

/** A block that lies on the ground and is pushed along x from the start on. */
Scenario pushedBlock()
{
  Scenario scenario = groundScene(0.8);
  BodySpec& block = addBody(scenario, "block", boxUrdf({0.4, 0.4, 0.2}, MASS), poseAt(0.0, 0.0, 0.1));
  block.material = "wood";
  ExternalWrench push;
  push.link = "body";
  push.force = {PUSH, 0.0, 0.0};
  push.point = {0.0, 0.0, -0.1};  // at the ground, so that no torque tips it
  block.wrenches.push_back(push);
  scenario.materials.materials["wood"] = {0.8, 0.0};
  return scenario;
}

void run(Simulator& simulator, int steps)
{
  for (int i = 0; i < steps; ++i)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
}

/** Change of the block's velocity over some steps [m/s]. */
double speedUp(Simulator& simulator, int steps)
{
  const double before = simulator.velocity(0)[0];
  run(simulator, steps);
  return simulator.velocity(0)[0] - before;
}

TEST(SettingsTest, FrictionOfAPairActsFromTheNextStepOnWhateverNamesIt)
{
  for (const auto& [a, b] : {std::pair("block", "ground"), std::pair("ground", "block/body"),
                             std::pair("wood", "ground"), std::pair("ground", "wood")})
  {
    Simulator simulator(pushedBlock());
    EXPECT_NEAR(speedUp(simulator, 10), 0.0, ROUND_OFF);
    simulator.setFriction(a, b, 0.3);
    EXPECT_NEAR(speedUp(simulator, 10), 10 * DT * (PUSH / MASS - 0.3 * GRAVITY), ROUND_OFF) << a << " " << b;
    simulator.setFriction(b, a, 0.1);  // the last word counts
    EXPECT_NEAR(speedUp(simulator, 10), 10 * DT * (PUSH / MASS - 0.1 * GRAVITY), ROUND_OFF) << a << " " << b;
    simulator.reset();  // the state, not the settings
    EXPECT_NEAR(speedUp(simulator, 10), 10 * DT * (PUSH / MASS - 0.1 * GRAVITY), ROUND_OFF) << a << " " << b;
  }
}

TEST(SettingsTest, FrictionOfAPairLeavesOtherPairsAndOtherSimulationsAlone)
{
  Scenario scenario = pushedBlock();
  BodySpec other = scenario.bodies.front();
  other.name = "other";
  other.pose = poseAt(0.0, 3.0, 0.1);
  scenario.bodies.push_back(other);
  const auto world = loadWorldModel(scenario);
  Simulator set(world);
  Simulator untouched(world);
  set.setFriction("block", "ground", 0.3);
  run(set, 10);
  run(untouched, 10);
  EXPECT_GT(set.velocity(0)[0], 0.01);
  EXPECT_NEAR(set.velocity(1)[0], 0.0, ROUND_OFF);
  EXPECT_NEAR(untouched.velocity(0)[0], 0.0, ROUND_OFF);
}

TEST(SettingsTest, RestitutionIsSetOrLeft)
{
  Scenario scenario = groundScene(0.5, 0.25);
  addBody(scenario, "ball", sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.11));
  const auto rebound = [&scenario](std::optional<double> restitution)
  {
    Simulator simulator(scenario);
    simulator.setFriction("ball", "ground", 0.5, restitution);
    double fastest = 0.0;
    for (int i = 0; i < 200 && fastest <= 0.0; ++i)
    {
      simulator.step();
      fastest = simulator.velocity(0)[2];
    }
    return fastest / std::sqrt(2.0 * GRAVITY * 0.01);
  };
  EXPECT_NEAR(rebound(std::nullopt), 0.25, 0.03);  // speed of the impact: to a step's gravity
  EXPECT_NEAR(rebound(0.75), 0.75, 0.03);
}

TEST(SettingsTest, DefaultFrictionIsOfMaterialsWithoutAnEntry)
{
  Scenario scenario = pushedBlock();
  scenario.bodies.front().material = "default";
  Simulator simulator(scenario);
  simulator.setDefaultFriction(0.2);
  EXPECT_NEAR(speedUp(simulator, 10), 10 * DT * (PUSH / MASS - 0.2 * GRAVITY), ROUND_OFF);
}

TEST(SettingsTest, GravityActsFromTheNextStepOnAndTheLedgerStaysBalanced)
{
  Scenario scenario;
  addBody(scenario, "ball", sphereUrdf(0.1, MASS), poseAt(0.0, 0.0, 5.0));
  Simulator simulator(scenario);
  run(simulator, 50);
  const Eigen::Vector3d before = simulator.velocity(0).head<3>();
  simulator.setGravity({1.0, 0.0, -3.7});
  run(simulator, 100);
  EXPECT_TRUE((simulator.velocity(0).head<3>() - before).isApprox(100 * DT * Eigen::Vector3d(1.0, 0.0, -3.7), 1e-12));
  EXPECT_NEAR(simulator.report().energy.balance_error, 0.0, ROUND_OFF);
  simulator.reset();
  run(simulator, 100);
  EXPECT_NEAR(simulator.report().energy.balance_error, 0.0, ROUND_OFF);
}

TEST(SettingsTest, StateOfAnotherGravityKeepsTheLedgerBalanced)
{
  Scenario scenario;
  addBody(scenario, "ball", sphereUrdf(0.1, MASS), poseAt(0.0, 0.0, 5.0));
  Simulator moon(scenario);
  moon.setGravity({0.0, 0.0, -1.62});
  run(moon, 100);
  Simulator earth(scenario);
  earth.setState(moon.state());
  run(earth, 100);
  EXPECT_NEAR(earth.report().energy.balance_error, 0.0, ROUND_OFF);
}

TEST(SettingsTest, WhatIsSetToWhatItIsChangesNoBit)
{
  Simulator simulator(pushedBlock());
  Simulator untouched(pushedBlock());
  run(simulator, 20);
  run(untouched, 20);
  simulator.setGravity(simulator.scenario().gravity);
  simulator.setStopping(simulator.scenario().stopping);
  simulator.setTimeStep(simulator.scenario().time_step);
  simulator.setFriction("block", "ground", 0.8);
  run(simulator, 20);
  run(untouched, 20);
  EXPECT_EQ(simulator.position(0), untouched.position(0));
  EXPECT_EQ(simulator.velocity(0), untouched.velocity(0));
}

TEST(SettingsTest, ToleranceAndIterationsAreThoseOfTheNextStep)
{
  Simulator simulator(pushedBlock());
  simulator.setSolver("gauss_seidel");
  StoppingOptions stopping = simulator.scenario().stopping;
  stopping.tolerance = 1e-15;
  stopping.max_iterations = 1;
  FailureOptions failure;
  failure.fallback = false;
  simulator.setFailureOptions(failure);
  simulator.setStopping(stopping);
  EXPECT_FALSE(simulator.step().converged());
  stopping.tolerance = 1e-8;
  stopping.max_iterations = 1000;
  simulator.setStopping(stopping);
  EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  EXPECT_LE(simulator.outcome().residual, 1e-8);
}

TEST(SettingsTest, RefusalsNameTheFieldAndChangeNothing)
{
  Scenario scenario = pushedBlock();
  Simulator simulator(scenario);
  Simulator untouched(scenario);
  run(simulator, 5);
  run(untouched, 5);
  StoppingOptions bad = scenario.stopping;
  bad.tolerance = NOT_A_NUMBER;
  const std::pair<const char*, std::function<void()>> requests[] = {
      {"friction", [&] { simulator.setFriction("block", "ground", -0.1); }},
      {"friction", [&] { simulator.setFriction("block", "ground", NOT_A_NUMBER); }},
      {"restitution", [&] { simulator.setFriction("block", "ground", 0.5, 1.5); }},
      {"did you mean 'block'", [&] { simulator.setFriction("blok", "ground", 0.5); }},
      {"b: found ''", [&] { simulator.setFriction("block", "", 0.5); }},
      {"body/link", [&] { simulator.setFriction("block/nowhere", "ground", 0.5); }},
      {"body/link", [&] { simulator.setFriction("block/", "ground", 0.5); }},
      {"default_friction", [&] { simulator.setDefaultFriction(-1.0); }},
      {"gravity y",
       [&] {
         simulator.setGravity({0.0, NOT_A_NUMBER, 0.0});
       }},
      {"tolerance", [&] { simulator.setStopping(bad); }},
  };
  for (const auto& [reason, request] : requests)
  {
    try
    {
      request();
      FAIL() << reason << ": was taken";
    }
    catch (const std::invalid_argument& error)
    {
      EXPECT_THAT(error.what(), testing::HasSubstr(reason));
    }
  }
  run(simulator, 5);
  run(untouched, 5);
  EXPECT_EQ(simulator.stateHash(), untouched.stateHash());
}

}  // namespace
}  // namespace frictional_contact_sim
