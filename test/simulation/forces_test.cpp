/**
 * @file forces_test.cpp
 * @brief Contact forces that the equations leave open: they are those that the loads ask for (solver/least_norm.h),
 * whatever happened before.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/least_norm_check.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
constexpr double MASS = 10.0;

/** Sum of the forces on `body` along world axes, by the name of the other body [N]. */
std::map<std::string, Eigen::Vector3d> forcesOn(const Simulator& simulator, const std::string& body)
{
  std::map<std::string, Eigen::Vector3d> forces;
  const auto name = [&](int handle)
  {
    const int index = simulator.shape(handle).body;
    return index < 0 ? std::string("ground") : simulator.bodyName(index);
  };
  for (const ContactState& contact : simulator.contacts())
  {
    const std::string a = name(contact.shape_a), b = name(contact.shape_b);
    const Eigen::Vector3d force = contact.impulse / simulator.report().dt;
    if (a == body)
      forces.try_emplace(b, Eigen::Vector3d::Zero()).first->second += force;
    else if (b == body)
      forces.try_emplace(a, Eigen::Vector3d::Zero()).first->second -= force;
  }
  return forces;
}

/** Nothing here is nearer to round-off than 1e-11: 1e4 N on 1 kg are known to 1e-12 of what gravity does in a step. */
Scenario levelScene(double friction)
{
  Scenario scenario = groundScene(friction);
  scenario.stopping.tolerance = 1e-11;
  return scenario;
}

/** A box of 0.2 m between two walls that touch it, on the ground. */
Scenario betweenWalls(double friction)
{
  Scenario scenario = levelScene(friction);
  addBody(scenario, "box", boxUrdf({0.2, 0.2, 0.2}, MASS), poseAt(0, 0, 0.1));
  for (const double side : {-1.0, 1.0})
    addBody(scenario, side < 0.0 ? "left" : "right", boxUrdf({0.2, 0.2, 0.2}, MASS), poseAt(0.2 * side, 0, 0.1)).base =
        BaseType::FIXED;
  return scenario;
}

Scenario stack(int boxes, double friction)
{
  Scenario scenario = levelScene(friction);
  for (int k = 0; k < boxes; ++k)
    addBody(scenario, "box" + std::to_string(k), boxUrdf({0.2, 0.3, 0.1}, MASS), poseAt(0, 0, 0.05 + 0.1 * k));
  return scenario;
}

void push(Simulator& simulator, int body, const Eigen::Vector3d& force, double seconds)
{
  ExternalWrench wrench;
  wrench.link = simulator.model(body).frames.front().name;
  wrench.force = force;
  wrench.from = simulator.time();
  wrench.until = simulator.time() + seconds;
  simulator.addWrench(body, wrench);
}

void run(Simulator& simulator, int steps)
{
  for (int k = 0; k < steps; ++k)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
}

double largestDifference(const Simulator& a, const Simulator& b)
{
  double largest = 0.0;
  EXPECT_EQ(a.contacts().size(), b.contacts().size());
  for (size_t i = 0; i < std::min(a.contacts().size(), b.contacts().size()); ++i)
    largest = std::max(largest, (a.contacts()[i].impulse - b.contacts()[i].impulse).norm() / a.report().dt);
  return largest;
}

/** Sums of squares over the least one of the same effect, by the independent bound. */
double normRatio(const Simulator& simulator)
{
  Eigen::VectorXd thresholds(static_cast<Eigen::Index>(simulator.problem().laws.size()));
  thresholds.setConstant(1e-13);
  const LeastNormBound least = leastNormBound(simulator.problem(), thresholds, simulator.solution(), 2000);
  return least.sum <= 1e-18 ? 1.0 : least.sum / least.bound;
}
}  // namespace

TEST(ContactForcesTest, WallsCarryNothingWhenThePushHasGone)
{
  // Without friction the loads ask for nothing from the walls; with friction and no gravity neither. (With both, walls
  // that touch hold up a share of the weight: the least norm is what it is, not what one would guess.)
  for (const bool rough : {false, true})
  {
    Scenario scenario = betweenWalls(rough ? 0.3 : 0.0);
    if (rough)
      scenario.gravity.setZero();
    Simulator simulator(scenario);
    run(simulator, 20);
    push(simulator, 0, {300, 0, 0}, 0.05);
    run(simulator, 20);
    EXPECT_NEAR(forcesOn(simulator, "box")["right"].x(), -300.0, rough ? 300.0 : 1e-6);
    run(simulator, 60);
    // What tolerance 1e-11 leaves.
    EXPECT_LT(forcesOn(simulator, "box")["left"].norm(), 1e-6);
    EXPECT_LT(forcesOn(simulator, "box")["right"].norm(), 1e-6);
    EXPECT_NEAR(forcesOn(simulator, "box")["ground"].z(), rough ? 0.0 : MASS * GRAVITY, 1e-6);
  }
}

