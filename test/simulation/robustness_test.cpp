// States and inputs that no one means seriously: a step may fail, but nothing crashes and no NaN stays.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "frictional_contact_sim/simulation/root_motion.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
TEST(RunawayTest, OverflowingForceFailsTheStepAndLeavesTheStateFinite)
{
  for (const double point : {0.0, 9e10})
  {
    Scenario scene = groundScene(0.5);
    ExternalWrench push;
    push.link = "body";
    push.force.x() = point > 0.0 ? 1e308 : 1e200;
    push.point.z() = point;
    addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.1)).wrenches.push_back(push);
    AuditedSimulator simulator(scene);
    simulator.waive("failed");  // the subject of the test
    for (int i = 0; i < 10; ++i)
      EXPECT_EQ(simulator.step().status, SolverStatus::NUMERICAL_FAILURE);
    EXPECT_TRUE(simulator.position(0).allFinite() && simulator.velocity(0).allFinite());
    EXPECT_TRUE(std::isfinite(simulator.report().energy.balance_error));
    EXPECT_EQ(simulator.report().residual, 1.0);
  }
}

TEST(RunawayTest, InitialStateBeyondReasonIsRefused)
{
  Scenario scene = groundScene(0.5);
  addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 50.0)).linear_velocity.z() = -1e160;
  EXPECT_THROW(Simulator{scene}, std::invalid_argument);
}

TEST(MovingBaseTest, FastRamNeitherPenetratesNorHidesItsVelocity)
{
  Scenario scene = groundScene(0.5);
  scene.gravity.setZero();
  scene.ground.reset();
  const Eigen::Vector3d speed(50.0, 0.0, 0.0);
  BodySpec& ram = addBody(scene, "ram", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(-0.5, 0.0, 0.0));
  ram.base = BaseType::FIXED;
  ram.motion.emplace(speed, Eigen::Vector3d::Zero());
  addBody(scene, "ball", sphereUrdf(0.1, 1.0), poseAt(0.3, 0.0, 0.0));
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 50; ++i)
  {
    simulator.step();
    EXPECT_LT(simulator.report().max_penetration, 1e-12);
  }
  EXPECT_NEAR(simulator.velocity(1)[0], 50.0, 1e-9);  // e = 0: the ball goes with the ram
  EXPECT_EQ((rootVelocity(simulator, 0).head<3>() - speed).norm(), 0.0);
}

TEST(DecayTest, ServoedArmComesToRestWithoutAFailedStep)
{
  // After half a minute positions and velocities are subnormal numbers.
  Scenario scene = groundScene(0.5);
  scene.ground.reset();
  scene.stopping.tolerance = 1e-8;
  BodySpec arm;
  arm.name = "arm";
  arm.urdf_path = std::string(PROJECT_DIR) + "/urdf/double_pendulum.urdf";
  arm.base = BaseType::FIXED;
  arm.hold_initial_position = true;
  arm.joints["shoulder"].velocity = 1.0;
  scene.bodies.push_back(arm);
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 60000; ++i)
    ASSERT_EQ(simulator.step().status, SolverStatus::CONVERGED) << "step " << i;
}
}  // namespace
}  // namespace frictional_contact_sim
