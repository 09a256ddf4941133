// Prescribed motions, surfaces that move, springs and velocity limits, against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/simulation/scenario_loader.h"
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

constexpr double DT = 0.001;

/** Vertical force of all contacts on a body [N], mean over the step. */
double liftOf(const Simulator& simulator, int body)
{
  double lift = 0.0;
  for (const ContactState& contact : simulator.contacts())
    lift += ((simulator.shape(contact.shape_a).body == body ? 1.0 : 0.0) -
             (simulator.shape(contact.shape_b).body == body ? 1.0 : 0.0)) *
            contact.impulse.z() / DT;
  return lift;
}

Scenario plateAndBox(const BaseMotion& motion, double friction)
{
  Scenario scenario = groundScene(friction);
  scenario.ground.reset();
  BodySpec& plate = addBody(scenario, "plate", boxUrdf({4.0, 4.0, 0.1}, 50.0), poseAt(0.0, 0.0, -0.05));
  plate.base = BaseType::FIXED;
  plate.motion = motion;
  addBody(scenario, "box", boxUrdf({0.2, 0.2, 0.2}, 2.0), poseAt(0.0, 0.0, 0.1));
  return scenario;
}

BaseMotion sine(const Eigen::Vector3d& axis, double amplitude, double frequency)
{
  BaseMotion motion;
  motion.active = true;
  motion.type = BaseMotion::Type::SINE;
  motion.axis = axis;
  motion.amplitude = amplitude;
  motion.frequency = frequency;
  return motion;
}

TEST(MotionTest, AShakenPlateCarriesItsBoxUntilItFallsFasterThanTheBox)
{
  for (const double share : {0.3, 0.9, 1.6})  // of g, the largest acceleration
  {
    const double frequency = 5.0;
    const double omega = 2.0 * M_PI * frequency;
    const double amplitude = share * GRAVITY / (omega * omega);
    AuditedSimulator simulator(plateAndBox(sine(Eigen::Vector3d::UnitZ(), amplitude, frequency), 0.5));
    // The plate begins with a velocity that the box has not: an impact, then they move as one.
    bool has_left = false;
    for (int step = 0; step < 400; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      const double lift = liftOf(simulator, 1);
      has_left = has_left || (step > 2 && lift == 0.0);
      const double middle = simulator.time() - 0.5 * DT;
      const double gap = simulator.position(1)[2] - 0.1 - amplitude * std::sin(omega * simulator.time());
      ASSERT_GT(gap, -1e-6) << step;
      if (share < 1.0 && step > 2)
      {
        // The mean acceleration over a step of the scheme is that about its middle, to second order.
        const double expected = 2.0 * (GRAVITY - amplitude * omega * omega * std::sin(omega * middle));
        ASSERT_NEAR(lift, expected, 2.0 * GRAVITY * 1e-3 + 2.0 * amplitude * std::pow(omega, 3) * DT) << step;
      }
    }
    EXPECT_EQ(has_left, share > 1.0) << share;
  }
}

TEST(MotionTest, ARobotWeldedToAShakenPlateSwingsAsItsResonanceSays)
{
  // A base with joints has no motion of its own; a loop welds it to what moves. Mass on a spring, x_plate = a sin(w t):
  // against the plate q = a r^2/(1 - r^2) sin(w t), r = w/w_0, where it starts so.
  const double amplitude = 0.01, omega = 12.0, own = 20.0;
  const double ratio = omega / own;
  const double swing = amplitude * ratio * ratio / (1.0 - ratio * ratio);
  double error[2];
  for (const int halves : {0, 1})
  {
    Scenario scenario = emptySpace();
    scenario.time_step = 0.002 / (1 << halves);
    scenario.stopping.tolerance = 1e-11;
    BodySpec& plate = addBody(scenario, "plate", boxUrdf({1.0, 1.0, 0.1}, 50.0), poseAt(0.0, 0.0, 0.0));
    plate.base = BaseType::FIXED;
    plate.motion = sine(Eigen::Vector3d::UnitX(), amplitude, omega / (2.0 * M_PI));
    const std::string inertial =
        "<inertial><mass value='2'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>";
    BodySpec& robot =
        addBody(scenario, "robot",
                "<robot name='robot'><link name='foot'>" + inertial + "</link><link name='carriage'>" + inertial +
                    "</link><joint name='rail' type='prismatic'><parent link='foot'/><child "
                    "link='carriage'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='10' "
                    "velocity='10'/></joint></robot>",
                poseAt(0.0, 0.0, 0.3));
    robot.linear_velocity.x() = amplitude * omega;
    robot.joints["rail"].velocity = swing * omega;
    robot.springs["rail"] = {2.0 * own * own, 0.0, 0.0};
    LoopSpec weld{"bolts", LoopType::WELD, {"robot", "foot"}, {"plate", "body"}, ""};
    weld.b.placement.translation() = Eigen::Vector3d(0.0, 0.0, 0.3);
    scenario.loops = {weld};
    Simulator simulator(scenario);
    error[halves] = 0.0;
    while (simulator.time() < 1.0)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      const double q = simulator.position(1)[simulator.model(1).joints[1].q_index];
      error[halves] = std::max(error[halves], std::abs(q - swing * std::sin(omega * simulator.time())));
    }
  }
  EXPECT_LT(error[0], 0.01 * swing);
  EXPECT_LT(error[1], 0.3 * error[0]);  // order 2
}

