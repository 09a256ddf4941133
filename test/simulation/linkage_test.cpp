// Mechanisms of the literature and of workshops, over long times and under contact: four-bar, delta robot, slider-crank
// with clearance, mimic gripper.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

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
using test_support::text;

TEST(FourBarTest, ClosureAndEnergyStayOverAHundredSeconds)
{
  // 1e5 steps. The tenth part of the run that comes last is not more open than the first: nothing grows.
  const FourBar bar;
  Scenario scenario = fourBarScene(bar, "point", 0.8);
  scenario.gravity.setZero();
  scenario.bodies[0].joints["drive"].velocity = -2.0;
  scenario.stopping.tolerance = 1e-10;
  Simulator simulator(scenario);
  const double energy = energyOf(simulator);
  double worst[10] = {};
  double fastest = 0.0;
  double lowest = energy;
  double highest = energy;
  for (int step = 0; step < 100000; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    fastest = std::max(fastest, simulator.velocity(0).cwiseAbs().maxCoeff() * bar.coupler);
    double& part = worst[step / 10000];
    part = std::max(part, openness(simulator, simulator.loops()[0]));
    lowest = std::min(lowest, energyOf(simulator));
    highest = std::max(highest, energyOf(simulator));
  }
  const double bound = 2.0 * 1e-6 * fastest * fastest / bar.rocker;
  for (const double part : worst)
    EXPECT_LE(part, bound);
  EXPECT_LE(worst[9], 1.05 * worst[0]);
  EXPECT_GT(lowest, (1.0 - 1e-4) * energy);
  EXPECT_LT(highest, (1.0 + 1e-4) * energy);
}

/** Delta robot (Clavel 1988): three driven arms, three parallelograms of free rods, a platform that does not turn. */
struct Delta
{
  double base = 0.2, platform = 0.08, arm = 0.3, rod = 0.6, spread = 0.06, height = 1.0;  // [m]

  Eigen::Vector3d out(int i) const { return {std::cos(angle(i)), std::sin(angle(i)), 0.0}; }
  Eigen::Vector3d aside(int i) const { return {-std::sin(angle(i)), std::cos(angle(i)), 0.0}; }
  Eigen::Vector3d elbow(int i, double theta) const
  {
    return (base + arm * std::cos(theta)) * out(i) + (height - arm * std::sin(theta)) * Eigen::Vector3d::UnitZ();
  }
  /** Height of the platform where all arms stand at one angle. */
  double platformHeight(double theta) const
  {
    const double across = base + arm * std::cos(theta) - platform;
    return height - arm * std::sin(theta) - std::sqrt(rod * rod - across * across);
  }
  static double angle(int i) { return 2.0 * M_PI * i / 3.0; }
};

std::string deltaArms(const Delta& delta)
{
  std::string urdf = "<robot name='arms'><link name='world'/>";
  for (int i = 0; i < 3; ++i)
  {
    const std::string name = "arm_" + std::to_string(i);
    urdf += rodLink(name, delta.arm, 0.4) + "<joint name='drive_" + std::to_string(i) +
            "' type='continuous'><parent link='world'/><child link='" + name + "'/><origin xyz='" +
            text(Eigen::Vector3d(delta.base * delta.out(i) + delta.height * Eigen::Vector3d::UnitZ())) + "' rpy='0 0 " +
            text(Delta::angle(i)) + "'/><axis xyz='0 1 0'/></joint>";
  }
  return urdf + "</robot>";
}

Scenario deltaScene(const Delta& delta, double theta)
{
  Scenario scenario = emptySpace();
  scenario.stopping.tolerance = 1e-10;
  BodySpec& arms = addBody(scenario, "arms", deltaArms(delta), poseAt(0.0, 0.0, 0.0));
  arms.base = BaseType::FIXED;
  for (int i = 0; i < 3; ++i)
    arms.joints["drive_" + std::to_string(i)].position = theta;
  const Eigen::Vector3d centre(0.0, 0.0, delta.platformHeight(theta));
  addBody(scenario, "platform", sphereUrdf(0.05, 0.5), poseAt(0.0, 0.0, centre.z()));
  for (int i = 0; i < 3; ++i)
    for (const double side : {-1.0, 1.0})
    {
      const std::string name = "rod_" + std::to_string(i) + (side < 0.0 ? "a" : "b");
      const Eigen::Vector3d shift = side * delta.spread * delta.aside(i);
      const Eigen::Vector3d along = centre + delta.platform * delta.out(i) - delta.elbow(i, theta);
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = delta.elbow(i, theta) + shift;
      pose.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), along).toRotationMatrix();
      addBody(scenario, name, "<robot name='rod'>" + rodLink("rod", delta.rod, 0.1) + "</robot>", pose);
      LoopSpec upper{name + "_top", LoopType::POINT, {name, "rod"}, {"arms", "arm_" + std::to_string(i)}, ""};
      upper.b.placement.translation() = Eigen::Vector3d(delta.arm, side * delta.spread, 0.0);
      LoopSpec lower{name + "_end", LoopType::POINT, {name, "rod"}, {"platform", "body"}, ""};
      lower.a.placement.translation() = Eigen::Vector3d(delta.rod, 0.0, 0.0);
      lower.b.placement.translation() = delta.platform * delta.out(i) + shift;
      scenario.loops.insert(scenario.loops.end(), {upper, lower});
    }
  return scenario;
}

