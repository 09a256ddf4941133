// Impacts and rest: restitution, energy, stacks.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
double totalEnergy(const Simulator& simulator)
{
  return simulator.report().energy.kinetic + simulator.report().energy.potential;
}

/** Greatest heights between bounces of a ball dropped from `height` above contact. */
std::vector<double> bounceHeights(double restitution, double height, double h, double until,
                                  std::unique_ptr<AuditedSimulator>* last = nullptr)
{
  Scenario scene = groundScene(0.0, restitution);
  scene.time_step = h;
  addBody(scene, "ball", sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.1 + height));
  auto simulator = std::make_unique<AuditedSimulator>(scene);
  std::vector<double> heights;
  double top = 0.0;
  double old_speed = 0.0;
  while (simulator->time() < until)
  {
    simulator->step();
    const double speed = simulator->velocity(0)[2];
    if (old_speed < 0.0 && speed > 0.0)
    {
      heights.push_back(top);
      top = 0.0;
    }
    top = std::max(top, simulator->position(0)[2] - 0.1);
    old_speed = speed;
  }
  if (last != nullptr)
    *last = std::move(simulator);
  return heights;
}

TEST(BouncingBallTest, HeightsFallByTheSquareOfRestitutionWithOrderOne)
{
  const double e = 0.8;
  const double errors[2] = {std::abs(bounceHeights(e, 0.5, 1e-3, 1.2).at(1) - e * e * 0.5),
                            std::abs(bounceHeights(e, 0.5, 1e-4, 1.2).at(1) - e * e * 0.5)};
  // First order at the event: velocity at the impact is off by at most g h, the height by v g h / g.
  EXPECT_LT(errors[0], 4.0 * 3.2 * 1e-3);
  EXPECT_LT(errors[1], 4.0 * 3.2 * 1e-4);
}

TEST(BouncingBallTest, EndsAtRestAfterTheSumOfItsFlights)
{
  const double e = 0.5;
  std::unique_ptr<AuditedSimulator> simulator;
  bounceHeights(e, 0.2, 1e-3, 2.0, &simulator);
  // Rest to round-off: the gap is a difference of numbers of 0.1 m, 1e-17 / dt = 1e-14 m/s.
  const double resting_height = simulator->position(0)[2];
  for (int i = 0; i < 1000; ++i)
  {
    simulator->step();
    EXPECT_NEAR(simulator->velocity(0)[2], 0.0, 1e-13);
  }
  EXPECT_NEAR(simulator->position(0)[2], resting_height, 1e-15);
  EXPECT_NEAR(resting_height, 0.1, 1e-12);
}

TEST(BouncingBallTest, KeepsItsEnergyWithRestitutionOne)
{
  Scenario scene = groundScene(0.0, 1.0);
  addBody(scene, "ball", sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.3));
  AuditedSimulator simulator(scene);
  const double energy = totalEnergy(simulator);
  for (int i = 0; i < 5000; ++i)
    simulator.step();
  EXPECT_NEAR(totalEnergy(simulator), energy, 1e-13 * 5000 * energy);  // round-off grows with the number of steps
  EXPECT_GT(simulator.velocity(0).norm() + simulator.position(0)[2], 0.1);
}

/** Three equal balls in a row with the given distance of centres; the first moves at 1 m/s; speeds after `steps`. */
std::vector<double> cradleSpeeds(double distance, int steps)
{
  Scenario scene = groundScene(0.0, 1.0);
  scene.gravity.setZero();
  scene.ground.reset();
  for (int i = 0; i < 3; ++i)
    addBody(scene, "ball" + std::to_string(i), sphereUrdf(0.1, 1.0), poseAt(distance * i, 0.0, 0.0));
  scene.bodies[0].linear_velocity.x() = 1.0;
  AuditedSimulator simulator(scene);
  for (int i = 0; i < steps; ++i)
    simulator.step();
  return {simulator.velocity(0)[0], simulator.velocity(1)[0], simulator.velocity(2)[0]};
}

TEST(NewtonCradleTest, TouchingBallsFollowTheSimultaneousLaw)
{
  const std::vector<double> speeds = cradleSpeeds(0.2, 0);
  const double expected[3] = {-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0};
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(speeds[i], expected[i], 1e-12) << i;
}

TEST(NewtonCradleTest, SeparatedBallsPassTheMotionOn)
{
  const std::vector<double> speeds = cradleSpeeds(0.25, 300);
  const double expected[3] = {0.0, 0.0, 1.0};
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(speeds[i], expected[i], 1e-12) << i;
}