TEST(MotionTest, ATableIsFollowedToTheBitAtItsTimesAndStandsStillOutside)
{
  BaseMotion motion;
  motion.active = true;
  motion.type = BaseMotion::Type::TABLE;
  motion.times = {0.05, 0.15, 0.25};
  motion.displacements = {{0, 0, 0}, {0.1, 0, 0.02}, {0.1, 0.1, 0}};
  motion.turns = {Eigen::Quaterniond::Identity(), Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())),
                  Eigen::Quaterniond(Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitZ()))};
  AuditedSimulator simulator(plateAndBox(motion, 0.9));
  const auto at = [&](int step)
  {
    while (simulator.state().step < static_cast<std::uint64_t>(step))
      ASSERT_TRUE(simulator.step().converged());
  };
  at(50);
  EXPECT_LT((simulator.data(0).link_pose[0].translation() - Eigen::Vector3d(0, 0, -0.05)).norm(), 1e-15);
  at(150);
  EXPECT_LT((simulator.data(0).link_pose[0].translation() - Eigen::Vector3d(0.1, 0, -0.03)).norm(), 1e-12);
  EXPECT_TRUE(simulator.data(0).link_pose[0].linear().isApprox(motion.turns[1].toRotationMatrix(), 1e-12));
  at(400);
  EXPECT_LT((simulator.data(0).link_pose[0].translation() - Eigen::Vector3d(0.1, 0.1, -0.05)).norm(), 1e-12);
  // A reset begins anew.
  simulator.reset();
  EXPECT_LT((simulator.data(0).link_pose[0].translation() - Eigen::Vector3d(0, 0, -0.05)).norm(), 1e-15);
}

TEST(MotionTest, ABoxOnABeltSlipsForVOverMuGAlongVSquaredOverTwoMuG)
{
  Dice dice(7);
  for (int trial = 0; trial < 12; ++trial)
  {
    const double friction = dice.uniform(0.1, 0.8);
    const double speed = dice.uniform(0.2, 1.5);
    const double angle = dice.uniform(-3.0, 3.0);
    const Eigen::Vector3d belt = speed * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    Scenario scenario = groundScene(friction);
    scenario.ground.reset();
    BodySpec& conveyor = addBody(scenario, "conveyor", boxUrdf({20.0, 20.0, 0.1}, 50.0), poseAt(0.0, 0.0, -0.05));
    conveyor.base = BaseType::FIXED;
    conveyor.surface_velocity["body"].linear = belt;
    scenario.stopping.tolerance = 1e-11;
    addBody(scenario, "slab", boxUrdf({0.4, 0.4, 0.02}, 2.0), poseAt(0.0, 0.0, 0.01));  // flat: it does not tip
    AuditedSimulator simulator(scenario);
    const double slip_time = speed / (friction * GRAVITY);
    const int steps = static_cast<int>(slip_time / DT);
    for (int step = 0; step < steps; ++step)
      ASSERT_TRUE(simulator.step().converged());
    const double time = steps * DT;
    EXPECT_NEAR(simulator.velocity(1).head<3>().norm(), friction * GRAVITY * time, 1e-8);
    EXPECT_NEAR(simulator.position(1).head<2>().norm(), 0.5 * friction * GRAVITY * time * time, 1e-8);
    for (int step = 0; step < 50; ++step)
      ASSERT_TRUE(simulator.step().converged());
    EXPECT_LT((Eigen::Vector3d(simulator.velocity(1).head<3>()) - belt).norm(), 1e-9);  // carried, it holds
    // The belt's drive: half to the box, half to heat.
    const EnergyLedger& energy = simulator.report().energy;
    EXPECT_NEAR(energy.actuators, 2.0 * speed * speed, 0.01 * speed);
    EXPECT_NEAR(energy.friction, 1.0 * speed * speed, 0.01 * speed);
    EXPECT_LT(std::abs(energy.balance_error), 1e-9);
  }
}

