// Blocks that slide, stick and tip: Coulomb's law against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
constexpr double PI = 3.14159265358979323846;

/** Runs until the body moves no more; returns the time of the first step that ends at rest. */
double runToRest(AuditedSimulator& simulator, double limit)
{
  while (simulator.time() < limit)
  {
    simulator.step();
    EXPECT_EQ(simulator.report().status, SolverStatus::CONVERGED) << simulator.report().residual;
    if (simulator.velocity(0).norm() < 1e-12)
      return simulator.time();
  }
  ADD_FAILURE() << "still moving at " << simulator.velocity(0).transpose();
  return limit;
}

TEST(SlidingBlockTest, StopsAfterTheTimeAndDistanceOfCoulombsLaw)
{
  const double mu = 0.4;
  const double v0 = 1.0;
  const double h = 1e-3;
  Scenario scene = groundScene(mu);
  addBody(scene, "block", boxUrdf({0.4, 0.4, 0.1}, 2.0), poseAt(0.0, 0.0, 0.05)).linear_velocity.x() = v0;
  AuditedSimulator simulator(scene);
  const double time = runToRest(simulator, 1.0);
  EXPECT_NEAR(time, v0 / (mu * GRAVITY), h);
  // The last step is cut short: its mean velocity is half the old one, an error of at most mu g h^2 / 8.
  EXPECT_NEAR(simulator.position(0)[0], v0 * v0 / (2.0 * mu * GRAVITY), mu * GRAVITY * h * h / 8.0 + 1e-12);
}

TEST(SlidingBlockTest, FastCubeDoesNotLiftOff)
{
  Scenario scene = groundScene(0.5);
  addBody(scene, "cube", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0.0, 0.0, 0.05)).linear_velocity.x() = 6.0;
  AuditedSimulator simulator(scene);
  double lift = 0.0;
  double time = 0.0;
  while (simulator.time() < 1.5)
  {
    simulator.step();
    lift = std::max(lift, std::abs(simulator.position(0)[2] - 0.05));
    if (simulator.velocity(0).norm() > 1e-12)
      time = simulator.time();
  }
  EXPECT_LT(lift, 1e-9);
  EXPECT_NEAR(time, 6.0 / (0.5 * GRAVITY), 1e-3);
  EXPECT_NEAR(simulator.position(0)[0], 36.0 / GRAVITY, 0.5 * GRAVITY * 1e-6 / 8.0 + 1e-10);
}

/** Speed after a tenth of a second on an incline, zero when the block sticks. */
double inclineSpeed(double mu, double angle)
{
  Scenario scene = groundScene(mu);
  incline(scene, angle);
  addBody(scene, "block", boxUrdf({0.4, 0.4, 0.1}, 2.0), poseAt(0.0, 0.0, 0.05));
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 100; ++i)
    simulator.step();
  return simulator.velocity(0)[0];
}

TEST(BlockOnInclineTest, SticksBelowTheFrictionAngleAndSlidesAbove)
{
  const double mu = 0.5;
  const double friction_angle = std::atan(mu);
  EXPECT_LT(std::abs(inclineSpeed(mu, friction_angle * (1.0 - 1e-6))), 1e-11);
  EXPECT_GT(inclineSpeed(mu, friction_angle * (1.0 + 1e-6)), 1e-8);
}

TEST(BlockOnInclineTest, AcceleratesAsTheClosedFormSays)
{
  const double mu = 0.3;
  const double angle = 0.6;
  const double expected = GRAVITY * (std::sin(angle) - mu * std::cos(angle));
  // Velocities are exact for constant forces; 1e-10 is the solver's tolerance summed over 100 steps.
  EXPECT_NEAR(inclineSpeed(mu, angle) / 0.1, expected, 1e-10);
}

TEST(ConeIsotropyTest, FrictionOpposesSlidingEquallyInEveryHeading)
{
  const double mu = 0.5;
  const double mass = 2.0;
  for (int degrees = 0; degrees < 360; degrees += 10)
  {
    const double heading = degrees * PI / 180.0;
    const Eigen::Vector2d direction(std::cos(heading), std::sin(heading));
    Scenario scene = groundScene(mu);
    addBody(scene, "disc", cylinderUrdf(0.3, 0.1, mass), poseAt(0.0, 0.0, 0.05)).linear_velocity.head<2>() = direction;
    AuditedSimulator simulator(scene);
    simulator.step();
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (const ContactState& contact : simulator.contacts())
      force += contact.impulse / simulator.report().dt;
    EXPECT_NEAR(force.head<2>().norm(), mu * mass * GRAVITY, 1e-8) << degrees;
    EXPECT_LT((force.head<2>() / force.head<2>().norm() + direction).norm(), 1e-10) << degrees;
    EXPECT_NEAR(simulator.velocity(0).head<2>().norm(), 1.0 - mu * GRAVITY * 1e-3, 1e-10) << degrees;
  }
}

