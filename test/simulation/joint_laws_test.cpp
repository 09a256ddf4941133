// Joints against closed forms: thresholds of dry friction, decay, stops of any inertia, damping of any size.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::AuditedSimulator;
using test_support::Dice;
using test_support::text;

/** A hinge about y with the given moment about it [kg m^2] and joint elements; its link has no weight's arm. */
Scenario wheelScene(double inertia, const std::string& elements)
{
  const std::string moment = text(inertia);
  Scenario scenario = emptySpace();
  BodySpec& body =
      addBody(scenario, "wheel",
              "<robot name='wheel'><link name='world'/><link name='rim'><inertial><mass value='" + text(inertia) +
                  "'/><inertia ixx='" + moment + "' ixy='0' ixz='0' iyy='" + moment + "' iyz='0' izz='" + moment +
                  "'/></inertial></link><joint name='axle' type='revolute'><parent link='world'/><child link='rim'/>"
                  "<axis xyz='0 1 0'/>" +
                  elements + "</joint></robot>",
              poseAt(0.0, 0.0, 0.0));
  body.base = BaseType::FIXED;
  return scenario;
}

const char* const WIDE = "<limit lower='-1e3' upper='1e3' effort='1e4' velocity='1e4'/>";

TEST(JointDryFrictionTest, AWheelWithDampingStopsWhenTheFormulaSaysAndStays)
{
  // omega = (omega_0 + tau_f/d) exp(-d t/I) - tau_f/d, zero at I/d log(1 + d omega_0/tau_f) = 0.80472 s.
  const double inertia = 0.01, damping = 0.02, friction = 0.05, start = 10.0;
  const double expected = inertia / damping * std::log(1.0 + damping * start / friction);
  double error[2];
  for (const int halves : {0, 1})
  {
    Scenario scenario = wheelScene(inertia, std::string(WIDE) + "<dynamics damping='0.02' friction='0.05'/>");
    scenario.time_step = 1e-3 / (1 << halves);
    scenario.bodies[0].joints["axle"].velocity = start;
    AuditedSimulator simulator(scenario);
    double stopped = 0.0;
    while (simulator.time() < 1.0)
    {
      simulator.step();
      if (simulator.velocity(0)[0] != 0.0)
        stopped = simulator.time();
      const double exact = std::max(
          0.0, (start + friction / damping) * std::exp(-damping / inertia * simulator.time()) - friction / damping);
      ASSERT_NEAR(simulator.velocity(0)[0], exact, 20.0 * scenario.time_step);  // first order: damping at the end
    }
    error[halves] = std::abs(stopped - expected);
    EXPECT_EQ(simulator.velocity(0)[0], 0.0);
    EXPECT_NEAR(simulator.report().energy.joints, 0.5 * inertia * start * start, 1e-12);
  }
  EXPECT_NEAR(expected, 0.80472, 1e-5);
  EXPECT_LT(error[0], 2e-3);
  EXPECT_LT(error[1], 1e-3);
}

/** True when an arm held up by the friction of its joint moves under gravity. */
bool armMoves(double friction, double angle)
{
  Scenario scenario = groundScene(0.5);
  scenario.ground.reset();
  BodySpec& arm = addBody(scenario, "arm",
                          "<robot name='arm'><link name='world'/><link name='rod'><inertial><origin xyz='0.3 0 0'/>"
                          "<mass value='2'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.05' iyz='0' izz='0.05'/>"
                          "</inertial></link><joint name='shoulder' type='revolute'><parent link='world'/>"
                          "<child link='rod'/><axis xyz='0 1 0'/>" +
                              std::string(WIDE) + "<dynamics friction='" + text(friction) + "'/></joint></robot>",
                          poseAt(0.0, 0.0, 1.0));
  arm.base = BaseType::FIXED;
  arm.joints["shoulder"].position = angle;
  Simulator simulator(scenario);
  for (int step = 0; step < 200; ++step)
    simulator.step();
  const double moved = simulator.position(0)[0] - angle;
  EXPECT_TRUE(std::abs(moved) < 1e-14 || std::abs(moved) > 1e-9) << moved;  // at rest to round-off, or it falls
  return std::abs(moved) > 1e-9;
}

