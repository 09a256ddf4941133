// Nothing goes through and no row acts that cannot (dynamics/contact_set.h): what forces inside a step close, what a
// pose ahead shows, ghosts, soles with round edges, piles of meshes. Every step is audited, penetration included.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/audited_simulator.h"
#include "support/random_mesh.h"

namespace frictional_contact_sim
{
using test_support::AuditedSimulator;
namespace
{
std::string field(const std::string& file)
{
  return std::string(PROJECT_DIR) + "/../shared/field/" + file;
}

/** A force on the only link of a body, world axes [N], all the time. */
void push(BodySpec& body, const Eigen::Vector3d& force)
{
  ExternalWrench wrench;
  wrench.link = "body";
  wrench.force = force;
  wrench.world_frame = true;
  body.wrenches.push_back(wrench);
}

double height(const Simulator& simulator, int body = 0)
{
  return simulator.position(body)[2];
}

TEST(ContactSetTest, AForceInsideAStepMeetsTheGround)
{
  // 3000 N move 1 kg by 3 mm in a step: 1.5 mm above the ground, out of the reach of the velocities at its start.
  Scenario scene = groundScene(0.5);
  BodySpec& ball = addBody(scene, "ball", sphereUrdf(0.05, 1.0), poseAt(0.0, 0.0, 0.0515));
  push(ball, {0.0, 0.0, -3000.0});
  AuditedSimulator simulator(scene);
  for (int k = 0; k < 20; ++k)
  {
    simulator.step();
    ASSERT_GE(height(simulator), 0.05 - 1e-11) << k;
  }
  EXPECT_NEAR(height(simulator), 0.05, 1e-11);
}

TEST(ContactSetTest, AFastBallWithASmallGapStaysOutsideFromTheStart)
{
  // The first midpoint is 5 mm below the ground: the impact at the start has to see it.
  for (const double restitution : {0.0, 0.5})
  {
    Scenario scene = groundScene(0.5, restitution);
    BodySpec& ball = addBody(scene, "ball", sphereUrdf(0.05, 1.0), poseAt(0.0, 0.0, 0.0501));
    ball.linear_velocity = {0.0, 0.0, -10.0};
    AuditedSimulator simulator(scene);
    double lowest = height(simulator);
    for (int k = 0; k < 10; ++k)
    {
      simulator.step();
      lowest = std::min(lowest, height(simulator));
    }
    EXPECT_GE(lowest, 0.05 - 1e-11) << restitution;
    if (restitution > 0.0)
    {
      EXPECT_GT(height(simulator), 0.08);
    }
  }
}

TEST(ContactSetTest, APoseAheadOfAFallingBallIsNeverBelowTheGround)
{
  // Whatever the phase of the step at the landing: gap rows speak of midpoints, states of ends.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(0.0, 1.0);
  for (int draw = 0; draw < 40; ++draw)
  {
    Scenario scene = groundScene(0.5);
    BodySpec& ball = addBody(scene, "ball", sphereUrdf(0.05, 1.0), poseAt(0.0, 0.0, 0.05 + 0.05 * number(random)));
    ball.linear_velocity = {0.0, 0.0, -20.0 * number(random)};
    AuditedSimulator simulator(scene);
    for (int k = 0; k < 30; ++k)
    {
      simulator.step();
      ASSERT_GE(height(simulator), 0.05 - 1e-11) << "draw " << draw << " step " << k;
    }
  }
}

TEST(ContactSetTest, AFingerStopsAtItsLimitHoweverHardItIsDriven)
{
  // 1 N m on 1e-5 kg m^2 turn it by 0.1 rad in a step; the limit is 0.02 rad away.
  Scenario scene;
  scene.stopping.tolerance = 1e-13;
  BodySpec body;
  body.name = "hand";
  body.urdf_xml =
      "<robot name='hand'><link name='palm'/><link name='finger'><inertial><mass value='0.01'/>"
      "<inertia ixx='1e-5' ixy='0' ixz='0' iyy='1e-5' iyz='0' izz='1e-5'/></inertial></link>"
      "<joint name='j' type='revolute'><parent link='palm'/><child link='finger'/><axis xyz='0 0 1'/>"
      "<limit lower='-1' upper='1' effort='5' velocity='1000'/></joint></robot>";
  body.base = BaseType::FIXED;
  body.joints["j"] = {0.98, 0.0};
  JointCommand command;
  command.mode = JointCommand::Mode::EFFORT;
  command.target = 1.0;
  body.commands["j"] = command;
  scene.bodies.push_back(body);
  AuditedSimulator simulator(scene);
  for (int k = 0; k < 20; ++k)
  {
    simulator.step();
    ASSERT_LE(simulator.position(0)[0], 1.0 + 1e-9) << k;
  }
  EXPECT_NEAR(simulator.position(0)[0], 1.0, 1e-9);
}

TEST(ContactSetTest, AWheelRollsOverTheSeamOfTwoBoxesAsIfThereWereNone)
{
  for (const double friction : {0.0, 0.6})
    for (const double speed : {0.3, 1.0, 3.0})
    {
      Scenario scene = groundScene(friction);
      scene.ground.reset();
      for (const double side : {-1.0, 1.0})
      {
        BodySpec& box =
            addBody(scene, side < 0.0 ? "left" : "right", boxUrdf({4.0, 1.0, 0.2}, 1.0), poseAt(2.0 * side, 0.0, -0.1));
        box.base = BaseType::FIXED;
      }
      BodySpec& wheel = addBody(scene, "wheel", sphereUrdf(0.1, 1.0), poseAt(-0.15, 0.0, 0.1));
      wheel.linear_velocity = {speed, 0.0, 0.0};
      wheel.angular_velocity = {0.0, speed / 0.1, 0.0};
      AuditedSimulator simulator(scene);
      while (simulator.position(2)[0] < 0.15)
        simulator.step();
      EXPECT_NEAR(simulator.velocity(2)[0], speed, 1e-10 * speed) << friction;
      EXPECT_NEAR(height(simulator, 2), 0.1, 1e-10) << friction;
    }
}

/** Three balls in a row without friction: a flies at b, 0.1 mm behind b lies c, which slides past sideways. */
Scenario threeBalls(double first_gap)
{
  Scenario scene = emptySpace();
  scene.materials.fallback.friction = 0.0;
  const double gap = 1e-4, radius = 0.1;
  const std::string ball = sphereUrdf(radius, 1.0);
  addBody(scene, "a", ball, poseAt(-first_gap, 0.0, 0.0)).linear_velocity.x() = 1.0;
  addBody(scene, "b", ball, poseAt(2.0 * radius, 0.0, 0.0));
  addBody(scene, "c", ball, poseAt(4.0 * radius + gap, 0.0, 0.0)).linear_velocity.y() = 1.0;
  return scene;
}

/** Inelastic: one normal velocity for all three. */
void expectOneVelocity(const Simulator& simulator)
{
  for (int body = 0; body < 3; ++body)
    EXPECT_NEAR(simulator.velocity(body)[0], 1.0 / 3.0, 2e-2) << body;
  EXPECT_NEAR(simulator.velocity(2)[1], 1.0, 1e-2);
}

TEST(ContactSetTest, WhatIsHitInsideAStepIsNoGhost)
{
  // Nothing at the start of a step closes b and c: their row comes with the answer in which a has hit b, and curves
  // away by 2e-6 m. Once in, it stays: no round without it.
  AuditedSimulator simulator(threeBalls(2.55e-3));
  int most = 0;
  for (int k = 0; k < 10; ++k)
  {
    simulator.step();
    most = std::max(most, simulator.report().contact_rounds);
  }
  EXPECT_EQ(most, 1);
  expectOneVelocity(simulator);
}

TEST(ContactSetTest, TheImpactAtTheStartMeetsWhatItCloses)
{
  // a hits b in the impact before the first step, after which b would be 0.1 mm in c at the first midpoint.
  AuditedSimulator simulator(threeBalls(1e-4));
  for (int k = 0; k < 10; ++k)
    simulator.step();
  expectOneVelocity(simulator);
}

TEST(ContactSetTest, ABoxOnTheEdgeOfATableFallsOffIt)
{
  // Its corners' rows reach beyond the table's face, its edge does not: nothing may hold it up there.
  Scenario scene = groundScene(0.3);
  scene.ground.reset();
  BodySpec& table = addBody(scene, "table", boxUrdf({1.0, 1.0, 0.2}, 1.0), poseAt(-0.5, 0.0, -0.1));
  table.base = BaseType::FIXED;
  BodySpec& box = addBody(scene, "box", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(-0.2, 0.0, 0.05));
  box.linear_velocity = {2.5, 0.0, 0.0};
  AuditedSimulator simulator(scene);
  while (simulator.time() < 0.5)
    simulator.step();
  EXPECT_LT(height(simulator, 1), -0.2);
}

/** The end of a case of ../shared/field; nullptr, with a word, where it is not there. */
std::unique_ptr<AuditedSimulator> run(const std::string& file)
{
  if (!std::filesystem::exists(field(file)))
  {
    std::printf("skipped: no %s\n", field(file).c_str());
    return nullptr;
  }
  const Scenario scenario = loadScenarioFile(field(file));
  auto simulator = std::make_unique<AuditedSimulator>(scenario);
  while (simulator->time() < scenario.duration)
    simulator->step();
  return simulator;
}

double normalForce(const Simulator& simulator)
{
  double force = 0.0;
  for (const ContactState& contact : simulator.contacts())
    force += contact.impulse.z() / simulator.report().dt;
  return force;
}

TEST(FilletedSoleTest, APressedFootRestsOnItsSole)
{
  for (const auto& [file, force] : {std::pair<const char*, double>{"filleted_sole/press_20N.yaml", 24.905},
                                    std::pair<const char*, double>{"filleted_sole/press_300N.yaml", 304.905}})
  {
    const auto simulator = run(file);
    if (!simulator)
      return;
    EXPECT_NEAR(height(*simulator), 0.03, 1e-6) << file;
    EXPECT_NEAR(normalForce(*simulator), force, 1e-5) << file;
    EXPECT_LT(simulator->velocity(0).norm(), 1e-6) << file;
  }
}

TEST(FilletedSoleTest, ATossedFootComesToRestOnAFace)
{
  const auto simulator = run("filleted_sole/toss.yaml");
  if (simulator)
  {
    EXPECT_LT(simulator->velocity(0).norm(), 1e-3);
    EXPECT_NEAR(normalForce(*simulator), 0.5 * GRAVITY, 1e-3);
  }
}

TEST(FilletedSoleTest, ALightFootStaysOnTheGroundUnderAFallingMast)
{
  run("filleted_sole/mast.yaml");  // the audit's penetration check is the assertion
}

TEST(MeshPileTest, TyresAndShoesStayOutOfEachOther)
{
  for (const char* file : {"mesh_pile/tyre_shoe.yaml", "mesh_pile/tyre_shoe_2.yaml", "mesh_pile/shoe_shoe.yaml"})
    run(file);
}
}  // namespace
}  // namespace frictional_contact_sim
