// Links welded and released in a run: closure, momentum, energy, forces, state, refusals.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>

#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_file.h"
#include "scene.h"
#include "support/audited_simulator.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::AuditedSimulator;

const LinkRef WORLD;

/** Root link of a body made by addBody. */
LinkRef root(int body)
{
  return {body, "body"};
}

/** An arm of one revolute joint about z at the origin, its tip half a metre along x. */
std::string armUrdf()
{
  return "<robot name='arm'><link name='world'/><link name='arm'><inertial><origin xyz='0.25 0 0'/><mass value='2'/>"
         "<inertia ixx='0.01' ixy='0' ixz='0' iyy='0.05' iyz='0' izz='0.05'/></inertial></link>"
         "<joint name='shoulder' type='continuous'><parent link='world'/><child link='arm'/><axis xyz='0 0 1'/></joint>"
         "<link name='tip'/><joint name='end' type='fixed'><parent link='arm'/><child link='tip'/>"
         "<origin xyz='0.5 0 0'/></joint></robot>";
}

BodySpec& addArm(Scenario& scenario)
{
  BodySpec& arm = addBody(scenario, "arm", armUrdf(), poseAt(0, 0, 1));
  arm.base = BaseType::AUTO;
  return arm;
}

void run(Simulator& simulator, int steps)
{
  for (int i = 0; i < steps; ++i)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
}

Eigen::Isometry3d pose(const Simulator& simulator, int body, const std::string& link)
{
  const MultibodyModel& model = simulator.model(body);
  return framePose(model, simulator.data(body), model.findFrame(link));
}

double mechanicalEnergy(const Simulator& simulator)
{
  return simulator.report().energy.kinetic + simulator.report().energy.potential;
}

/** Without a change of state or hash. */
void expectRefused(Simulator& simulator, const std::function<void()>& request, const std::string& text)
{
  const std::uint64_t hash = simulator.stateHash();
  try
  {
    request();
    ADD_FAILURE() << "not refused, expected: " << text;
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
  EXPECT_EQ(simulator.stateHash(), hash);
}

TEST(WeldTest, ABallFollowsAMovingArm)
{
  Scenario scenario = groundScene(0.5);
  scenario.ground.reset();
  JointCommand motor;
  motor.mode = JointCommand::Mode::POSITION;
  motor.target = 2.0;
  motor.kp = 200.0;
  motor.kd = 60.0;
  addArm(scenario).commands["shoulder"] = motor;
  addBody(scenario, "ball", sphereUrdf(0.05, 0.5), poseAt(0.5, 0, 1));
  AuditedSimulator simulator(scenario);
  ASSERT_TRUE(simulator.attach(root(1), {0, "tip"}).converged());
  double fastest = 0.0;
  for (int i = 0; i < 2000; ++i)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    EXPECT_LE(simulator.report().bilateral_violation, 1e-10) << "at the midpoint, where rows close";
    // Between two midpoints the ball goes along the chord of its circle: (dt w)^2/8 of the radius off it.
    fastest = std::max(fastest, std::abs(simulator.velocity(0)[0]));
    const double chord = 0.5 * std::pow(0.001 * fastest, 2) / 8.0;
    const double error = (pose(simulator, 1, "body").translation() - pose(simulator, 0, "tip").translation()).norm();
    EXPECT_LE(error, 1.5 * chord + 1e-10) << "step " << i;
  }
  EXPECT_GT(fastest, 0.5);
  EXPECT_NEAR(simulator.position(0)[0], 2.0, 0.1);
  EXPECT_LE((pose(simulator, 1, "body").translation() - pose(simulator, 0, "tip").translation()).norm(), 1e-10);
  // The servo holds the ball's weight by its bearing, not by its torque; the weld carries all of it.
  EXPECT_NEAR(simulator.weldWrench(0)[2], 0.5 * GRAVITY, 1e-6);
}