TEST(JointDryFrictionTest, AnArmHoldsBelowTheMomentOfItsWeightAndMovesAbove)
{
  // tau_c = m g l cos(angle); the bracket of a bisection on the friction closes on it.
  for (const double angle : {0.0, 0.7, -1.2})
  {
    const double moment = 2.0 * GRAVITY * 0.3 * std::cos(angle);
    double holds = 2.0 * moment;
    double moves = 0.5 * moment;
    ASSERT_TRUE(armMoves(moves, angle));
    ASSERT_FALSE(armMoves(holds, angle));
    while (holds - moves > 2e-7 * moment)
      (armMoves(0.5 * (holds + moves), angle) ? moves : holds) = 0.5 * (holds + moves);
    EXPECT_NEAR(holds, moment, 1e-6 * moment) << angle;
    EXPECT_NEAR(moves, moment, 1e-6 * moment) << angle;
  }
}

TEST(JointDryFrictionTest, AnOscillatorLosesTwoDeadBandsEveryHalfCycleUntilItSticks)
{
  // Turning points |x_n| = x_0 - 2 n d, d = threshold/k = 7.5 mm; it sticks at the first one within the dead band.
  const double dead = 1.5 / 200.0;
  const double start = 0.1;
  double errors[2];
  for (const int halves : {0, 1})
  {
    Scenario scenario = railScene(10.0, 100.0);
    const std::string limit = "velocity='100'/>";
    std::string& urdf = scenario.bodies[0].urdf_xml;
    urdf.insert(urdf.find(limit) + limit.size(), "<dynamics friction='1.5'/>");
    scenario.time_step = 1e-3 / (1 << halves);
    scenario.bodies[0].joints["rail"].position = start;
    scenario.bodies[0].springs["rail"] = {200.0, 0.0, 0.0};
    AuditedSimulator simulator(scenario);
    double last = simulator.position(0)[0];
    double rate = 0.0;
    int turns = 0;
    double worst = 0.0;
    while (simulator.time() < 3.0)
    {
      ASSERT_TRUE(simulator.step().converged());
      const double now = simulator.position(0)[0];
      if (rate * (now - last) < 0.0)
        worst = std::max(worst, std::abs(std::abs(last) - (start - 2.0 * dead * ++turns)));
      rate = now - last == 0.0 ? rate : now - last;
      last = now;
    }
    EXPECT_EQ(turns, 6);  // the seventh, at 5 mm, is within 7.5 mm: it stays there
    EXPECT_LT(std::abs(simulator.velocity(0)[0]), 1e-15);
    worst = std::max(worst, std::abs(std::abs(last) - (14.0 * dead - start)));
    errors[halves] = worst;
    EXPECT_NEAR(simulator.report().energy.joints, 0.5 * 200.0 * (start * start - last * last), 1e-9);
  }
  EXPECT_LT(errors[0], 1e-6);
  EXPECT_LT(errors[1], 0.5 * errors[0]);
}

TEST(JointDampingTest, AChainDecaysMonotonelyForAnyDamping)
{
  // Links of 0.1 kg and 0.01 kg m^2, step 2 ms: explicit damping is unstable above 2 I/h = 10 N m s.
  for (const double damping : {0.1, 10.0, 1e3, 1e6})
  {
    std::string urdf = "<robot name='chain'><link name='world'/>";
    for (int i = 0; i < 6; ++i)
    {
      const std::string name = "link_" + std::to_string(i);
      urdf += "<link name='" + name +
              "'><inertial><origin xyz='0 0 -0.1'/><mass value='0.1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' "
              "iyz='0' izz='0.01'/></inertial></link><joint name='joint_" +
              std::to_string(i) + "' type='continuous'><parent link='" +
              (i == 0 ? std::string("world") : "link_" + std::to_string(i - 1)) + "'/><child link='" + name +
              "'/><origin xyz='0 0 " + (i == 0 ? "0" : "-0.2") + "'/><axis xyz='" + (i % 2 == 0 ? "1 0 0" : "0 1 0") +
              "'/><dynamics damping='" + text(damping) + "'/></joint>";
    }
    Scenario scenario = emptySpace();
    scenario.time_step = 2e-3;
    BodySpec& chain = addBody(scenario, "chain", urdf + "</robot>", poseAt(0.0, 0.0, 0.0));
    chain.base = BaseType::FIXED;
    for (int i = 0; i < 6; ++i)
      chain.joints["joint_" + std::to_string(i)] = {0.1 * i - 0.2, i % 3 == 0 ? 2.0 : -1.0};
    AuditedSimulator simulator(scenario);
    double energy = simulator.report().energy.kinetic;
    const double start = energy;
    for (int step = 0; step < 1000; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << damping << ": " << simulator.outcome().message;
      ASSERT_LE(simulator.report().energy.kinetic, energy * (1.0 + 1e-12)) << damping << " step " << step;
      energy = simulator.report().energy.kinetic;
    }
    EXPECT_LT(energy, (damping < 1.0 ? 0.5 : 1e-6) * start) << damping;
  }
}

