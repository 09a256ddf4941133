// What users of other simulators complained of, with the values that are right; the threads are named.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "linkage.h"
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

/** google-deepmind/mujoco#2472: two hinged capsules, a motor on each, until they meet: it diverged at this step. */
TEST(PeerComplaintTest, MotorsThatPressTwoCapsulesTogetherPutInNoMoreThanTheirWork)
{
  const auto link = [](const std::string& name)
  {
    return "<link name='" + name +
           "'><inertial><origin xyz='0 0 0.2'/><mass value='0.5'/><inertia ixx='0.007' ixy='0' ixz='0' iyy='0.007' "
           "iyz='0' izz='0.0005'/></inertial><collision><origin xyz='0 0 0.2'/><geometry><capsule radius='0.04' "
           "length='0.3'/></geometry></collision></link>";
  };
  const auto joint = [](const std::string& name, const std::string& child, double x, double sign)
  {
    return "<joint name='" + name + "' type='continuous'><parent link='world'/><child link='" + child +
           "'/><origin xyz='" + text(x) + " 0 0'/><axis xyz='0 " + text(sign) + " 0'/></joint>";
  };
  for (const double friction : {0.0, 1.0})
  {
    Scenario scenario = emptySpace();
    scenario.materials.fallback.friction = friction;
    scenario.stopping.tolerance = 1e-10;
    BodySpec& body = addBody(scenario, "pair",
                             "<robot name='pair'><link name='world'/>" + link("one") + link("two") +
                                 joint("first", "one", -0.15, 1.0) + joint("second", "two", 0.2, -1.0) + "</robot>",
                             poseAt(0.0, 0.0, 0.0));
    body.base = BaseType::FIXED;
    JointCommand motor;
    motor.target = 1.0;
    body.commands["first"] = motor;
    body.commands["second"] = motor;
    AuditedSimulator simulator(scenario);
    simulator.waive("self-stress");  // it does not count what motors press with
    double deepest = 0.0;
    double most = 0.0;
    bool has_met = false;
    for (int step = 0; step < 2000; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      const EnergyLedger& energy = simulator.report().energy;
      ASSERT_LE(energy.kinetic, energy.actuators * (1.0 + 1e-3) + 1e-9) << step;  // order 2 of a turning tree
      most = std::max(most, energy.kinetic);
      deepest = std::max(deepest, simulator.report().max_penetration);
      has_met = has_met || !simulator.contacts().empty();
    }
    EXPECT_TRUE(has_met);
    EXPECT_GT(most, 0.1);
    EXPECT_LT(deepest, 1e-8);
    EXPECT_LT(simulator.report().energy.kinetic, 1e-12);  // they press, and rest
  }
}

/** RobotLocomotion/drake#18241: a box thrown at a box, without gravity, gained energy at 0.5 ms and exploded at 1 ms.
 */
TEST(PeerComplaintTest, ABoxThrownAtABoxLosesEnergyAndNoMomentum)
{
  Dice dice(18241);
  for (int trial = 0; trial < 20; ++trial)
  {
    Scenario scenario = emptySpace();
    scenario.time_step = trial % 2 == 0 ? 1e-3 : 5e-4;
    scenario.materials.fallback.friction = dice.uniform(0.0, 1.0);
    const double mass = dice.logUniform(0.1, 10.0);
    addBody(scenario, "still", boxUrdf({0.2, 0.3, 0.25}, 1.0), poseAt(0.0, 0.0, 0.0));
    BodySpec& thrown = addBody(scenario, "thrown", boxUrdf({0.1, 0.2, 0.15}, mass), poseAt(-0.5, 0.0, 0.0));
    const double turn = dice.uniform(0.0, 3.0);
    thrown.pose->linear() = Eigen::AngleAxisd(turn, dice.vector(1.0).normalized()).toRotationMatrix();
    thrown.pose->translation() += dice.vector(0.05);
    thrown.linear_velocity = Eigen::Vector3d(2.0, 0.0, 0.0) + dice.vector(0.3);
    thrown.angular_velocity = dice.vector(5.0);
    AuditedSimulator simulator(scenario);
    const auto momenta = [&]
    {
      Vector6d sum = Vector6d::Zero();
      for (int body = 0; body < 2; ++body)
      {
        const double m = simulator.model(body).totalMass();
        const Eigen::Matrix3d turned = simulator.data(body).link_pose[0].linear();
        const Eigen::Vector3d velocity = simulator.velocity(body).head<3>();
        const Eigen::Vector3d spin = simulator.velocity(body).tail<3>();
        const Eigen::Vector3d size = body == 0 ? Eigen::Vector3d(0.2, 0.3, 0.25) : Eigen::Vector3d(0.1, 0.2, 0.15);
        const Eigen::Vector3d squares = size.cwiseAbs2();
        const Eigen::Vector3d moments =
            m / 12.0 * Eigen::Vector3d(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y());
        const Eigen::Vector3d place = simulator.data(body).link_pose[0].translation();
        sum.head<3>() += m * velocity;
        sum.tail<3>() += m * place.cross(velocity) + turned * moments.cwiseProduct(turned.transpose() * spin);
      }
      return sum;
    };
    const Vector6d start = momenta();
    double energy = simulator.report().energy.kinetic;
    const double first = energy;
    for (int step = 0; step < 600; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      ASSERT_LE(simulator.report().energy.kinetic, energy * (1.0 + 1e-12)) << "trial " << trial << " step " << step;
      energy = simulator.report().energy.kinetic;
    }
    EXPECT_LT(energy, 0.999 * first) << "trial " << trial;  // it has hit
    EXPECT_LT((momenta() - start).head<3>().norm(), 1e-12 * start.norm());
    // The impact acts at the pose that the step's old spin leads to, not its mean: h times the change of spin.
    EXPECT_LT((momenta() - start).tail<3>().norm(), 0.05 * scenario.time_step * start.norm());
  }
}

