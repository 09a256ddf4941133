// Trajectories: interpolation, replacement, what a joint does under one, state and reset.
#include "frictional_contact_sim/dynamics/joint_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_archive.h"
#include "frictional_contact_sim/simulation/state_file.h"
#include "scene.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;

/** A polynomial of degree `order`, and its point at `time`. */
struct Polynomial
{
  Polynomial(Dice& dice, int order)
  {
    for (int k = 0; k <= order; ++k)
      coefficients[k] = dice.uniform(-1.0, 1.0);
  }
  JointMotion at(double t) const
  {
    JointMotion motion;
    for (int k = 0; k < 6; ++k)
    {
      motion.position += coefficients[k] * std::pow(t, k);
      motion.velocity += k < 1 ? 0.0 : k * coefficients[k] * std::pow(t, k - 1);
      motion.acceleration += k < 2 ? 0.0 : k * (k - 1) * coefficients[k] * std::pow(t, k - 2);
    }
    return motion;
  }
  double coefficients[6] = {};
};

TrajectoryPoint point(double time, const JointMotion& motion, int order)
{
  TrajectoryPoint made;
  made.time = time;
  made.motion = motion;
  made.order = order;
  return made;
}

JointTrajectory randomTrajectory(Dice& dice, double begin)
{
  JointTrajectory trajectory;
  const int order = 1 + 2 * dice.integer(0, 2);
  for (int k = dice.integer(1, 5); k > 0; --k)
  {
    begin += dice.uniform(0.05, 1.0);
    trajectory.points.push_back(
        point(begin, {dice.uniform(-1.0, 1.0), dice.uniform(-1.0, 1.0), dice.uniform(-1.0, 1.0)}, order));
  }
  return trajectory;
}

void expectSame(const JointMotion& a, const JointMotion& b, double tolerance, double time)
{
  EXPECT_NEAR(a.position, b.position, tolerance) << time;
  EXPECT_NEAR(a.velocity, b.velocity, tolerance) << time;
  EXPECT_NEAR(a.acceleration, b.acceleration, 100.0 * tolerance) << time;
}

Scenario sliderScene()
{
  return railScene(1.0, 2.0);
}

constexpr int RAIL = 1;

/** Half a metre in a second, from rest to rest, no jump of acceleration. */
JointTrajectory smoothMove(double begin)
{
  JointTrajectory trajectory;
  trajectory.points.push_back(point(begin + 1.0, {0.5, 0.0, 0.0}, 5));
  return trajectory;
}
}  // namespace

TEST(JointTrajectoryTest, ReproducesPolynomialsOfItsOrder)
{
  Dice dice(31);
  for (int trial = 0; trial < 200; ++trial)
    for (const int order : {1, 3, 5})
    {
      const Polynomial polynomial(dice, order);
      const double begin = dice.uniform(-1.0, 1.0);
      const double length = dice.uniform(0.1, 2.0);
      JointTrajectory trajectory;
      trajectory.points.push_back(point(begin, polynomial.at(begin), order));
      trajectory.points.push_back(point(begin + length, polynomial.at(begin + length), order));
      trajectory.validate();
      for (const double s : {0.0, 0.1, 0.5, 0.77, 0.999})
        expectSame(trajectory.at(begin + s * length), polynomial.at(begin + s * length), 1e-10, s);
    }
}

TEST(JointTrajectoryTest, RestsBeforeAndAfter)
{
  JointTrajectory trajectory;
  trajectory.points = {point(1.0, {0.3, 5.0, 7.0}, 5), point(2.0, {-0.4, 2.0, 1.0}, 5)};
  expectSame(trajectory.at(0.999), {0.3, 0.0, 0.0}, 0.0, 0.999);
  expectSame(trajectory.at(2.0), {-0.4, 0.0, 0.0}, 0.0, 2.0);
  expectSame(trajectory.at(50.0), {-0.4, 0.0, 0.0}, 0.0, 50.0);
}

