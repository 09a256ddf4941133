// Real robots under position servos, ours and, where ../shared has them, published ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
const std::string SHARED_ROBOTS = std::string(PROJECT_DIR) + "/../shared/robots";
const std::string COLLECTION = SHARED_ROBOTS + "/example-robot-data/robots/";

struct RobotCase
{
  const char* name;
  std::string path;
  BaseType base;
  bool hold;
  bool ground;
};

class RobotTest : public testing::TestWithParam<RobotCase>
{
};

double weight(const Simulator& simulator)
{
  return simulator.model(0).totalMass() * simulator.scenario().gravity.norm();
}

double supportForce(const Simulator& simulator)
{
  double force = 0.0;
  for (const ContactState& contact : simulator.contacts())
    if (simulator.shape(contact.shape_b).body < 0)
      force += contact.impulse.z() / simulator.report().dt;
  return force;
}

TEST_P(RobotTest, RunsTwoSecondsWithoutAFailedStep)
{
  const RobotCase& robot = GetParam();
  if (!std::filesystem::exists(robot.path))
    GTEST_SKIP() << "no " << robot.path << ": published robots are tested only where ../shared is there";
  setenv("ROS_PACKAGE_PATH", SHARED_ROBOTS.c_str(), 1);
  Scenario scene = groundScene(0.8);
  scene.stopping.tolerance = 1e-8;
  if (!robot.ground)
    scene.ground.reset();
  BodySpec body;
  body.name = robot.name;
  body.urdf_path = robot.path;
  body.base = robot.base;
  body.hold_initial_position = robot.hold;
  scene.bodies.push_back(body);
  AuditedSimulator simulator(scene);
  double speed = 0.0;
  double worst_force = 0.0;
  for (int i = 0; i < 2000; ++i)
  {
    simulator.step();
    const StepSummary& report = simulator.report();
    ASSERT_EQ(report.status, SolverStatus::CONVERGED) << "step " << i << ", residual " << report.residual;
    ASSERT_LE(report.residual, 1e-8);
    ASSERT_LE(report.max_penetration, 1e-4) << "step " << i;
    ASSERT_TRUE(simulator.position(0).allFinite() && simulator.velocity(0).allFinite());
    if (i < 1500)
      continue;
    speed = std::max(speed, simulator.velocity(0).norm());
    if (robot.hold && robot.ground)
      worst_force = std::max(worst_force, std::abs(supportForce(simulator) / weight(simulator) - 1.0));
  }
  if (!robot.hold)
    return;
  EXPECT_LT(speed, 1e-4);
  EXPECT_LT(simulator.report().max_penetration, 1e-6);
  EXPECT_LT(worst_force, 1e-4);
}

TEST(LimpRobotTest, BoltFallsOnItsFeetWithoutGainingEnergy)
{
  // Its folded legs carry self-stress. Taken into the next step's prediction that gave 1e6 m/s; energy tells.
  const std::string path = COLLECTION + "bolt_description/robots/bolt.urdf";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no " << path << ": published robots are tested only where ../shared is there";
  setenv("ROS_PACKAGE_PATH", SHARED_ROBOTS.c_str(), 1);
  Scenario scene = groundScene(0.7);
  scene.stopping.tolerance = 1e-8;
  BodySpec body;
  body.name = "bolt";
  body.urdf_path = path;
  body.base = BaseType::FLOATING;
  scene.bodies.push_back(body);
  Simulator simulator(scene);
  const double start = simulator.report().energy.kinetic + simulator.report().energy.potential;
  double lowest = start;
  for (int i = 0; i < 2000; ++i)
  {
    ASSERT_TRUE(simulator.step().converged()) << "step " << i << ": " << simulator.outcome().message;
    const double energy = simulator.report().energy.kinetic + simulator.report().energy.potential;
    // A limp robot only loses energy; the scheme's own error of order dt^2 is below a thousandth of the start here.
    ASSERT_LE(energy, lowest + 1e-3 * start) << "step " << i;
    lowest = std::min(lowest, energy);
  }
  EXPECT_LT(simulator.velocity(0).norm(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Published, RobotTest,
    testing::Values(RobotCase{"anymal", COLLECTION + "anymal_b_simple_description/robots/anymal.urdf",
                              BaseType::FLOATING, true, true},
                    RobotCase{"go1", COLLECTION + "go1_description/urdf/go1.urdf", BaseType::FLOATING, true, true},
                    RobotCase{"solo12", COLLECTION + "solo_description/robots/solo12.urdf", BaseType::FLOATING, true,
                              true},
                    RobotCase{"panda", COLLECTION + "panda_description/urdf/panda.urdf", BaseType::FIXED, true, false},
                    RobotCase{"panda_collision", COLLECTION + "panda_description/urdf/panda_collision.urdf",
                              BaseType::FIXED, true, false},
                    RobotCase{"allegro", COLLECTION + "allegro_hand_description/urdf/allegro_right_hand.urdf",
                              BaseType::FIXED, true, false},
                    RobotCase{"humanoid", COLLECTION + "simple_humanoid_description/urdf/simple_humanoid.urdf",
                              BaseType::AUTO, false, true}),
    [](const testing::TestParamInfo<RobotCase>& info) { return info.param.name; });
}  // namespace
}  // namespace frictional_contact_sim
