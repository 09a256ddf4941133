// Joints: limits, damping, dry friction, servos and their effort limits, mimic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
/** A slider of mass 2 kg along x on a fixed base, with the given joint elements; no collision shapes. */
std::string sliderUrdf(const std::string& elements)
{
  return "<robot name='slider'><link name='world'/><link name='carriage'><inertial><mass value='2'/>"
         "<inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>"
         "<joint name='rail' type='prismatic'><parent link='world'/><child link='carriage'/><axis xyz='1 0 0'/>" +
         elements + "</joint></robot>";
}

Scenario sliderScene(const std::string& elements)
{
  Scenario scene = groundScene(0.5);
  scene.ground.reset();
  BodySpec body;
  body.name = "slider";
  body.urdf_xml = sliderUrdf(elements);
  scene.bodies.push_back(body);
  return scene;
}

const char* const WIDE = "<limit lower='-10' upper='10' effort='1000' velocity='100'/>";
constexpr double MASS = 2.0;

JointCommand effort(double value)
{
  JointCommand command;
  command.target = value;
  return command;
}

JointCommand servo(double target, double kp, double kd)
{
  JointCommand command;
  command.mode = JointCommand::Mode::POSITION;
  command.target = target;
  command.kp = kp;
  command.kd = kd;
  return command;
}

TEST(EffortTest, AcceleratesTheSliderExactly)
{
  Scenario scene = sliderScene(WIDE);
  scene.bodies[0].commands["rail"] = effort(3.0);
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 1000; ++i)
    simulator.step();
  EXPECT_NEAR(simulator.velocity(0)[0], 3.0 / MASS, 1e-12);
  EXPECT_NEAR(simulator.position(0)[0], 0.5 * 3.0 / MASS, 1e-12);  // the midpoint rule is exact for constant force
  EXPECT_EQ(simulator.effort(0, 1), 3.0);
}

TEST(EffortTest, IsCutAtTheLimitOfTheUrdf)
{
  Scenario scene = sliderScene("<limit lower='-10' upper='10' effort='5' velocity='100'/>");
  scene.bodies[0].commands["rail"] = effort(-80.0);
  AuditedSimulator simulator(scene);
  simulator.step();
  EXPECT_EQ(simulator.effort(0, 1), -5.0);
  EXPECT_NEAR(simulator.velocity(0)[0], -5.0 / MASS * 1e-3, 1e-15);
}

/** Largest error of an undamped spring oscillation against the cosine over one second. */
double springError(double h)
{
  Scenario scene = sliderScene(WIDE);
  scene.time_step = h;
  scene.bodies[0].joints["rail"].position = 0.1;
  scene.bodies[0].commands["rail"] = servo(0.0, 200.0, 0.0);
  AuditedSimulator simulator(scene);
  double error = 0.0;
  while (simulator.time() < 1.0)
  {
    simulator.step();
    error = std::max(error, std::abs(simulator.position(0)[0] - 0.1 * std::cos(10.0 * simulator.time())));
  }
  return error;
}

TEST(ServoTest, SpringIsSecondOrder)
{
  const double coarse = springError(2e-3);
  const double fine = springError(1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.2);
  EXPECT_LT(fine, 1e-4 * 0.1);
}

TEST(ServoTest, AnyStiffnessIsStable)
{
  // dt sqrt(kp/m) = 700, far beyond what the step resolves.
  Scenario scene = sliderScene("<limit lower='-10' upper='10' effort='1e12' velocity='100'/>");
  scene.bodies[0].joints["rail"].position = 0.1;
  scene.bodies[0].commands["rail"] = servo(0.0, 1e12, 1e5);
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 2000; ++i)
    simulator.step();
  EXPECT_LE(std::abs(simulator.position(0)[0]), 0.1 * (1.0 + 1e-9));
}

TEST(ServoTest, HoldsItsTargetUnderDefaultGains)
{
  Scenario scene = sliderScene(WIDE);
  JointCommand command;
  command.mode = JointCommand::Mode::POSITION;
  command.target = 0.3;
  scene.bodies[0].commands["rail"] = command;
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 1000; ++i)
    simulator.step();
  EXPECT_NEAR(simulator.position(0)[0], 0.3, 1e-9);
}