/** A block pushed at height y above the ground by 1.01 times its friction: true when it tips. */
bool tips(double width, double height, double mu)
{
  Scenario scene = groundScene(mu);
  const double tall = 2.0;
  BodySpec& block = addBody(scene, "block", boxUrdf({width, 1.0, tall}, 5.0), poseAt(0.0, 0.0, tall / 2.0));
  ExternalWrench push;
  push.link = "body";
  // Just enough to slide: the deceleration is zero, so that moments balance about the leading edge as in statics.
  push.force.x() = mu * 5.0 * GRAVITY;
  push.point.z() = height - tall / 2.0;
  block.wrenches.push_back(push);
  block.linear_velocity.x() = 0.1;
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 200; ++i)
    simulator.step();
  return std::abs(simulator.velocity(0)[4]) > 1e-7;
}

TEST(TippingBlockTest, SlidesBelowTheCriticalHeightAndTipsAbove)
{
  const double width = 0.4;
  const double mu = 0.5;
  const double critical = width / (2.0 * mu);
  EXPECT_FALSE(tips(width, critical * (1.0 - 1e-5), mu));
  EXPECT_TRUE(tips(width, critical * (1.0 + 1e-5), mu));
}

TEST(ThrownSphereTest, RollsWithFiveSeventhsOfItsSpeed)
{
  const double mu = 0.3;
  const double radius = 0.2;
  const double v0 = 2.0;
  Scenario scene = groundScene(mu);
  addBody(scene, "ball", sphereUrdf(radius, 1.5), poseAt(0.0, 0.0, radius)).linear_velocity.x() = v0;
  AuditedSimulator simulator(scene);
  const double roll_time = 2.0 * v0 / (7.0 * mu * GRAVITY);
  double rolls_since = 0.0;
  while (simulator.time() < 2.0 * roll_time)
  {
    simulator.step();
    const double slip = simulator.velocity(0)[0] - radius * simulator.velocity(0)[4];
    if (std::abs(slip) > 1e-10)
      rolls_since = simulator.time();
  }
  EXPECT_NEAR(simulator.velocity(0)[0], 5.0 * v0 / 7.0, 1e-12 * 200);  // round-off of some 200 steps
  EXPECT_NEAR(rolls_since, roll_time, 1e-3);
}

TEST(RollingTest, SphereOnInclineRollsWithFiveSeventhsOfTheSlope)
{
  const double angle = 0.3;
  for (const bool rolls : {true, false})
  {
    const double critical = 2.0 / 7.0 * std::tan(angle);
    const double mu = critical * (rolls ? 1.0 + 1e-6 : 0.5);
    Scenario scene = groundScene(mu);
    incline(scene, angle);
    addBody(scene, "ball", sphereUrdf(0.2, 1.5), poseAt(0.0, 0.0, 0.2));
    AuditedSimulator simulator(scene);
    for (int i = 0; i < 100; ++i)
      simulator.step();
    const double rolling = 5.0 / 7.0 * GRAVITY * std::sin(angle);
    const double sliding = GRAVITY * (std::sin(angle) - mu * std::cos(angle));
    EXPECT_NEAR(simulator.velocity(0)[0] / 0.1, rolls ? rolling : sliding, 1e-10);
  }
}

TEST(FrictionPairTest, SmallerValueOfBothSidesDecidesUnlessThePairHasItsOwn)
{
  MaterialTable table;
  table.fallback = {0.5, 0.2};
  table.materials["ice"] = {0.05, 0.4};
  table.pairs[{"ice", "rubber"}] = {0.9, 0.1};
  EXPECT_EQ(pairMaterial(table, {"default"}, {"ice"}).friction, 0.05);
  EXPECT_EQ(pairMaterial(table, {"default"}, {"ice"}).restitution, 0.2);
  EXPECT_EQ(pairMaterial(table, {"rubber"}, {"ice"}).friction, 0.9);
  EXPECT_EQ(pairMaterial(table, {"default", 0.3}, {"ground"}).friction, 0.3);
}
}  // namespace
}  // namespace frictional_contact_sim