double openLoops(const Simulator& simulator)
{
  double open = 0.0;
  for (const Closure& loop : simulator.loops())
    open = std::max(open, openness(simulator, loop));
  return open;
}

JointCommand effort(double value)
{
  JointCommand command;
  command.target = value;
  return command;
}

TEST(DeltaRobotTest, SwingsWithoutTurningItsPlatform)
{
  // No row is redundant: 45 coordinates, 36 rows; the platform's three and a spin of each rod are left. The platform
  // is where three spheres about the elbows meet, and upright because the parallelograms are.
  const Delta delta;
  Scenario scenario = deltaScene(delta, 0.3);
  scenario.gravity = {0.0, 0.0, -GRAVITY};
  scenario.bodies[0].joints["drive_0"].velocity = 1.0;
  for (int i = 0; i < 3; ++i)
    scenario.bodies[0].springs["drive_" + std::to_string(i)] = {40.0, 0.2, 0.0};
  AuditedSimulator simulator(scenario);
  EXPECT_TRUE(simulator.warnings().empty()) << testing::PrintToString(simulator.warnings());
  const double energy = energyOf(simulator);
  double fastest = 0.0;
  double worst = 0.0;
  double lowest = 1.0;
  double highest = 0.0;
  for (int step = 0; step < 2000; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    for (int body = 0; body < simulator.bodyCount(); ++body)
      fastest = std::max(fastest, simulator.velocity(body).cwiseAbs().maxCoeff());
    worst = std::max(worst, openLoops(simulator));
    const Eigen::Isometry3d platform = simulator.data(1).link_pose[0];
    const double tilt = Eigen::AngleAxisd(platform.linear()).angle();
    ASSERT_LE(tilt, 2.0 * worst / delta.spread + 1e-9) << step;
    for (int i = 0; i < 3; ++i)
    {
      const Eigen::Vector3d elbow = delta.elbow(i, simulator.position(0)[i]);
      const Eigen::Vector3d reach = platform.translation() + delta.platform * delta.out(i) - elbow;
      ASSERT_NEAR(reach.norm(), delta.rod, 3.0 * worst + 1e-9) << step;
    }
    lowest = std::min(lowest, platform.translation().z());
    highest = std::max(highest, platform.translation().z());
  }
  EXPECT_LE(worst, 2.0 * 1e-6 * fastest * fastest * delta.rod);
  EXPECT_GT(highest - lowest, 0.03);
  EXPECT_NEAR(energyOf(simulator), energy, 1e-5 * energy);
}

TEST(DeltaRobotTest, PressesAsVirtualWorkSays)
{
  // No gravity, one torque on all three drives: F dz = 3 tau dtheta. Then it rests: closed to round-off, for good.
  const Delta delta;
  const double theta = 0.5;
  const double torque = 2.0;
  Scenario scenario = deltaScene(delta, theta);
  scenario.ground = GroundSpec{};
  scenario.ground->height = delta.platformHeight(theta) - 0.05;
  for (int i = 0; i < 3; ++i)
    scenario.bodies[0].commands["drive_" + std::to_string(i)] = effort(torque);
  Simulator simulator(scenario);  // the audit does not see that efforts of another body load this contact
  for (int step = 0; step < 1500; ++step)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  double force = 0.0;
  for (const ContactState& contact : simulator.contacts())
    force += contact.impulse.z() / 1e-3;
  const double step = 1e-5;
  const double slope = (delta.platformHeight(theta + step) - delta.platformHeight(theta - step)) / (2.0 * step);
  EXPECT_NEAR(force, -3.0 * torque / slope, 1e-8 * force);
  EXPECT_LT(openLoops(simulator), 1e-12);
  EXPECT_LT(simulator.report().max_penetration, 1e-9);
}

