// Bodies spawned and removed in a run: the others do not notice, what was built on them does.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"
#include "support/run_audit.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::RunAudit;

BodySpec boxAt(const std::string& name, double x, double y, double z, double size = 0.2)
{
  Scenario holder;
  return addBody(holder, name, boxUrdf({size, size, size}, 1.0), poseAt(x, y, z));
}

LinkRef root(int body)
{
  return {body, "body"};
}

void run(Simulator& simulator, int steps)
{
  RunAudit audit(simulator);
  for (int i = 0; i < steps; ++i)
  {
    audit.beforeStep();
    simulator.step();
    audit.afterStep();
  }
  if (simulator.bodyCount() == 0)  // all that is left of the ledger is round-off
  {
    EXPECT_TRUE(simulator.outcome().converged());
    return;
  }
  for (const std::string& fault : audit.faults())
    ADD_FAILURE() << fault;
}

/** q and v of a body, by name. */
Eigen::VectorXd motionOf(const Simulator& simulator, const std::string& name)
{
  const int body = simulator.findBody(name);
  Eigen::VectorXd motion(simulator.position(body).size() + simulator.velocity(body).size());
  motion << simulator.position(body), simulator.velocity(body);
  return motion;
}

/** Sum of the contact forces on a body from bodies below it or the ground [N]. */
double supportOf(const Simulator& simulator, int body)
{
  double force = 0.0;
  for (const ContactState& contact : simulator.contacts())
  {
    if (simulator.shape(contact.shape_a).body == body)
      force += contact.impulse.z() / 0.001;
    if (simulator.shape(contact.shape_b).body == body)
      force -= contact.impulse.z() / 0.001;
  }
  return force;
}