TEST(ContactForcesTest, AreTheSameAfterAPushThatHasGone)
{
  Simulator pushed(stack(3, 0.6));
  Simulator left(stack(3, 0.6));
  run(pushed, 20);
  run(left, 20);
  push(pushed, 1, {20, -10, -50}, 0.02);
  run(pushed, 60);
  run(left, 60);
  EXPECT_LT(largestDifference(pushed, left), 1e-9 * 3 * MASS * GRAVITY);
}

TEST(ContactForcesTest, AreTheSameWhenNothingIsRememberedOfTheStepBefore)
{
  Simulator kept(stack(3, 0.6));
  run(kept, 50);
  Simulator reloaded(stack(3, 0.6));
  reloaded.setState(kept.state());
  EXPECT_TRUE(reloaded.stateChanged().converged());  // drops warm starts
  run(kept, 1);
  run(reloaded, 1);
  EXPECT_LT(largestDifference(kept, reloaded), 1e-9 * 3 * MASS * GRAVITY);
}

TEST(ContactForcesTest, OfABoxAtRestAreAQuarterOfTheWeightEachAndSteady)
{
  Simulator simulator(stack(1, 0.5));
  run(simulator, 100);
  ASSERT_EQ(simulator.contacts().size(), 4u);
  std::vector<Eigen::Vector3d> impulses;
  for (const ContactState& contact : simulator.contacts())
  {
    impulses.push_back(contact.impulse);
    EXPECT_NEAR(contact.impulse.z() / simulator.report().dt, MASS * GRAVITY / 4, 1e-9);
    EXPECT_LT(contact.impulse.head<2>().norm() / simulator.report().dt, 1e-9);
  }
  run(simulator, 100);
  for (size_t i = 0; i < impulses.size(); ++i)
    EXPECT_LT((simulator.contacts()[i].impulse - impulses[i]).norm(), 1e-9 * MASS * GRAVITY * simulator.report().dt);
}

TEST(ContactForcesTest, OfAHeavyStackAreThoseOfTheWeightsAbove)
{
  // 1000 : 1, heavy on light; every interface has four points of a quarter of what is above, nothing sideways.
  Scenario scenario = levelScene(0.5);
  double above = 0.0;
  std::vector<double> masses = {1.0, 10.0, 100.0, 1000.0};
  for (int k = 0; k < 4; ++k)
    addBody(scenario, "box" + std::to_string(k), boxUrdf({0.2, 0.2, 0.1}, masses[static_cast<size_t>(k)]),
            poseAt(0, 0, 0.05 + 0.1 * k));
  Simulator simulator(scenario);
  run(simulator, 50);
  for (const double mass : masses)
    above += mass * GRAVITY;
  double expected = above;
  for (int k = 0; k < 4; ++k)
  {
    const std::string below = k == 0 ? "ground" : "box" + std::to_string(k - 1);
    const Eigen::Vector3d force = forcesOn(simulator, "box" + std::to_string(k))[below];
    EXPECT_NEAR(force.z(), expected, 1e-9 * above);
    expected -= masses[static_cast<size_t>(k)] * GRAVITY;
  }
  for (const ContactState& contact : simulator.contacts())
    EXPECT_LT(contact.impulse.head<2>().norm(), 1e-8 * std::abs(contact.impulse.z()));
}

TEST(ContactForcesTest, NeverAreTwiceTheLeastOfTheSameEffect)
{
  Scenario sliding = stack(2, 0.4);
  sliding.bodies[0].linear_velocity = {2.0, 0.5, 0.0};
  Scenario tumbling = stack(3, 0.5);
  tumbling.bodies[2].angular_velocity = {0.0, 3.0, 1.0};
  tumbling.bodies[2].pose = poseAt(0.02, 0.01, 0.4);
  const std::pair<const char*, Scenario> scenes[] = {
      {"stack", stack(4, 0.7)}, {"walls", betweenWalls(0.5)}, {"sliding", sliding}, {"tumbling", tumbling}};
  for (const auto& [name, scenario] : scenes)
  {
    Simulator simulator(scenario);
    for (int k = 0; k < 200; ++k)
    {
      ASSERT_TRUE(simulator.step().converged()) << name << " step " << k << ": " << simulator.outcome().message;
      if (k % 10 == 0)
      {
        EXPECT_LE(normRatio(simulator), 2.0) << name << " step " << k;
      }
    }
  }
}