/** Slider-crank whose slider has clearance in its guide (Flores, Leine, Glocker 2010), motion in the x-z plane. */
struct SliderCrank
{
  double crank = 0.153, rod = 0.306, half_length = 0.05, half_height = 0.025, clearance = 0.001;  // [m]
  double masses[3] = {0.038, 0.038, 0.076};  // [kg]
  double inertias[3] = {7.4e-5, 5.9e-4, 2.7e-6};  // about the centres of mass [kg m^2]
};

std::string planarLink(const std::string& name, double centre, double mass, double inertia, const std::string& shapes)
{
  const std::string moment = text(inertia);
  return "<link name='" + name + "'><inertial><origin xyz='" + text(centre) + " 0 0'/><mass value='" + text(mass) +
         "'/><inertia ixx='" + moment + "' ixy='0' ixz='0' iyy='" + moment + "' iyz='0' izz='" + moment +
         "'/></inertial>" + shapes + "</link>";
}

std::string planarHinge(const std::string& name, const std::string& parent, const std::string& child, double x)
{
  return "<joint name='" + name + "' type='continuous'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='" + text(x) + " 0 0'/><axis xyz='0 -1 0'/></joint>";
}

std::string sliderBox(const SliderCrank& part)
{
  return "<collision><geometry><box size='" + text(2.0 * part.half_length) + " 0.02 " + text(2.0 * part.half_height) +
         "'/></geometry></collision>";
}

/** The four corners of its section alone, as points. */
std::string sliderCorners(const SliderCrank& part)
{
  std::string corners;
  for (const double x : {-part.half_length, part.half_length})
    for (const double z : {-part.half_height, part.half_height})
      corners += "<collision><origin xyz='" + text(x) + " 0 " + text(z) +
                 "'/><geometry><sphere radius='0'/></geometry></collision>";
  return corners;
}

Scenario sliderCrankScene(const SliderCrank& part, const std::string& shapes, double h)
{
  const std::string urdf = "<robot name='engine'><link name='frame'/>" +
                           planarLink("crank", 0.5 * part.crank, part.masses[0], part.inertias[0], "") +
                           planarLink("rod", 0.5 * part.rod, part.masses[1], part.inertias[1], "") +
                           planarLink("slider", 0.0, part.masses[2], part.inertias[2], shapes) +
                           planarHinge("one", "frame", "crank", 0.0) + planarHinge("two", "crank", "rod", part.crank) +
                           planarHinge("three", "rod", "slider", part.rod) + "</robot>";
  Scenario scenario = groundScene(0.01, 0.4);
  scenario.ground.reset();
  scenario.time_step = h;
  scenario.stopping.tolerance = 1e-10;
  BodySpec& engine = addBody(scenario, "engine", urdf, poseAt(0.0, 0.0, 0.0));
  engine.base = BaseType::FIXED;
  engine.joints["one"].velocity = 150.0;
  engine.joints["two"].velocity = -75.0 - 150.0;
  engine.joints["three"].velocity = 75.0;
  for (const double side : {-1.0, 1.0})
    addBody(scenario, side < 0.0 ? "below" : "above", boxUrdf({1.0, 0.1, 0.02}, 1.0),
            poseAt(part.rod, 0.0, side * (part.half_height + part.clearance + 0.01)))
        .base = BaseType::FIXED;
  return scenario;
}

struct SliderCrankRun
{
  double first_impact = 0.0;  ///< [s]
  double crank_angle = 0.0;  ///< at 0.2 s [rad]
  double energy_ratio = 0.0;  ///< kinetic, at 0.2 s over that at the start
  double deepest = 0.0;  ///< [m]
};

SliderCrankRun runSliderCrank(const std::string& shapes, double h)
{
  Simulator simulator(sliderCrankScene(SliderCrank(), shapes, h));
  SliderCrankRun run;
  const double start = simulator.report().energy.kinetic;
  while (simulator.time() < 0.2 - 0.5 * h)
  {
    if (!simulator.step().converged())
    {
      ADD_FAILURE() << "at " << simulator.time() << " s: " << simulator.outcome().message;
      break;
    }
    for (const ContactState& contact : simulator.contacts())
      if (run.first_impact == 0.0 && contact.mode == ContactMode::IMPACT)
        run.first_impact = simulator.time() - 0.5 * h;
    run.deepest = std::max(run.deepest, simulator.report().max_penetration);
  }
  run.crank_angle = simulator.position(0)[0];
  run.energy_ratio = simulator.report().energy.kinetic / start;
  return run;
}