TEST(WeldTest, TheWrenchIsTheWeightAndItsMoment)
{
  Scenario scenario = groundScene(0.5);
  std::string urdf = boxUrdf({0.1, 0.1, 0.1}, 3.0);
  urdf.replace(urdf.find("<inertial>"), 10, "<inertial><origin xyz='0.2 0 0'/>");
  addBody(scenario, "lamp", urdf, poseAt(0, 0, 2));
  AuditedSimulator simulator(scenario);
  simulator.attach(root(0), WORLD);
  run(simulator, 5);
  const std::uint64_t hash = simulator.stateHash();
  const Eigen::VectorXd q = simulator.position(0);
  run(simulator, 200);
  EXPECT_LE((simulator.position(0) - q).norm(), 1e-15) << "at rest";
  EXPECT_NE(simulator.stateHash(), hash) << "time has gone on";
  const Vector6d wrench = simulator.weldWrench(0);
  EXPECT_NEAR(wrench[2], 3.0 * GRAVITY, 1e-9);
  EXPECT_NEAR(wrench[4], -3.0 * GRAVITY * 0.2, 1e-9) << "0.2 m along x: the weight turns about y";
  EXPECT_LE(wrench.head<2>().norm() + std::abs(wrench[3]) + std::abs(wrench[5]), 1e-9);
  ASSERT_TRUE(simulator.detach(WORLD, root(0)).converged());
  run(simulator, 100);
  EXPECT_NEAR(simulator.data(0).link_pose[0].translation().z() + 0.0, 2.0 - 0.5 * GRAVITY * 0.01, 1e-3) << "it falls";
}

TEST(WeldTest, AWeldedPileDoesNotSink)
{
  Scenario scenario = groundScene(0.6);
  for (const double z : {0.1, 0.3, 0.5, 0.7})
    addBody(scenario, "box" + std::to_string(z), boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0, 0, z));
  AuditedSimulator simulator(scenario);
  ASSERT_TRUE(simulator.attach(root(1), root(2)).converged());
  run(simulator, 20);
  std::vector<Eigen::VectorXd> rest;
  for (int body = 0; body < 4; ++body)
    rest.push_back(simulator.position(body));
  run(simulator, 1000);
  double support = 0.0;
  for (int body = 0; body < 4; ++body)
    EXPECT_LE((simulator.position(body) - rest[body]).norm(), 1e-10) << body;
  for (const ContactState& contact : simulator.contacts())
  {
    if (simulator.shape(contact.shape_b).body < 0)
      support += contact.impulse.z() / 0.001;
    EXPECT_FALSE(simulator.shape(contact.shape_a).body == 1 && simulator.shape(contact.shape_b).body == 2)
        << "welded links do not collide";
  }
  EXPECT_NEAR(support, 4.0 * GRAVITY, 1e-6);
  EXPECT_NEAR(-simulator.weldWrench(0)[2], 2.0 * GRAVITY, 1e-6) << "two boxes above the weld";
}

/** A box held between the world (or a heavy block) by a weld and the ground by contacts: redundant, still an answer. */
TEST(WeldTest, AWeldedBoxMayTouchAThirdBody)
{
  Scenario scenario = groundScene(0.6);
  addBody(scenario, "left", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0, 0, 0.1));
  addBody(scenario, "right", boxUrdf({0.2, 0.2, 0.2}, 2.0), poseAt(0.2, 0, 0.1));
  addBody(scenario, "held", boxUrdf({0.2, 0.2, 0.2}, 2.0), poseAt(0, 1, 0.1));
  addBody(scenario, "top", boxUrdf({0.2, 0.2, 0.2}, 2.0), poseAt(0, 1, 0.3));
  AuditedSimulator simulator(scenario);
  ASSERT_TRUE(simulator.attach(root(0), root(1)).converged());
  ASSERT_TRUE(simulator.attach(root(2), WORLD).converged());
  run(simulator, 500);
  double left_and_right = 0.0;
  for (const ContactState& contact : simulator.contacts())
  {
    const int a = simulator.shape(contact.shape_a).body;
    const int b = simulator.shape(contact.shape_b).body;
    left_and_right += b < 0 && a < 2 ? contact.impulse.z() / 0.001 : 0.0;
    EXPECT_FALSE(a == 2 && b < 0) << "what is welded to the world does not collide with its ground";
  }
  EXPECT_NEAR(left_and_right, 3.0 * GRAVITY, 1e-6);
  EXPECT_NEAR(simulator.weldWrench(1)[2], 4.0 * GRAVITY, 1e-6) << "with the box on top";
  for (int body = 0; body < 4; ++body)
    EXPECT_NEAR(simulator.position(body).z(), body == 3 ? 0.3 : 0.1, 1e-9);
  // Lifted by its neighbour: a weld carries what contacts no longer do.
  ExternalWrench lift;
  lift.link = "body";
  lift.force = {0.0, 0.0, 40.0};
  lift.until = simulator.time() + 0.3;
  simulator.addWrench(1, lift);
  run(simulator, 300);
  EXPECT_GT(simulator.position(0).z(), 0.15);
  EXPECT_GT(simulator.position(1).z(), 0.15);
}