void expectRefused(Simulator& simulator, const std::function<void()>& request, const std::string& text)
{
  const std::uint64_t hash = simulator.stateHash();
  const int bodies = simulator.bodyCount();
  try
  {
    request();
    ADD_FAILURE() << "not refused, expected: " << text;
  }
  catch (const std::exception& error)
  {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
  EXPECT_EQ(simulator.stateHash(), hash);
  EXPECT_EQ(simulator.bodyCount(), bodies);
  simulator.step();
  EXPECT_TRUE(simulator.outcome().converged());
}

/** Two boxes at rest, a robot that stands, a box that slides, a ball in free flight. */
Scenario mixedScene()
{
  Scenario scenario = loadScenarioFile(std::string(PROJECT_DIR) + "/config/scenarios/quadruped.yaml");
  scenario.bodies.push_back(boxAt("lower", 3, 0, 0.1));
  scenario.bodies.push_back(boxAt("upper", 3, 0, 0.3));
  scenario.bodies.push_back(boxAt("slider", 5, 0, 0.1));
  scenario.bodies.back().linear_velocity = {2.0, 0.3, 0.0};
  addBody(scenario, "ball", sphereUrdf(0.1, 1.0), poseAt(-3, 0, 5)).angular_velocity = {1.0, 2.0, 3.0};
  return scenario;
}

TEST(WorldChangeTest, OthersGoOnToTheBit)
{
  const Scenario scenario = mixedScene();
  Simulator alone(scenario);
  Simulator changed(scenario);
  for (int i = 0; i < 400; ++i)
  {
    if (i == 100)
    {
      ASSERT_TRUE(changed.spawn(boxAt("visitor", -6, 0, 0.1)).taken);
      BodySpec robot = scenario.bodies.front();
      robot.name = "second robot";
      robot.pose = poseAt(0, 4, 1);
      ASSERT_TRUE(changed.spawn(robot).taken);
    }
    if (i == 200)
      changed.remove("visitor");
    if (i == 300)
      changed.remove("second robot");
    alone.step();
    changed.step();
    ASSERT_TRUE(changed.outcome().converged()) << changed.outcome().message;
    for (int body = 0; body < alone.bodyCount(); ++body)
    {
      const std::string& name = alone.bodyName(body);
      ASSERT_EQ(motionOf(changed, name), motionOf(alone, name)) << name << ", step " << i;
    }
    EXPECT_EQ(changed.bodyCount(), alone.bodyCount() + (i < 100 ? 0 : i < 200 ? 2 : i < 300 ? 1 : 0));
  }
  EXPECT_EQ(changed.state().step, alone.state().step);
  EXPECT_EQ(changed.time(), alone.time());
  ASSERT_EQ(changed.contacts().size(), alone.contacts().size());
  for (size_t i = 0; i < alone.contacts().size(); ++i)
  {
    EXPECT_EQ(changed.contacts()[i].id, alone.contacts()[i].id);
    EXPECT_EQ(changed.contacts()[i].impulse, alone.contacts()[i].impulse);
  }
  EXPECT_NEAR(changed.report().energy.balance_error, alone.report().energy.balance_error, 1e-6);
}

TEST(WorldChangeTest, ABodySpawnedOntoAPileAtRestIsCarriedByIt)
{
  Scenario scenario = groundScene(0.6);
  scenario.bodies.push_back(boxAt("lower", 0, 0, 0.1));
  scenario.bodies.push_back(boxAt("upper", 0, 0, 0.3));
  Simulator simulator(scenario);
  run(simulator, 100);
  const Eigen::VectorXd lower = simulator.position(0);
  const Eigen::VectorXd upper = simulator.position(1);
  ASSERT_TRUE(simulator.spawn(boxAt("top", 0, 0, 0.5)).taken);
  EXPECT_EQ(simulator.position(0), lower) << "nothing has moved by the spawn itself";
  EXPECT_EQ(simulator.report().step, 100U);
  run(simulator, 500);
  EXPECT_NEAR(supportOf(simulator, 2), GRAVITY, 1e-7);
  EXPECT_NEAR(supportOf(simulator, 0), GRAVITY, 1e-7) << "what the ground gives less what the two above press";
  EXPECT_LE((simulator.position(0) - lower).norm(), 1e-9);
  EXPECT_LE((simulator.position(1) - upper).norm(), 1e-9);
  EXPECT_NEAR(simulator.position(2).z(), 0.5, 1e-9);
  EXPECT_LE(std::abs(simulator.report().energy.balance_error), 1e-9) << "a new body's energy is no work";
}

TEST(WorldChangeTest, WithoutTheLowerBoxTheUpperFalls)
{
  Scenario scenario = groundScene(0.6);
  scenario.bodies.push_back(boxAt("lower", 0, 0, 0.1));
  scenario.bodies.push_back(boxAt("upper", 0, 0, 0.3));
  scenario.bodies.push_back(boxAt("bystander", 2, 0, 0.1));
  Simulator simulator(scenario);
  run(simulator, 100);
  const Eigen::VectorXd bystander = simulator.position(2);
  simulator.remove("lower");
  ASSERT_EQ(simulator.bodyCount(), 2);
  EXPECT_EQ(simulator.bodyName(0), "upper");
  run(simulator, 100);
  EXPECT_NEAR(simulator.velocity(0)[2], -GRAVITY * 0.1, 1e-9) << "free fall from the step after";
  EXPECT_LE((simulator.position(1) - bystander).norm(), 1e-15);
  run(simulator, 400);
  EXPECT_NEAR(simulator.position(0).z(), 0.1, 1e-7);
  EXPECT_NEAR(supportOf(simulator, 0), GRAVITY, 1e-6);
  EXPECT_LE(std::abs(simulator.report().energy.balance_error), 1e-3);
}

TEST(WorldChangeTest, AnEmptyWorldMayBeFilled)
{
  Scenario scenario = groundScene(0.6);
  scenario.bodies.push_back(boxAt("only", 0, 0, 0.1));
  Simulator simulator(scenario);
  simulator.remove("only");
  EXPECT_EQ(simulator.bodyCount(), 0);
  for (int i = 0; i < 10; ++i)
    ASSERT_TRUE(simulator.step().converged());
  BodySpec box = boxAt("again", 0, 0, 0.0);
  box.pose.reset();
  ASSERT_TRUE(simulator.spawn(box).taken);
  EXPECT_NEAR(simulator.position(0).z(), 0.101, 1e-12) << "without a pose a millimetre above the ground";
  run(simulator, 100);
  EXPECT_NEAR(supportOf(simulator, 0), GRAVITY, 1e-6);
}

TEST(WorldChangeTest, ABodySpawnedInMotionHitsWhatItTouches)
{
  Scenario scenario = groundScene(0.0, 0.5);
  scenario.bodies.push_back(boxAt("far", 5, 0, 3));
  scenario.bodies.back().angular_velocity = {1.0, 2.0, 0.5};
  Simulator simulator(scenario);
  run(simulator, 10);
  const Eigen::VectorXd far = motionOf(simulator, "far");
  BodySpec ball = boxAt("ball", 0, 0, 0.1);
  ball.urdf_xml = sphereUrdf(0.1, 1.0);
  ball.linear_velocity = {0.0, 0.0, -2.0};
  ASSERT_TRUE(simulator.spawn(ball).taken);
  EXPECT_NEAR(simulator.velocity(1)[2], 1.0, 1e-9) << "restitution 0.5";
  EXPECT_EQ(motionOf(simulator, "far"), far) << "an impact that does not concern it";
  EXPECT_NEAR(simulator.report().energy.impact, 0.5 * (4.0 - 1.0), 1e-9);
}

TEST(WorldChangeTest, ResetTakesASpawnedBodyToWhereItWasSpawned)
{
  Scenario scenario = groundScene(0.6);
  scenario.bodies.push_back(boxAt("first", 0, 0, 0.101));
  Simulator simulator(scenario);
  run(simulator, 50);
  BodySpec spec = boxAt("second", 1, 0, 1.0);
  spec.linear_velocity = {0.5, 0.0, 0.0};
  simulator.spawn(spec);
  std::vector<std::uint64_t> hashes;
  std::vector<Eigen::VectorXd> motions;
  for (int round = 0; round < 2; ++round)
  {
    simulator.reset();
    EXPECT_EQ(simulator.bodyCount(), 2);
    EXPECT_NEAR(simulator.position(0).z(), 0.101, 1e-15);
    EXPECT_NEAR(simulator.position(1).z(), 1.0, 1e-15);
    EXPECT_EQ(simulator.velocity(1).head<3>(), spec.linear_velocity);
    EXPECT_EQ(simulator.contacts().size(), 0U);
    run(simulator, 600);
    motions.push_back(motionOf(simulator, "second"));
    EXPECT_LE(std::abs(simulator.report().energy.balance_error), 1e-3);
  }
  EXPECT_EQ(motions[0], motions[1]) << "a reset gives the same bits again";
}

TEST(WorldChangeTest, WeldsGoOverAndEndWithTheirBodies)
{
  Scenario scenario = groundScene(0.6);
  for (const char* name : {"a", "b", "c"})
    scenario.bodies.push_back(boxAt(name, name[0] - 'a', 0, 2));
  Simulator simulator(scenario);
  simulator.attach(root(1), {});
  simulator.attach(root(2), root(1));
  simulator.attach(root(0), {});
  run(simulator, 10);
  simulator.spawn(boxAt("d", 0, 2, 0.1));
  ASSERT_EQ(simulator.welds().size(), 3U);
  run(simulator, 10);
  simulator.remove("a");  // b, c, d are 0, 1, 2 now
  ASSERT_EQ(simulator.welds().size(), 2U);
  EXPECT_EQ(simulator.welds()[1].body_a, 1);
  EXPECT_EQ(simulator.welds()[1].body_b, 0);
  run(simulator, 10);
  EXPECT_NEAR(simulator.weldWrench(0)[2], 2.0 * GRAVITY, 1e-7);
  EXPECT_NEAR(simulator.position(1).z(), 2.0, 1e-9);
  simulator.remove("b");
  EXPECT_TRUE(simulator.welds().empty());
  run(simulator, 100);
  EXPECT_NEAR(simulator.velocity(0)[2], -GRAVITY * 0.1, 1e-9) << "c falls";
  simulator.reset();
  EXPECT_EQ(simulator.bodyCount(), 2);
  EXPECT_TRUE(simulator.welds().empty()) << "the start had none";
  run(simulator, 10);
}

TEST(WorldChangeTest, WhatDoesNotFitIsRefused)
{
  Scenario scenario = groundScene(0.6);
  scenario.bodies.push_back(boxAt("box", 0, 0, 0.1));
  Simulator simulator(scenario);
  run(simulator, 5);
  const auto spawns = [&](const BodySpec& spec) { return [&simulator, spec]() { simulator.spawn(spec); }; };
  expectRefused(simulator, spawns(boxAt("", 2, 0, 1)), "name: found none");
  expectRefused(simulator, spawns(boxAt("box", 2, 0, 1)), "name: found 'box', expected one that no body has yet");
  expectRefused(simulator, spawns(boxAt("inside", 0.1, 0, 0.1)),
                "body 'box' (link 'body') starts 0.1 m deep in body 'inside' (link 'body'), expected a free place");
  expectRefused(simulator, spawns(boxAt("under", 2, 0, 0.05)), "deep in the ground, expected a free place");
  expectRefused(simulator, spawns(boxAt("nowhere", std::nan(""), 0, 1)), "pose.xyz");
  BodySpec broken = boxAt("broken", 2, 0, 1);
  broken.urdf_xml = "<robot name='x'>";
  expectRefused(simulator, spawns(broken), "robot_description");
  BodySpec fast = boxAt("fast", 2, 0, 1);
  fast.linear_velocity.x() = 1e9;
  expectRefused(simulator, spawns(fast), "velocity.linear");
  expectRefused(
      simulator, [&]() { simulator.remove("bix"); }, "name: found 'bix', did you mean 'box'? expected one of box");
  EXPECT_NEAR(supportOf(simulator, 0), GRAVITY, 1e-7);
}

/** Whatever comes and goes: the audits hold, bodies keep their names, and a fresh simulator takes the state. */
TEST(WorldChangeTest, RandomSequencesKeepTheInvariants)
{
  int spawned = 0;
  int removed = 0;
  int refused = 0;
  for (unsigned seed = 1; seed <= 100; ++seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    Scenario scenario = groundScene(0.5);
    scenario.stopping.tolerance = 1e-10;
    Simulator simulator(scenario);
    std::map<std::string, int> alive;
    for (int i = 0; i < 12; ++i)
    {
      const std::string name = "body" + std::to_string(i);
      if (alive.empty() || number(random) < 0.4)
      {
        BodySpec spec = boxAt(name, 0.3 * number(random), 0.3 * number(random), 0.4 + 0.3 * number(random), 0.15);
        if (number(random) < 0.0)
          spec.urdf_xml = number(random) < 0.0 ? sphereUrdf(0.08, 0.5) : cylinderUrdf(0.06, 0.15, 0.7);
        spec.linear_velocity = {number(random), number(random), number(random)};
        spec.angular_velocity = {number(random), number(random), 5.0 * number(random)};
        try
        {
          ASSERT_TRUE(simulator.spawn(spec).taken) << simulator.outcome().message;
          alive[name] = simulator.bodyCount() - 1;
          ++spawned;
        }
        catch (const std::invalid_argument&)
        {
          ++refused;
        }
      }
      else
      {
        const auto victim =
            std::next(alive.begin(), std::uniform_int_distribution<int>(0, static_cast<int>(alive.size()) - 1)(random));
        simulator.remove(victim->first);
        alive.erase(victim);
        ++removed;
      }
      ASSERT_EQ(simulator.bodyCount(), static_cast<int>(alive.size()));
      for (const auto& entry : alive)
        ASSERT_GE(simulator.findBody(entry.first), 0);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", change " + std::to_string(i));
      run(simulator, 15);
      Simulator fresh(simulator.scenario());
      fresh.setState(simulator.state());
      ASSERT_EQ(fresh.stateHash(), simulator.stateHash());
      fresh.step();
      simulator.step();
      ASSERT_EQ(fresh.stateHash(), simulator.stateHash()) << "a world that grew is the one that is loaded whole";
    }
  }
  EXPECT_GT(spawned, 300);
  EXPECT_GT(removed, 100);
  EXPECT_GT(refused, 10);
}

