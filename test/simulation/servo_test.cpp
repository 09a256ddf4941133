// Servos under load: what stands off, what a feed-forward and gravity compensation remove, limits, work.
#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/allocation_counter.h"

namespace frictional_contact_sim
{
namespace
{
using Mode = JointCommand::Mode;

std::string link(const std::string& name, double mass)
{
  return "<link name='" + name + "'><inertial><mass value='" + std::to_string(mass) +
         "'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>";
}

std::string slide(const std::string& name, const std::string& child, const std::string& more)
{
  return "<joint name='" + name + "' type='prismatic'><parent link='world'/><child link='" + child +
         "'/><axis xyz='0 0 1'/>" + more + "</joint>";
}

constexpr double MASS = 2.0;
constexpr double WEIGHT = MASS * GRAVITY;

/** 2 kg on a vertical slide. */
Scenario hoist(double effort_limit)
{
  Scenario scene;
  BodySpec body;
  body.name = "hoist";
  body.urdf_xml = "<robot name='hoist'><link name='world'/>" + link("load", MASS) +
                  slide("lift", "load",
                        "<limit lower='-10' upper='10' effort='" + std::to_string(effort_limit) + "' velocity='3'/>") +
                  "</robot>";
  scene.bodies.push_back(body);
  scene.stopping.tolerance = 1e-13;
  return scene;
}

JointCommand servo(Mode mode, double target, double feedforward = 0.0)
{
  JointCommand command;
  command.mode = mode;
  command.target = target;
  command.feedforward = feedforward;
  return command;
}

void run(Simulator& simulator, int steps)
{
  for (int step = 0; step < steps; ++step)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
}

/** Ends where the ledger says: all work is somewhere. */
void expectBalanced(const Simulator& simulator, double moved)
{
  EXPECT_NEAR(simulator.report().energy.balance_error, 0.0, 1e-10 * std::max(1.0, std::abs(moved)));
}
}  // namespace

TEST(ServoTest, AVelocityServoSlipsByLoadOverGain)
{
  Scenario scene = hoist(1000.0);
  scene.bodies[0].commands["lift"] = servo(Mode::VELOCITY, 0.5);
  Simulator simulator(scene);
  run(simulator, 2000);
  const double gain = MASS * DEFAULT_SERVO_FREQUENCY;
  EXPECT_NEAR(simulator.velocity(0)[0], 0.5 - WEIGHT / gain, 1e-10);
  expectBalanced(simulator, WEIGHT);
}

TEST(ServoTest, AFeedForwardOfTheLoadRemovesTheSlip)
{
  Scenario scene = hoist(1000.0);
  scene.bodies[0].commands["lift"] = servo(Mode::VELOCITY, 0.5, WEIGHT);
  Simulator simulator(scene);
  run(simulator, 1500);
  EXPECT_NEAR(simulator.velocity(0)[0], 0.5, 1e-12);
  const int lift = simulator.model(0).findJoint("lift");
  EXPECT_NEAR(simulator.effort(0, lift), WEIGHT, 1e-9);
  expectBalanced(simulator, WEIGHT);
}

TEST(ServoTest, APositionServoDroopsByLoadOverStiffnessUnlessItIsFedForward)
{
  const double stiffness = MASS * DEFAULT_SERVO_FREQUENCY * DEFAULT_SERVO_FREQUENCY;
  for (const double feedforward : {0.0, 0.5 * WEIGHT, WEIGHT})
  {
    Scenario scene = hoist(1000.0);
    scene.bodies[0].commands["lift"] = servo(Mode::POSITION, 0.2, feedforward);
    Simulator simulator(scene);
    run(simulator, 2000);
    EXPECT_NEAR(simulator.position(0)[0], 0.2 - (WEIGHT - feedforward) / stiffness, 1e-12) << feedforward;
    expectBalanced(simulator, 0.2 * WEIGHT);
  }
}

TEST(ServoTest, ARateBesideAPositionIsTheTargetOfTheDamper)
{
  // At rest kp (q_d - q) + kd rate = weight.
  Scenario scene = hoist(1000.0);
  JointCommand command = servo(Mode::POSITION, 0.2);
  command.kp = 400.0;
  command.kd = 80.0;
  command.rate = 0.5;
  scene.bodies[0].commands["lift"] = command;
  Simulator simulator(scene);
  run(simulator, 4000);
  EXPECT_NEAR(simulator.position(0)[0], 0.2 + (80.0 * 0.5 - WEIGHT) / 400.0, 1e-10);
}

TEST(ServoTest, TheEffortLimitHoldsForTheSum)
{
  const double limit = 15.0;  // below the weight
  for (const Mode mode : {Mode::POSITION, Mode::VELOCITY})
    for (const double feedforward : {0.0, 10.0, 1e6})
    {
      Scenario scene = hoist(limit);
      scene.bodies[0].gravity_compensation = feedforward == 10.0;
      scene.bodies[0].commands["lift"] = servo(mode, mode == Mode::POSITION ? 1.0 : 0.5, feedforward);
      Simulator simulator(scene);
      const int lift = simulator.model(0).findJoint("lift");
      for (int step = 1; step <= 200; ++step)
      {
        ASSERT_TRUE(simulator.step().converged());
        ASSERT_LE(std::abs(simulator.effort(0, lift)), limit * (1.0 + 1e-9));
      }
      EXPECT_NEAR(simulator.velocity(0)[0], 0.2 * (limit / MASS - GRAVITY), 1e-9) << "falls at what the limit leaves";
      expectBalanced(simulator, WEIGHT);
    }
}

TEST(ServoTest, AServoWithoutGainsGivesItsFeedForwardWithinTheLimit)
{
  Scenario scene = hoist(15.0);
  JointCommand command = servo(Mode::POSITION, 0.0, 1e3);
  command.kp = command.kd = 0.0;
  scene.bodies[0].commands["lift"] = command;
  Simulator simulator(scene);
  run(simulator, 100);
  EXPECT_NEAR(simulator.effort(0, simulator.model(0).findJoint("lift")), 15.0, 1e-12);
  EXPECT_NEAR(simulator.velocity(0)[0], 0.1 * (15.0 / MASS - GRAVITY), 1e-12);
}

TEST(ServoTest, ASaturatedServoOfARobotAtRestIsSolved)
{
  // At rest in compensated servos no smooth force is left to measure an answer with but that of the servo itself.
  Scenario scene;
  BodySpec body;
  body.name = "arm";
  body.urdf_path = std::string(PROJECT_DIR) + "/urdf/arm.urdf";
  body.base = BaseType::FIXED;
  body.joints = {{"shoulder", {-0.7, 0.0}}, {"elbow", {1.7, 0.0}}, {"left_finger", {0.03, 0.0}}};
  body.hold_initial_position = true;
  body.gravity_compensation = true;
  body.commands["yaw"] = servo(Mode::POSITION, 2.0);
  scene.bodies.push_back(body);
  Simulator simulator(scene);
  const int yaw = simulator.model(0).findJoint("yaw");
  simulator.step();
  EXPECT_TRUE(simulator.outcome().converged()) << simulator.outcome().message;
  EXPECT_DOUBLE_EQ(simulator.effort(0, yaw), 60.0) << "its limit";
  run(simulator, 2000);
  EXPECT_NEAR(simulator.position(0)[0], 2.0, 1e-6);
}

TEST(GravityCompensationTest, AnArmAtRestThatIsHitIsSolved)
{
  Scenario scene = groundScene(0.5);
  scene.stopping.tolerance = 1e-8;
  BodySpec body;
  body.name = "arm";
  body.urdf_path = std::string(PROJECT_DIR) + "/urdf/arm.urdf";
  body.base = BaseType::FIXED;
  body.joints = {{"yaw", {0.2, 0.0}}, {"shoulder", {-0.7, 0.0}}, {"elbow", {1.7, 0.0}}, {"left_finger", {0.03, 0.0}}};
  body.hold_initial_position = true;
  body.gravity_compensation = true;
  scene.bodies.push_back(body);
  addBody(scene, "part", boxUrdf(Eigen::Vector3d::Constant(0.05), 0.2), poseAt(0.2, 0.04, 0.9));
  Simulator simulator(scene);
  double fastest = 0.0;
  for (int step = 0; step < 500; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << step << ": " << simulator.outcome().message;
    fastest = std::max(fastest, simulator.velocity(0).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(fastest, 1e-2) << "the part falls onto the upper arm";
}

TEST(GravityCompensationTest, AnArmHoldsWithoutDroop)
{
  Scenario scene;
  BodySpec body;
  body.name = "arm";
  body.urdf_path = std::string(PROJECT_DIR) + "/urdf/double_pendulum.urdf";
  body.joints = {{"shoulder", {1.1, 0.0}}, {"elbow", {-0.7, 0.0}}};
  body.hold_initial_position = true;
  scene.bodies.push_back(body);
  scene.stopping.tolerance = 1e-13;
  Simulator drooping(scene);
  run(drooping, 1000);
  EXPECT_GT(std::abs(drooping.position(0)[0] - 1.1), 1e-3) << "without compensation it droops";

  scene.bodies[0].gravity_compensation = true;
  Simulator held(scene);
  run(held, 1000);
  EXPECT_NEAR(held.position(0)[0], 1.1, 1e-12);
  EXPECT_NEAR(held.position(0)[1], -0.7, 1e-12);
  // Torques of two rods of 1 m and 1 kg about shoulder and elbow.
  const double elbow = 0.5 * GRAVITY * std::sin(0.4);
  EXPECT_NEAR(held.effort(0, held.model(0).findJoint("elbow")), elbow, 1e-9);
  EXPECT_NEAR(held.effort(0, held.model(0).findJoint("shoulder")), 1.5 * GRAVITY * std::sin(1.1) + elbow, 1e-9);
}

TEST(GravityCompensationTest, ItsWorkIsTheActuators)
{
  Scenario scene = hoist(1000.0);
  scene.bodies[0].gravity_compensation = true;
  scene.bodies[0].commands["lift"] = servo(Mode::POSITION, 0.3);
  Simulator simulator(scene);
  run(simulator, 2000);
  EXPECT_NEAR(simulator.position(0)[0], 0.3, 1e-12);
  EXPECT_NEAR(simulator.report().energy.actuators, 0.3 * WEIGHT, 1e-9);
  expectBalanced(simulator, 0.3 * WEIGHT);
}

TEST(GravityCompensationTest, AnEffortIsLeftAlone)
{
  Scenario scene = hoist(1000.0);
  scene.bodies[0].gravity_compensation = true;
  scene.bodies[0].commands["lift"] = servo(Mode::EFFORT, 5.0);
  Simulator simulator(scene);
  run(simulator, 100);
  EXPECT_NEAR(simulator.velocity(0)[0], 0.1 * (5.0 / MASS - GRAVITY), 1e-12);
}

TEST(GravityCompensationTest, AFollowersWeightIsCarriedByTheJointItFollows)
{
  Scenario scene;
  BodySpec body;
  body.name = "pulley";  // 1 kg hangs on `a`, 3 kg on `b`, which goes down twice as far as `a` goes up
  const std::string limit = "<limit lower='-10' upper='10' effort='1000' velocity='3'/>";
  body.urdf_xml = "<robot name='pulley'><link name='world'/>" + link("link_a", 1.0) + link("link_b", 3.0) +
                  slide("a", "link_a", limit) + slide("b", "link_b", limit + "<mimic joint='a' multiplier='-2'/>") +
                  "</robot>";
  body.hold_initial_position = true;
  body.gravity_compensation = true;
  scene.bodies.push_back(body);
  scene.stopping.tolerance = 1e-13;
  Simulator simulator(scene);
  run(simulator, 1000);
  const MultibodyModel& model = simulator.model(0);
  EXPECT_NEAR(simulator.position(0)[model.joints[model.findJoint("a")].q_index], 0.0, 1e-9);
  EXPECT_NEAR(simulator.effort(0, model.findJoint("a")), (1.0 - 2.0 * 3.0) * GRAVITY, 1e-6);
}

TEST(GravityCompensationTest, ALimbOfAFloatingBodyHoldsWithoutDroop)
{
  Scenario scene = groundScene(0.8);
  BodySpec& body = addBody(scene, "robot", "", poseAt(0.0, 0.0, 0.05));
  body.urdf_path = std::string(PROJECT_DIR) + "/examples/first_robot/first_robot.urdf";
  body.joints = {{"hinge", {0.9, 0.0}}};
  body.hold_initial_position = true;
  body.gravity_compensation = true;
  Simulator simulator(scene);
  run(simulator, 1000);
  EXPECT_NEAR(simulator.position(0)[7], 0.9, 1e-6);
  EXPECT_NEAR(simulator.effort(0, simulator.model(0).findJoint("hinge")), -0.5 * GRAVITY * 0.1 * std::sin(0.9), 1e-6);
}

TEST(GravityCompensationTest, StepsUnderTrajectoriesDoNotAllocate)
{
  Scenario scene = hoist(1000.0);
  BodySpec body;
  body.name = "arm";
  body.urdf_path = std::string(PROJECT_DIR) + "/urdf/double_pendulum.urdf";
  body.hold_initial_position = true;
  scene.bodies.push_back(body);
  for (BodySpec& spec : scene.bodies)
    spec.gravity_compensation = true;
  Simulator simulator(scene);
  JointTrajectory trajectory;
  trajectory.points.resize(1);
  trajectory.points[0].time = 1.0;
  trajectory.points[0].motion.position = 0.5;
  trajectory.points[0].order = 5;
  simulator.followTrajectory(0, simulator.model(0).findJoint("lift"), {}, 0.0, trajectory);
  simulator.followTrajectory(1, simulator.model(1).findJoint("elbow"), {}, 0.2, trajectory);
  for (int step = 0; step < 100; ++step)
    simulator.step();
  const test_support::AllocationCounter counter;
  for (int step = 0; step < 1000; ++step)
    simulator.step();
  EXPECT_EQ(counter.count(), 0);
  EXPECT_NEAR(simulator.position(0)[0], 0.5, 1e-3);
}

}  // namespace frictional_contact_sim