TEST(WeldTest, SavedInTheMiddleGoesOnWithTheSameBits)
{
  Scenario scenario = groundScene(0.4);
  addArm(scenario).joints["shoulder"].velocity = 3.0;
  addBody(scenario, "ball", sphereUrdf(0.05, 0.5), poseAt(0.5, 0, 1));
  addBody(scenario, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.1, 0.3, 0.11));
  Simulator whole(scenario);
  whole.attach(root(1), {0, "tip"});
  run(whole, 50);
  whole.attach(root(1), root(2));
  run(whole, 50);
  const std::string path = std::filesystem::temp_directory_path() / ("weld_test_" + std::to_string(getpid()));
  saveState(whole, path);
  Simulator second(scenario);
  run(second, 3);
  loadState(second, path);
  std::filesystem::remove(path);
  ASSERT_EQ(second.welds().size(), 2U);
  EXPECT_EQ(second.stateHash(), whole.stateHash());
  for (int i = 0; i < 200; ++i)
  {
    if (i == 100)
      for (Simulator* simulator : {&whole, &second})
        simulator->detach(root(1), {0, "tip"});
    run(whole, 1);
    run(second, 1);
    ASSERT_EQ(firstDifference(second.state(), whole.state()), "") << "step " << i;
  }
  // A reset goes back to a start without welds, and the shapes collide again.
  whole.reset();
  EXPECT_TRUE(whole.welds().empty());
  run(whole, 10);
  Simulator fresh(scenario);
  run(fresh, 10);
  EXPECT_EQ(whole.position(2), fresh.position(2));
  EXPECT_EQ(whole.velocity(0), fresh.velocity(0));
}

TEST(WeldTest, RandomSequencesKeepTheInvariants)
{
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U})
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    Scenario scenario = groundScene(0.5);
    scenario.stopping.tolerance = 1e-10;
    for (int body = 0; body < 6; ++body)
    {
      BodySpec& box = addBody(scenario, "box" + std::to_string(body), boxUrdf({0.2, 0.15, 0.1}, 1.0 + 0.2 * body),
                              poseAt(0.3 * (body % 3), 0.3 * (body / 3), 0.3 + 0.1 * body));
      box.angular_velocity = 2.0 * Eigen::Vector3d(number(random), number(random), number(random));
    }
    AuditedSimulator simulator(scenario);
    int attached = 0;
    int refused = 0;
    for (int i = 0; i < 40; ++i)
    {
      std::uniform_int_distribution<int> any(-1, 5);
      const LinkRef a = root(any(random));
      const LinkRef b = root(any(random));
      try
      {
        const bool joins = number(random) < 0.3;
        const double before = mechanicalEnergy(simulator);
        ASSERT_TRUE((joins ? simulator.attach(a, b) : simulator.detach(a, b)).converged())
            << simulator.outcome().message;
        EXPECT_LE(mechanicalEnergy(simulator), before + 1e-9) << "an impact takes energy";
        ++attached;
      }
      catch (const std::invalid_argument&)
      {
        ++refused;
      }
      run(simulator, 20);
      EXPECT_LE(std::abs(simulator.report().energy.balance_error), 1e-3) << "seed " << seed << ", change " << i;
      EXPECT_LE(simulator.report().bilateral_violation, 1e-6) << "seed " << seed << ", change " << i;
    }
    EXPECT_GT(attached, 5);
    EXPECT_GT(refused, 5);
  }
}