/** Hulls of meshes that are known are not made again: what the file has become is not looked at. */
TEST(WorldChangeTest, MeshesAreReadOnce)
{
  const std::string path =
      std::filesystem::temp_directory_path() / ("world_change_" + std::to_string(getpid()) + ".obj");
  std::ofstream(path) << "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 0.2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  BodySpec spec = boxAt("first", 0, 0, 1);
  const size_t box = spec.urdf_xml.find("<box");
  spec.urdf_xml.replace(box, spec.urdf_xml.find("/>", box) + 2 - box, "<mesh filename='file://" + path + "'/>");
  Simulator simulator(groundScene(0.5));
  ASSERT_TRUE(simulator.spawn(spec).taken);
  std::ofstream(path) << "no longer a mesh";
  spec.name = "second";
  spec.pose = poseAt(1, 0, 1);
  ASSERT_TRUE(simulator.spawn(spec).taken);
  simulator.remove("first");
  spec.name = "third";
  spec.pose = poseAt(2, 0, 1);
  ASSERT_TRUE(simulator.spawn(spec).taken);
  for (int i = 0; i < 600; ++i)
    ASSERT_TRUE(simulator.step().converged());
  for (int body = 0; body < 2; ++body)
    EXPECT_LT(simulator.position(body).z(), 0.1) << "they fell and lie";
  spec.name = "fourth";
  spec.pose = poseAt(3, 0, 1);
  spec.urdf_xml.replace(spec.urdf_xml.find("<mesh"), 5, "<mesh scale='2 2 2'");
  expectRefused(
      simulator, [&]() { simulator.spawn(spec); }, "world_change_");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace frictional_contact_sim