TEST(ServoTest, AtItsEffortLimitIsAConstantForce)
{
  Scenario scene = sliderScene("<limit lower='-10' upper='10' effort='4' velocity='100'/>");
  scene.bodies[0].commands["rail"] = servo(5.0, 1000.0, 1.0);
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 500; ++i)
  {
    simulator.step();
    ASSERT_NEAR(simulator.effort(0, 1), 4.0, 1e-10);
  }
  EXPECT_NEAR(simulator.position(0)[0], 0.5 * 4.0 / MASS * 0.25, 1e-10);
}

TEST(ServoTest, LeavesItsEffortLimitAgain)
{
  Scenario scene = sliderScene("<limit lower='-10' upper='10' effort='4' velocity='100'/>");
  scene.bodies[0].commands["rail"] = servo(0.2, 200.0, 40.0);
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 4000; ++i)
  {
    simulator.step();
    ASSERT_LE(std::abs(simulator.effort(0, 1)), 4.0 + 1e-9);
    ASSERT_EQ(simulator.report().status, SolverStatus::CONVERGED);
  }
  EXPECT_NEAR(simulator.position(0)[0], 0.2, 1e-9);
  EXPECT_NEAR(simulator.effort(0, 1), 0.0, 1e-6);
}

TEST(JointLimitTest, StopsTheSliderAndHoldsIt)
{
  Scenario scene = sliderScene("<limit lower='-0.2' upper='0.1' effort='1000' velocity='100'/>");
  scene.bodies[0].commands["rail"] = effort(6.0);
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 1000; ++i)
  {
    simulator.step();
    ASSERT_LE(simulator.position(0)[0], 0.1 + 1e-12);
  }
  EXPECT_NEAR(simulator.position(0)[0], 0.1, 1e-12);
  EXPECT_NEAR(simulator.velocity(0)[0], 0.0, 1e-12);
}

TEST(JointDampingTest, SlowsTheSliderExponentially)
{
  // Damping at the end of the step: v_k+1 = v_k / (1 + dt d/m), first order in dt.
  Scenario scene = sliderScene(std::string(WIDE) + "<dynamics damping='0.5'/>");
  scene.bodies[0].joints["rail"].velocity = 1.0;
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 1000; ++i)
    simulator.step();
  EXPECT_NEAR(simulator.velocity(0)[0], std::pow(1.0 + 1e-3 * 0.5 / MASS, -1000.0), 1e-12);
}

TEST(JointDryFrictionTest, HoldsBelowItsThresholdAndMovesAbove)
{
  for (const double factor : {1.0 - 1e-6, 1.0 + 1e-6})
  {
    Scenario scene = sliderScene(std::string(WIDE) + "<dynamics friction='1.5'/>");
    scene.bodies[0].commands["rail"] = effort(1.5 * factor);
    AuditedSimulator simulator(scene);
    for (int i = 0; i < 1000; ++i)
      simulator.step();
    if (factor < 1.0)
      EXPECT_EQ(simulator.position(0)[0], 0.0);
    else
      EXPECT_NEAR(simulator.velocity(0)[0], 1.5e-6 / MASS, 1e-10);
  }
}

TEST(JointDryFrictionTest, OscillatorLosesTwiceTheDeadBandPerHalfCycle)
{
  const double stiffness = 200.0;
  const double threshold = 1.5;
  Scenario scene = sliderScene(std::string(WIDE) + "<dynamics friction='1.5'/>");
  scene.time_step = 1e-4;
  scene.bodies[0].joints["rail"].position = 0.1;
  scene.bodies[0].commands["rail"] = servo(0.0, stiffness, 0.0);
  AuditedSimulator simulator(scene);
  double lowest = 0.1;
  for (int i = 0; i < 4000; ++i)
  {
    simulator.step();
    lowest = std::min(lowest, simulator.position(0)[0]);
  }
  // The turning point is caught within one step: v h at most, v = a h there; and the spring's own order-2 error.
  EXPECT_NEAR(lowest, -(0.1 - 2.0 * threshold / stiffness), 1e-6);
}