TEST(RestingBoxTest, EverySampleOfTheForceIsTheWeight)
{
  Scenario scene = groundScene(0.8);
  scene.stopping.tolerance = 1e-11;
  addBody(scene, "box", boxUrdf({0.2, 0.3, 0.1}, 10.0), poseAt(0.3, -0.2, 0.05));
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 500; ++i)
  {
    simulator.step();
    double force = 0.0;
    for (const ContactState& contact : simulator.contacts())
      force += contact.impulse.z() / simulator.report().dt;
    ASSERT_NEAR(force, 98.1, 1e-6) << "step " << i;
    ASSERT_LE(simulator.report().residual, 1e-11);
    ASSERT_EQ(simulator.contacts().size(), 4U);
  }
}

TEST(RestingBoxTest, WarmStartNeedsNoIterations)
{
  // Other codes stall a hair above the tolerance here. Velocities below the tolerance
  // (1e-10 m/s) move the box by 1e-13 m until the gap rows notice, after some 340 steps; then one iteration puts it
  // right.
  Scenario scene = groundScene(0.8);
  scene.stopping.tolerance = 1e-8;
  addBody(scene, "box", boxUrdf({0.2, 0.3, 0.1}, 10.0), poseAt(0.3, -0.2, 0.05));
  AuditedSimulator simulator(scene);
  simulator.step();
  for (int i = 1; i < 2000; ++i)
  {
    simulator.step();
    ASSERT_LE(simulator.report().iterations, i < 300 ? 0 : 1) << "step " << i;
  }
}

TEST(RestingBoxTest, ForcesOfTheFourCornersAreEqual)
{
  // Hyperstatic: any split along the null space is a solution; the least norm one is the even split.
  Scenario scene = groundScene(0.8);
  addBody(scene, "box", boxUrdf({0.2, 0.3, 0.1}, 10.0), poseAt(0.0, 0.0, 0.05));
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 100; ++i)
    simulator.step();
  ASSERT_EQ(simulator.contacts().size(), 4U);
  for (const ContactState& contact : simulator.contacts())
  {
    EXPECT_NEAR(contact.impulse.z() / 1e-3, 98.1 / 4.0, 1e-6);
    EXPECT_EQ(contact.mode, ContactMode::STICKING);
  }
}

TEST(DroppedBoxTest, PenetratesNothingAndComesToRest)
{
  Scenario scene = groundScene(0.6);
  scene.stopping.tolerance = 1e-10;
  BodySpec& box = addBody(scene, "box", boxUrdf({0.2, 0.3, 0.1}, 10.0), poseAt(0.0, 0.0, 0.4));
  box.pose->linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d(1.0, 2.0, 0.5).normalized()).toRotationMatrix();
  AuditedSimulator simulator(scene);
  double penetration = 0.0;
  for (int i = 0; i < 2000; ++i)
  {
    simulator.step();
    EXPECT_EQ(simulator.report().status, SolverStatus::CONVERGED) << simulator.report().residual;
    penetration = std::max(penetration, simulator.report().max_penetration);
  }
  // The gap row holds the linearised gap; a turning corner misses it by (w h)^2 L, here 1e-5 m at most.
  EXPECT_LT(penetration, 1e-5);
  EXPECT_LT(simulator.velocity(0).norm(), 1e-9);
  EXPECT_LT(simulator.report().max_penetration, 1e-6);
}

TEST(StackTest, TenBoxesHeavyOnLightStandStill)
{
  Scenario scene = groundScene(0.5);
  scene.stopping.tolerance = 1e-8;
  for (int i = 0; i < 10; ++i)
    addBody(scene, "box" + std::to_string(i), boxUrdf({0.2, 0.2, 0.2}, i == 9 ? 1000.0 : 1.0),
            poseAt(0.0, 0.0, 0.1 + 0.2 * i));
  AuditedSimulator simulator(scene);
  double weight = 0.0;
  for (int i = 0; i < 200; ++i)
  {
    simulator.step();
    ASSERT_EQ(simulator.report().status, SolverStatus::CONVERGED) << simulator.report().residual;
    ASSERT_LT(simulator.report().max_penetration, 1e-6);
    ASSERT_LT(simulator.report().residual, 1e-8);
  }
  for (const ContactState& contact : simulator.contacts())
    if (simulator.shape(contact.shape_b).body < 0)
      weight += contact.impulse.z() / 1e-3;
  EXPECT_NEAR(weight, 1009.0 * GRAVITY, 1e-3);
}

TEST(EnergyTest, FrictionDissipatesWhatTheBlockLoses)
{
  Scenario scene = groundScene(0.4);
  addBody(scene, "block", boxUrdf({0.4, 0.4, 0.1}, 2.0), poseAt(0.0, 0.0, 0.05)).linear_velocity.x() = 1.0;
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 400; ++i)
    simulator.step();
  const EnergyLedger& energy = simulator.report().energy;
  EXPECT_NEAR(energy.friction, 1.0, 1e-10);
  EXPECT_NEAR(energy.impact, 0.0, 1e-10);
  EXPECT_NEAR(energy.balance_error, 0.0, 1e-10);
}
}  // namespace
}  // namespace frictional_contact_sim