TEST(WeldTest, APoseThatIsAskedForIsTaken)
{
  Scenario scenario = emptySpace();
  addBody(scenario, "a", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0, 0, 0));
  addBody(scenario, "b", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0.2, 0, 0));
  AuditedSimulator simulator(scenario);
  simulator.waive("rise");  // closing the half millimetre is the weld's work
  expectRefused(
      simulator, [&]() { simulator.attach(root(1), root(0), poseAt(0.21, 0, 0)); }, "expected at most 0.001");
  expectRefused(
      simulator, [&]() { simulator.attach(root(1), root(0), poseAt(std::nan(""), 0, 0)); }, "expected at most 0.001");
  ASSERT_TRUE(simulator.attach(root(1), root(0), poseAt(0.2005, 0, 0)).converged());
  for (int i = 0; i < 50; ++i)
  {
    run(simulator, 1);
    EXPECT_LE(simulator.velocity(0).head<3>().norm(), 0.1) << "no faster than 0.1 m/s";
  }
  EXPECT_NEAR(simulator.position(1).x() - simulator.position(0).x(), 0.2005, 1e-10);
}

TEST(WeldTest, WhatCannotBeWeldedIsRefused)
{
  Scenario scenario = groundScene(0.5);
  addArm(scenario);
  addBody(scenario, "box", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(1, 0, 0.05));
  addBody(scenario, "other", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(2, 0, 0.05));
  addBody(scenario, "belt", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(3, 0, 0.5)).base = BaseType::FIXED;
  scenario.bodies.back().motion = {{0.1, 0.0, 0.0}, Eigen::Vector3d::Zero()};
  Simulator simulator(scenario);
  expectRefused(
      simulator,
      [&]() {
        simulator.attach({1, "boddy"}, root(2));
      },
      "body 'box' has no link 'boddy', did you mean 'body'?");
  expectRefused(
      simulator,
      [&]() {
        simulator.attach({7, "body"}, root(2));
      },
      "there is no body 7");
  expectRefused(
      simulator, [&]() { simulator.attach(root(1), root(1)); }, "one rigid thing already");
  expectRefused(
      simulator,
      [&]() {
        simulator.attach({0, "arm"}, {0, "tip"});
      },
      "one rigid thing already");
  expectRefused(
      simulator,
      [&]() {
        simulator.attach({0, "world"}, WORLD);
      },
      "one rigid thing already");
  expectRefused(
      simulator, [&]() { simulator.attach(root(3), WORLD); }, "can move");
  expectRefused(
      simulator, [&]() { simulator.detach(root(1), root(2)); }, "are not welded");
  ASSERT_TRUE(simulator.attach(root(1), root(2)).converged());
  expectRefused(
      simulator, [&]() { simulator.attach(root(2), root(1)); }, "are welded already");
  ASSERT_TRUE(simulator.attach(root(2), {0, "tip"}).converged());
  expectRefused(
      simulator,
      [&]() {
        simulator.attach(root(1), {0, "arm"});
      },
      "one rigid thing already");
  run(simulator, 20);
}

/** What a moving base carries goes with it, and its drive does the work. */
TEST(WeldTest, ABoxWeldedToAMovingBaseGoesWithIt)
{
  Scenario scenario = groundScene(0.5);
  addBody(scenario, "lift", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0, 0, 0.5)).base = BaseType::FIXED;
  scenario.bodies.back().motion = {{0.0, 0.0, 0.2}, Eigen::Vector3d::Zero()};
  addBody(scenario, "box", boxUrdf({0.1, 0.1, 0.1}, 2.0), poseAt(0.2, 0, 0.5));
  AuditedSimulator simulator(scenario);
  ASSERT_TRUE(simulator.attach(root(1), root(0)).converged());
  EXPECT_NEAR(simulator.velocity(1)[2], 0.2, 1e-12) << "from the moment it is welded";
  run(simulator, 500);
  EXPECT_NEAR(simulator.position(1).z(), 0.6, 1e-9);
  EXPECT_NEAR(simulator.report().energy.actuators, 2.0 * GRAVITY * 0.1 + 2.0 * 0.2 * 0.2, 1e-6)
      << "the lift pays the weight's rise, and the kinetic energy twice: one half went in the impact";
  EXPECT_NEAR(simulator.report().energy.impact, 0.5 * 2.0 * 0.2 * 0.2, 1e-9);
  EXPECT_LE(std::abs(simulator.report().energy.balance_error), 1e-9);
}

}  // namespace
}  // namespace frictional_contact_sim