/** drake#19599, newton#3489, IsaacLab#6885: a box at rest put on a belt of 0.5 m/s, friction 0.3. */
TEST(PeerComplaintTest, ABoxOnABeltSlipsForTheTimeAndPathOfCoulombsLaw)
{
  const double h = 1e-4;
  Scenario scenario = groundScene(0.3);
  scenario.ground.reset();
  scenario.time_step = h;
  scenario.stopping.tolerance = 1e-11;  // of g h: what 64 eps of the belt's speed is
  BodySpec& belt = addBody(scenario, "belt", boxUrdf({4.0, 1.0, 0.1}, 50.0), poseAt(0.0, 0.0, -0.05));
  belt.base = BaseType::FIXED;
  belt.surface_velocity["body"].linear = {0.5, 0.0, 0.0};
  addBody(scenario, "box", boxUrdf({0.2, 0.2, 0.1}, 2.0), poseAt(0.0, 0.0, 0.05));
  AuditedSimulator simulator(scenario);
  double slipped = 0.0;
  for (int step = 0; step < 2500; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    if (std::abs(simulator.velocity(1)[0] - 0.5) > 1e-9)
      slipped = simulator.time();
  }
  EXPECT_NEAR(slipped, 0.16990, h);
  EXPECT_NEAR(0.5 * simulator.time() - simulator.position(1)[0], 0.042474, 1e-6);
  EXPECT_NEAR(simulator.velocity(1)[0], 0.5, 1e-10);
}

/** google-deepmind/mujoco#2698, #2172: an arm of 283 kg held by a strut that a loop joins to it, step 0.5 ms. */
TEST(PeerComplaintTest, ALoopThatHoldsAHeavyArmStaysClosed)
{
  for (const double strut : {10.0, 283e-6})
  {
    const std::string urdf =
        "<robot name='crane'><link name='world'/>" + rodLink("arm", 2.0, 283.0) + rodLink("tube", 0.5, strut) +
        rodLink("piston", 0.5, strut) + hinge("shoulder", "world", "arm", 0.0) +
        "<joint name='foot' type='continuous'><parent link='world'/><child link='tube'/><origin xyz='0.6 0 -0.8'/>"
        "<axis xyz='0 1 0'/></joint><joint name='cylinder' type='prismatic'><parent link='tube'/><child "
        "link='piston'/><axis xyz='1 0 0'/><limit lower='0' upper='1.2' effort='1e5' velocity='1'/></joint>"
        "<loop_joint name='pin' type='point'><link1 link='arm'/><link2 link='piston'/><origin1 xyz='0.8 0 0'/>"
        "<origin2 xyz='0.5 0 0'/></loop_joint></robot>";
    Scenario scenario = groundScene(0.5);
    scenario.ground.reset();
    scenario.time_step = 5e-4;
    scenario.stopping.tolerance = 1e-10;
    BodySpec& crane = addBody(scenario, "crane", urdf, poseAt(0.0, 0.0, 1.0));
    crane.base = BaseType::FIXED;
    crane.joints["shoulder"].position = 0.0;
    crane.joints["foot"].position = -1.3;
    JointCommand hydraulics;
    hydraulics.mode = JointCommand::Mode::VELOCITY;
    hydraulics.target = 0.01;
    hydraulics.kd = 1e7;
    crane.commands["cylinder"] = hydraulics;
    Simulator simulator(scenario);
    const int cylinder = simulator.model(0).findJoint("cylinder");
    const int steps = strut > 1.0 ? 100000 : 20000;
    const double start = simulator.position(0)[0];
    double worst = 0.0;
    for (int step = 0; step < steps; ++step)
    {
      if (step == steps / 2)
      {
        hydraulics.target = 0.0;
        simulator.setCommand(0, cylinder, hydraulics);
      }
      ASSERT_TRUE(simulator.step().converged()) << strut << " step " << step << " " << simulator.outcome().message;
      if (step > 0)
        worst = std::max(worst, simulator.report().bilateral_violation);
    }
    EXPECT_LT(worst, 1e-10) << strut;
    EXPECT_LT(openness(simulator, simulator.loops()[0]), 1e-10) << strut;
    EXPECT_GT(std::abs(simulator.position(0)[0] - start), 0.02) << strut;
    // What the pin carries holds the arm: moment of 283 kg at 1 m.
    const Vector6d pin = simulator.loopWrench(0);
    const double angle = simulator.position(0)[0];
    const double moment = 0.8 * std::cos(angle) * pin[2] + 0.8 * std::sin(angle) * pin[0];
    EXPECT_NEAR(std::abs(moment), 283.0 * GRAVITY * std::cos(angle), 1e-2 * 283.0 * GRAVITY) << strut;
  }
}

}  // namespace
}  // namespace frictional_contact_sim