TEST(MimicTest, FollowerKeepsItsRatioUnderLoad)
{
  const std::string urdf =
      "<robot name='hand'><link name='world'/>"
      "<link name='a'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
      "izz='1'/></inertial></link>"
      "<link name='b'><inertial><mass value='3'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
      "izz='1'/></inertial></link>"
      "<joint name='ja' type='prismatic'><parent link='world'/><child link='a'/><axis xyz='1 0 0'/>"
      "<limit lower='-10' upper='10' effort='1000' velocity='100'/></joint>"
      "<joint name='jb' type='prismatic'><parent link='world'/><child link='b'/><axis xyz='0 1 0'/>"
      "<limit lower='-10' upper='10' effort='1000' velocity='100'/><mimic joint='ja' multiplier='-2' "
      "offset='0.1'/></joint></robot>";
  Scenario scene = groundScene(0.5);
  scene.ground.reset();
  BodySpec body;
  body.name = "hand";
  body.urdf_xml = urdf;
  body.commands["ja"] = effort(2.6);
  scene.bodies.push_back(body);
  AuditedSimulator simulator(scene);
  for (int i = 0; i < 1000; ++i)
    simulator.step();
  // Effective mass of the pair: 1 + 3 * 2^2 = 13 kg.
  EXPECT_NEAR(simulator.velocity(0)[0], 2.6 / 13.0, 1e-12);
  EXPECT_NEAR(simulator.position(0)[1], -2.0 * simulator.position(0)[0] + 0.1, 1e-12);
  EXPECT_LT(simulator.report().bilateral_violation, 1e-12);
}
/** Four joints in a chain of mimics, in every order of the file: all start on the constraint, whatever comes first. */
TEST(MimicTest, ChainsStartClosedWhateverTheOrderInTheFile)
{
  // a = 0.5 given; b = 2 a + 0.1, c = -b + 0.2, d = 0.5 c
  const std::vector<std::string> mimics = {"", "<mimic joint='a' multiplier='2' offset='0.1'/>",
                                           "<mimic joint='b' multiplier='-1' offset='0.2'/>",
                                           "<mimic joint='c' multiplier='0.5'/>"};
  const std::string names = "abcd";
  const double expected[4] = {0.5, 1.1, -0.9, -0.45};
  std::vector<int> order = {0, 1, 2, 3};
  do
  {
    std::string urdf = "<robot name='fan'><link name='world'/>";
    for (const int j : order)
    {
      const std::string name(1, names[j]);
      urdf += "<link name='link_" + name +
              "'><inertial><mass value='1'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>"
              "</link><joint name='" +
              name + "' type='continuous'><parent link='world'/><child link='link_" + name + "'/><axis xyz='0 0 1'/>" +
              mimics[j] + "</joint>";
    }
    Scenario scene = groundScene(0.5);
    scene.ground.reset();
    scene.bodies.emplace_back();
    scene.bodies[0].name = "fan";
    scene.bodies[0].urdf_xml = urdf + "</robot>";
    scene.bodies[0].joints["a"] = {0.5, 0.3};
    AuditedSimulator simulator(scene);
    const double rates[4] = {0.3, 0.6, -0.6, -0.3};
    for (int j = 0; j < 4; ++j)
    {
      const Joint& joint = simulator.model(0).joints[simulator.model(0).findJoint(std::string(1, names[j]))];
      EXPECT_NEAR(simulator.position(0)[joint.q_index], expected[j], 1e-15);
      EXPECT_NEAR(simulator.velocity(0)[joint.v_index], rates[j], 1e-14);
    }
    for (int i = 0; i < 100; ++i)
      simulator.step();
    EXPECT_LT(simulator.report().bilateral_violation, 1e-12);
  } while (std::next_permutation(order.begin(), order.end()));
}
}  // namespace
}  // namespace frictional_contact_sim