TEST(SliderCrankTest, HitsItsGuideAsInTheLiterature)
{
  const SliderCrank part;
  for (const std::string& shapes : {sliderBox(part), sliderCorners(part)})
  {
    const SliderCrankRun run = runSliderCrank(shapes, 1e-5);
    EXPECT_NEAR(run.first_impact, 0.002694, 1e-5);
    EXPECT_NEAR(run.crank_angle, 18.0837, 1e-3 * 18.0837);
    EXPECT_NEAR(run.energy_ratio, 0.9386, 1e-3);
    EXPECT_LT(run.deepest, 1e-9);
  }
}

/** A gripper of two fingers on rails, one the mirror of the other by <mimic>, driven with at most `most` newtons. */
Scenario gripperScene(double most, double block)
{
  const auto finger = [](const std::string& name)
  {
    return "<link name='" + name +
           "'><inertial><mass value='0.1'/><inertia ixx='1e-4' ixy='0' ixz='0' iyy='1e-4' iyz='0' izz='1e-4'/>"
           "</inertial><collision><geometry><sphere radius='0.01'/></geometry></collision></link>";
  };
  const auto rail = [](const std::string& name, const std::string& child, double side, const std::string& mimic)
  {
    return "<joint name='" + name + "' type='prismatic'><parent link='world'/><child link='" + child +
           "'/><origin xyz='" + text(side * 0.1) + " 0 0'/><axis xyz='" + text(-side) +
           " 0 0'/><limit lower='0' upper='0.09' effort='1e3' velocity='10'/>" + mimic + "</joint>";
  };
  Scenario scenario = emptySpace();
  scenario.stopping.tolerance = 1e-10;
  BodySpec& hand = addBody(scenario, "hand",
                           "<robot name='hand'><link name='world'/>" + finger("left") + finger("right") +
                               rail("close", "left", -1.0, "") +
                               rail("follow", "right", 1.0, "<mimic joint='close' multiplier='1'/>") + "</robot>",
                           poseAt(0.0, 0.0, 0.5));
  hand.base = BaseType::FIXED;
  JointCommand command;
  command.mode = JointCommand::Mode::POSITION;
  command.target = 0.09;
  command.kp = 5000.0;
  command.kd = 50.0;
  command.max_effort = most;
  hand.commands["close"] = command;
  addBody(scenario, "block", boxUrdf({block, 0.05, 0.05}, 0.5), poseAt(0.0, 0.0, 0.5));
  return scenario;
}

TEST(MimicGripperTest, ClosesOnABlockStopsWithItsEffortAtTheLimitAndStaysFor1e5Steps)
{
  const double most = 30.0;
  const double block = 0.04;
  Simulator simulator(gripperScene(most, block));
  double closure[2] = {0.0, 0.0};
  double deepest = 0.0;
  for (int step = 0; step < 100000; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << step << " " << simulator.outcome().message;
    const Eigen::VectorXd& q = simulator.position(0);
    double& part = closure[step < 1000 ? 0 : 1];
    part = std::max(part, std::abs(q[0] - q[1]));
    deepest = std::max(deepest, simulator.report().max_penetration);
  }
  EXPECT_LT(closure[0], 2e-6);  // 2 h^2 v^2/L with v = 1 m/s, L = 1 m
  EXPECT_LT(closure[1], 1e-12);  // at rest, and not growing
  EXPECT_LT(deepest, 1e-9);
  EXPECT_NEAR(simulator.effort(0, simulator.model(0).findJoint("close")), most, 1e-9 * most);
  // Fingers at the block's faces: 0.1 - q - 0.01 = block/2. Each presses with half of the drive's force.
  EXPECT_NEAR(simulator.position(0)[0], 0.09 - 0.5 * block, 1e-9);
  double pressed = 0.0;
  for (const ContactState& contact : simulator.contacts())
    pressed += std::abs(contact.impulse.x()) / 1e-3;
  EXPECT_NEAR(pressed, most, 1e-6 * most);  // two fingers, half of it each
  EXPECT_LT(simulator.velocity(1).norm(), 1e-12);
}

}  // namespace
}  // namespace frictional_contact_sim
