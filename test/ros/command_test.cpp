#include "frictional_contact_sim/ros/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using Mode = JointCommand::Mode;

Joint joint(double lower, double upper, double effort)
{
  Joint joint;
  joint.limit.lower = lower;
  joint.limit.upper = upper;
  joint.limit.effort = effort;
  return joint;
}

constexpr double INFINITE = std::numeric_limits<double>::infinity();

TEST(ClampTest, WhatAJointCanDoIsLeftAlone)
{
  const Joint hip = joint(-1.0, 2.0, 30.0);
  for (const double target : {-1.0, 0.0, 1.9999, 2.0})
  {
    double clamped = target;
    EXPECT_FALSE(clampTarget(hip, "hip", Mode::POSITION, 0.0, clamped));
    EXPECT_EQ(clamped, target);
  }
  double effort = -30.0;
  EXPECT_FALSE(clampTarget(hip, "hip", Mode::EFFORT, 0.0, effort));
  EXPECT_EQ(effort, -30.0);
}

TEST(ClampTest, AVelocityEndsWithinTheLimit)
{
  Joint hip = joint(-1.0, 2.0, 30.0);
  double speed = -1e300;
  EXPECT_TRUE(clampTarget(hip, "hip", Mode::VELOCITY, 0.0, speed));
  EXPECT_EQ(speed, -MAX_SPEED);
  hip.limit.velocity = 3.0;
  EXPECT_THAT(*clampTarget(hip, "hip", Mode::VELOCITY, 0.0, speed), testing::HasSubstr("below the smallest velocity"));
  EXPECT_EQ(speed, -3.0);
  EXPECT_FALSE(clampTarget(hip, "hip", Mode::VELOCITY, 0.0, speed));
}

TEST(ClampTest, TheLineNamesJointSideAndWhatIsTaken)
{
  double target = 1e6;
  const auto line = clampTarget(joint(-1.0, 2.0, 30.0), "hip", Mode::POSITION, 0.0, target);
  ASSERT_TRUE(line);
  EXPECT_THAT(*line, testing::AllOf(testing::HasSubstr("'hip'"), testing::HasSubstr("above"), testing::HasSubstr("2")));
  EXPECT_EQ(target, 2.0);
}

TEST(ClampTest, AnyFiniteTargetEndsWithinTheLimitsAndTheReach)
{
  test_support::Dice dice(20260102);
  int clamped = 0;
  for (int trial = 0; trial < 10000; ++trial)
  {
    const double lower = trial % 3 == 0 ? -INFINITE : dice.uniform(-10.0, 10.0);
    const double upper = trial % 3 == 0 ? INFINITE : lower + dice.uniform(0.0, 5.0);
    const Joint any = joint(lower, upper, trial % 2 == 0 ? INFINITE : dice.uniform(0.0, 100.0));
    const double position = dice.uniform(-20.0, 20.0);
    double target = dice.logUniform(1e-3, dice.chance(0.5) ? 1e2 : 1e300) * (dice.chance(0.5) ? 1.0 : -1.0);
    const Mode mode = trial % 5 == 0 ? Mode::EFFORT : Mode::POSITION;
    clamped += clampTarget(any, "any", mode, position, target) ? 1 : 0;
    if (mode == Mode::EFFORT)
    {
      ASSERT_LE(std::abs(target), std::min(MAX_EFFORT, any.limit.effort));
    }
    else
    {
      ASSERT_GE(target, lower);
      ASSERT_LE(target, upper);
      ASSERT_LE(std::abs(target - position), MAX_TRAVEL);
    }
  }
  EXPECT_GT(clamped, 1000);
  EXPECT_LT(clamped, 10000);
}

}  // namespace
}  // namespace frictional_contact_sim