TEST(JointTrajectoryTest, AReplacementIsBridgedFromTheDesiredState)
{
  Dice dice(32);
  for (int trial = 0; trial < 500; ++trial)
  {
    const JointTrajectory present = randomTrajectory(dice, 0.0);
    const double now = dice.uniform(0.0, 3.0);
    const double begin = now + dice.uniform(-1.0, 2.0);
    const double bridge = std::max(now, begin);
    const JointTrajectory next = randomTrajectory(dice, begin);
    if (!(next.points.back().time > bridge))
      continue;
    const JointTrajectory both = continued(present, {9.0, 9.0, 9.0}, now, begin, next);
    both.validate();
    for (int k = 0; k < 50; ++k)
    {
      const double time = dice.uniform(now, now + 4.0);
      if (time < bridge)
        expectSame(both.at(time), present.at(time), 1e-9, time);
    }
    EXPECT_NEAR(both.at(bridge).position, present.at(bridge).position, 1e-12);
    if (next.points.front().order > 1)
    {
      EXPECT_NEAR(both.at(bridge).velocity, present.at(bridge).velocity, 1e-12);
    }
    for (const TrajectoryPoint& reached : next.points)
    {
      if (reached.time > bridge)
      {
        EXPECT_NEAR(both.at(reached.time).position, reached.motion.position, 1e-12);
      }
    }
    // Points of `next` that the bridge has passed over make no detour.
    size_t later = 0;
    for (const TrajectoryPoint& kept : both.points)
      later += kept.time > bridge ? 1 : 0;
    EXPECT_LE(later, next.points.size());
  }
}

TEST(JointTrajectoryTest, WhatIsOverIsForgottenAtTheNextReplacement)
{
  JointTrajectory trajectory;
  size_t most = 0;
  for (int k = 0; k < 10000; ++k)
  {
    const double now = 0.001 * k;
    trajectory = continued(trajectory, {}, now, now, smoothMove(now));
    most = std::max(most, trajectory.points.size());
  }
  EXPECT_LE(most, 3U);
}

TEST(JointTrajectoryTest, MistakesAreRefused)
{
  JointTrajectory trajectory;
  trajectory.points = {point(1.0, {}, 5), point(1.0, {}, 5)};
  EXPECT_THROW(trajectory.validate(), std::invalid_argument);
  trajectory.points = {point(1.0, {std::nan(""), 0.0, 0.0}, 5)};
  EXPECT_THROW(trajectory.validate(), std::invalid_argument);
  trajectory.points = {point(1.0, {}, 2)};
  EXPECT_THROW(trajectory.validate(), std::invalid_argument);
  Simulator simulator(sliderScene());
  const std::uint64_t hash = simulator.stateHash();
  EXPECT_THROW(simulator.followTrajectory(0, RAIL, {}, 0.0, trajectory), std::invalid_argument);
  EXPECT_EQ(simulator.stateHash(), hash);
}

TEST(FollowTrajectoryTest, AJointFollowsWithinWhatItsServoLags)
{
  // A critically damped servo of w = 40 rad/s lags by about a/w^2; a is at most 10/sqrt(3) 0.5 m/s^2.
  const double lag = 10.0 / std::sqrt(3.0) * 0.5 / (DEFAULT_SERVO_FREQUENCY * DEFAULT_SERVO_FREQUENCY);
  Simulator simulator(sliderScene());
  simulator.followTrajectory(0, RAIL, {}, 0.0, smoothMove(0.0));
  double worst = 0.0;
  for (int step = 1; step <= 1500; ++step)
  {
    ASSERT_TRUE(simulator.step().converged());
    const double s = std::min(1.0, 0.001 * step);
    const double desired = 0.5 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    ASSERT_NEAR(simulator.desiredMotion(0, RAIL).position, desired, 1e-12);
    worst = std::max(worst, std::abs(simulator.position(0)[0] - desired));
  }
  EXPECT_LT(worst, 1.05 * lag);
  EXPECT_GT(worst, 0.5 * lag);
  EXPECT_NEAR(simulator.position(0)[0], 0.5, 1e-7);
  EXPECT_NEAR(simulator.report().energy.balance_error, 0.0, 1e-11);
}