TEST(MotionTest, ATurntableCarriesWhatFrictionHoldsAndThrowsOffTheRest)
{
  const double radius = 0.3;
  const double friction = 0.4;
  const double fastest = std::sqrt(friction * GRAVITY / radius);
  for (const double share : {0.9, 1.1})
  {
    Scenario scenario = groundScene(friction);
    scenario.ground.reset();
    BodySpec& table = addBody(scenario, "table", boxUrdf({4.0, 4.0, 0.1}, 50.0), poseAt(0.0, 0.0, -0.05));
    table.base = BaseType::FIXED;
    table.surface_velocity["body"].angular = {0.0, 0.0, share * fastest};
    BodySpec& disc = addBody(scenario, "disc", cylinderUrdf(0.005, 0.002, 0.1), poseAt(radius, 0.0, 0.001));
    disc.linear_velocity = {0.0, share * fastest * radius, 0.0};
    disc.angular_velocity = {0.0, 0.0, share * fastest};
    AuditedSimulator simulator(scenario);
    for (int step = 0; step < 500; ++step)
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    const double now = simulator.position(1).head<2>().norm();
    if (share < 1.0)
    {
      EXPECT_NEAR(now, radius, 5e-5);  // of the first step, which comes from a tangent
    }
    else
    {
      EXPECT_GT(now, radius + 0.01);
    }
  }
}

Scenario springScene(double stiffness, double rest, double damping)
{
  Scenario scenario = railScene(50.0, 1e6);
  scenario.bodies[0].springs["rail"] = {stiffness, rest, damping};
  return scenario;
}

TEST(SpringTest, OscillatesWithExactEnergyAtAnyStiffness)
{
  for (const double stiffness : {20.0, 2e4, 2e8})
  {
    Scenario scenario = springScene(stiffness, 0.2, 0.0);
    scenario.bodies[0].joints["rail"].position = 0.3;
    AuditedSimulator simulator(scenario);
    const double energy = 0.5 * stiffness * 0.01;
    EXPECT_NEAR(simulator.report().energy.potential, energy, 1e-9 * energy);
    double least = 1.0;
    for (int step = 0; step < 2000; ++step)
    {
      ASSERT_TRUE(simulator.step().converged());
      ASSERT_NEAR(simulator.report().energy.kinetic + simulator.report().energy.potential, energy, 1e-9 * energy);
      least = std::min(least, simulator.position(0)[0]);
    }
    EXPECT_NEAR(least, 0.1, 1e-3);
  }
}

TEST(SpringTest, ItsFrequencyIsOfSecondOrder)
{
  double error[2];
  for (const int halves : {0, 1})
  {
    Scenario scenario = springScene(800.0, 0.0, 0.0);  // 2 kg: 20 rad/s
    scenario.time_step = 0.004 / (1 << halves);
    scenario.bodies[0].joints["rail"].position = 0.1;
    Simulator simulator(scenario);
    for (int step = 0; step < 250 * (1 << halves); ++step)
      simulator.step();
    error[halves] = std::abs(simulator.position(0)[0] - 0.1 * std::cos(20.0));
  }
  EXPECT_LT(error[0], 2e-3);
  EXPECT_LT(error[1], 0.3 * error[0]);
}

TEST(SpringTest, DampingTakesWhatTheLedgerSaysAndItEndsAtRest)
{
  Scenario scenario = springScene(200.0, -0.1, 40.0);
  AuditedSimulator simulator(scenario);
  for (int step = 0; step < 5000; ++step)
    ASSERT_TRUE(simulator.step().converged());
  EXPECT_NEAR(simulator.position(0)[0], -0.1, 1e-9);
  EXPECT_NEAR(simulator.report().energy.joints, 0.5 * 200.0 * 0.01, 1e-9);
}