TEST(JointLimitTest, StopsAnyInertiaWithoutOvershoot)
{
  // A limit is a unilateral row: the same code path from 1e-6 to 1e2 kg m^2, no gains to fit.
  for (double inertia = 1e-6; inertia < 200.0; inertia *= 10.0)
    for (const double push : {0.0, 1.0})
    {
      Scenario scenario = wheelScene(inertia, "<limit lower='-0.5' upper='0.5' effort='1e4' velocity='1e4'/>");
      scenario.bodies[0].joints["axle"].velocity = 3.0;
      JointCommand command;
      command.target = push * 20.0 * inertia;
      scenario.bodies[0].commands["axle"] = command;
      AuditedSimulator simulator(scenario);
      double highest = 0.0;
      for (int step = 0; step < 400; ++step)
      {
        ASSERT_TRUE(simulator.step().converged()) << inertia << ": " << simulator.outcome().message;
        highest = std::max(highest, simulator.position(0)[0]);
      }
      EXPECT_LT(highest, 0.5 + 1e-10) << inertia;
      EXPECT_NEAR(simulator.position(0)[0], 0.5, 1e-10) << inertia;
      EXPECT_NEAR(simulator.velocity(0)[0], 0.0, 1e-10) << inertia;
    }
}

TEST(JointLimitTest, AnImpactAtTheStartReachesASecondLimitThatWasAtRest)
{
  // A slider at its end stop, moving into it, carries a second one 0.1 mm before its own: the first stops at once, the
  // second goes on and may be at its limit in the middle of the first step, not beyond.
  const std::string link =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
  const double gap = 1e-4;
  Scenario scenario = emptySpace();
  BodySpec sliders;
  sliders.name = "sliders";
  sliders.base = BaseType::FIXED;
  sliders.urdf_xml =
      "<robot name='sliders'><link name='base'/><link name='a'>" + link + "</link><link name='b'>" + link +
      "</link><joint name='first' type='prismatic'><parent link='base'/><child link='a'/><axis xyz='1 0 0'/>"
      "<limit lower='-1' upper='1' effort='0' velocity='10'/></joint>"
      "<joint name='second' type='prismatic'><parent link='a'/><child link='b'/><axis xyz='1 0 0'/>"
      "<limit lower='-1' upper='1' effort='0' velocity='10'/></joint></robot>";
  sliders.joints["first"].position = 1.0;
  sliders.joints["first"].velocity = 1.0;
  sliders.joints["second"].position = 1.0 - gap;
  scenario.bodies.push_back(sliders);
  AuditedSimulator simulator(scenario);
  ASSERT_TRUE(simulator.outcome().converged()) << simulator.outcome().message;
  EXPECT_NEAR(simulator.velocity(0)[0], 0.0, 1e-12);
  EXPECT_NEAR(simulator.velocity(0)[1], 2.0 * gap / scenario.time_step, 1e-9);
  for (int step = 0; step < 10; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    EXPECT_LT(simulator.position(0)[1], 1.0 + 1e-9);
  }
}

}  // namespace
}  // namespace frictional_contact_sim