TEST(FollowTrajectoryTest, AStartInTheFutureWaitsWhereTheJointIs)
{
  Scenario scene = sliderScene();
  scene.bodies[0].joints["rail"] = {0.2, 0.0};
  Simulator simulator(scene);
  simulator.followTrajectory(0, RAIL, {}, 0.3, smoothMove(0.3));
  for (int step = 1; step <= 300; ++step)
  {
    simulator.step();
    ASSERT_EQ(simulator.position(0)[0], 0.2) << step;
  }
  simulator.step();
  simulator.step();
  EXPECT_GT(simulator.position(0)[0], 0.2);
}

TEST(FollowTrajectoryTest, TargetsStayWithinTheLimitsOfTheJoint)
{
  JointTrajectory wild;
  wild.points = {point(0.2, {0.9, 50.0, 0.0}, 5), point(0.6, {0.9, -50.0, 0.0}, 5)};  // meant to swing out to 5 m
  Simulator simulator(sliderScene());
  simulator.followTrajectory(0, RAIL, {}, 0.0, wild);
  for (int step = 0; step < 1000; ++step)
  {
    ASSERT_TRUE(simulator.step().converged());
    ASSERT_LE(std::abs(simulator.command(0, RAIL).target), 1.0);
    ASSERT_LE(std::abs(simulator.position(0)[0]), 1.0 + 1e-9);
  }
}

TEST(FollowTrajectoryTest, StopHoldsWhatIsDesiredNow)
{
  Simulator simulator(sliderScene());
  simulator.followTrajectory(0, RAIL, {}, 0.0, smoothMove(0.0));
  for (int step = 0; step < 500; ++step)
    simulator.step();
  simulator.stopTrajectory(0, RAIL);
  for (int step = 0; step < 1000; ++step)
    simulator.step();
  EXPECT_NEAR(simulator.position(0)[0], 0.25, 1e-9);
}

TEST(FollowTrajectoryTest, ResetSaveAndLoadGoOnToTheBit)
{
  const std::string path = testing::TempDir() + "joint_trajectory_state";
  Simulator whole(sliderScene());
  const std::uint64_t start = whole.stateHash();
  std::vector<std::uint64_t> hashes;
  for (int step = 0; step < 900; ++step)
  {
    if (step == 100)
      whole.followTrajectory(0, RAIL, {}, 0.2, smoothMove(0.2));
    if (step == 400)
      saveState(whole, path);
    whole.step();
    hashes.push_back(whole.stateHash());
  }
  Simulator half(sliderScene());
  loadState(half, path);
  for (int step = 400; step < 900; ++step)
  {
    half.step();
    ASSERT_EQ(half.stateHash(), hashes[static_cast<size_t>(step)]) << step;
  }
  whole.reset();
  EXPECT_TRUE(whole.trajectory(0, RAIL).empty());
  whole.step();
  EXPECT_EQ(whole.position(0)[0], 0.0);
  // A state without a trajectory ends one.
  Simulator fresh(sliderScene());
  saveState(fresh, path);
  loadState(half, path);
  EXPECT_TRUE(half.trajectory(0, RAIL).empty());
  EXPECT_EQ(half.stateHash(), start);
}

TEST(FollowTrajectoryTest, ADamagedTrajectoryIsRefused)
{
  Simulator simulator(sliderScene());
  simulator.followTrajectory(0, RAIL, {}, 0.0, smoothMove(0.0));
  SimulationState state = simulator.state();
  const std::uint64_t hash = simulator.stateHash();
  state.bodies[0].drives[RAIL].trajectory.points.back().time = -1.0;
  EXPECT_THROW(simulator.setState(state), StateError);
  state.bodies[0].drives[RAIL].trajectory.points.back() = point(1.0, {INFINITY, 0.0, 0.0}, 5);
  EXPECT_THROW(simulator.setState(state), StateError);
  EXPECT_EQ(simulator.stateHash(), hash);
}

}  // namespace frictional_contact_sim