TEST(VelocityLimitTest, ADrivePushesNoMoreAtTheLimitAndNothingBrakesBeyondIt)
{
  using Mode = JointCommand::Mode;
  for (const Mode mode : {Mode::EFFORT, Mode::VELOCITY, Mode::POSITION})
    for (const double sign : {-1.0, 1.0})
    {
      SCOPED_TRACE(static_cast<int>(mode));
      Scenario scenario = railScene(1e6, 0.5);
      JointCommand push;
      push.mode = mode;
      push.target = sign * (mode == Mode::EFFORT ? 10.0 : mode == Mode::VELOCITY ? 5.0 : 40.0);
      if (mode != Mode::EFFORT)
        push.kd = 20.0;
      if (mode == Mode::POSITION)
        push.kp = 50.0;
      scenario.bodies[0].commands["rail"] = push;
      AuditedSimulator simulator(scenario);
      double fastest = 0.0;
      for (int step = 0; step < 500; ++step)
      {
        ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
        fastest = std::max(fastest, std::abs(simulator.velocity(0)[0]));
      }
      EXPECT_NEAR(simulator.velocity(0)[0], sign * 0.5, 1e-9);
      EXPECT_LE(fastest, 0.5 * (1.0 + 1e-8));
      EXPECT_NEAR(simulator.effort(0, 1), 0.0, 1e-6);  // nothing resists: nothing is needed

      // Beyond the limit it coasts.
      simulator.velocity(0)[0] = sign * 0.8;
      simulator.stateChanged();
      for (int step = 0; step < 100; ++step)
        ASSERT_TRUE(simulator.step().converged());
      if (mode != Mode::VELOCITY)
      {
        EXPECT_NEAR(simulator.velocity(0)[0], sign * 0.8, 1e-9);
      }
    }
}

TEST(VelocityLimitTest, AgainstALoadItHoldsTheSpeedWithWhatItNeeds)
{
  // 2 kg on the rail with dry friction and a push against: at the limit the drive gives exactly what they take.
  Scenario scenario = railScene(1e6, 0.5);
  JointCommand push;
  push.mode = JointCommand::Mode::EFFORT;
  push.target = 30.0;
  scenario.bodies[0].commands["rail"] = push;
  ExternalWrench load;
  load.link = "carriage";
  load.force = {-12.0, 0.0, 0.0};
  scenario.bodies[0].wrenches.push_back(load);
  AuditedSimulator simulator(scenario);
  for (int step = 0; step < 500; ++step)
    ASSERT_TRUE(simulator.step().converged());
  EXPECT_NEAR(simulator.velocity(0)[0], 0.5, 1e-9);
  EXPECT_NEAR(simulator.effort(0, 1), 12.0, 1e-6);
  EXPECT_LT(std::abs(simulator.report().energy.balance_error), 1e-8);
}

TEST(MotionTest, AScenarioSaysItAllAndNamesWhatIsWrong)
{
  const std::string head =
      "bodies: [{name: plate, urdf: " + std::string(PROJECT_DIR) + "/urdf/block.urdf, base: fixed, ";
  const Scenario scenario =
      loadScenario(head +
                       "motion: {type: sine, axis: [0, 0, 2], amplitude: 0.001, frequency: 20, phase: 0.5}, "
                       "surface_velocity: {block: {linear: [0.5, 0, 0]}}}]",
                   "cell.yaml");
  ASSERT_TRUE(scenario.bodies[0].motion);
  EXPECT_EQ(scenario.bodies[0].motion->axis.z(), 1.0);
  EXPECT_EQ(scenario.bodies[0].motion->phase, 0.5);
  EXPECT_EQ(scenario.bodies[0].surface_velocity.at("block").linear.x(), 0.5);
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"motion: {type: sinus}", "sine"},
      {"motion: {type: sine, axis: [0, 0, 0], amplitude: 1, frequency: 1}", "direction"},
      {"motion: {type: sine, axis: [0, 0, 1], frequency: 1}", "amplitude"},
      {"motion: {type: sine, axis: [0, 0, 1], amplitude: 1, frequency: -1}", "frequency"},
      {"motion: {type: table, times: [1, 0], xyz: [[0, 0, 0], [0, 0, 0]]}", "ascending"},
      {"motion: {type: table, times: [0, 1], xyz: [[0, 0, 0]]}", "one a time"},
      {"motion: {type: table, times: [0, 1]}", "neither"},
      {"surface_velocity: {nolink: {linear: [1, 0, 0]}}", "nolink"},
      {"springs: {nojoint: {stiffness: 1}}", "nojoint"},
      {"springs: {nojoint: {stiffness: -1}}", "stiffness"}};
  for (const auto& [entry, expected] : faults)
  {
    try
    {
      Simulator simulator(loadScenario(head + entry + "}]", "cell.yaml"));
      ADD_FAILURE() << entry << " was taken";
    }
    catch (const std::exception& error)
    {
      EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr(expected), testing::Not(testing::HasSubstr("\n"))))
          << entry;
    }
  }
}

}  // namespace
}  // namespace frictional_contact_sim
