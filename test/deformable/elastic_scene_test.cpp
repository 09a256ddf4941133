// Elastic bodies and rods among others: welds, loops, overlaps at the start, wrenches, states from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/deformable/super_helix.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/dice.h"
#include "support/message_of.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;
using test_support::list;
using test_support::messageOf;
using testing::HasSubstr;

const char* const MATERIAL = "young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000";

std::string block(const std::string& name, const std::string& size, const std::string& cells,
                  const Eigen::Vector3d& place, const std::string& more = "", const std::string& beside = "")
{
  return "  - name: " + name + "\n    elastic: {box: " + size + ", cells: " + cells + ", " + MATERIAL + more +
         "}\n    pose: {xyz: " + list(place) + "}\n" + beside;
}

std::string rod(const std::string& name, const Eigen::Vector3d& place, const std::string& more = "",
                const std::string& beside = "")
{
  return "  - name: " + name + "\n    rod: {length: 0.2, radius: 0.002, density: 1300, young_modulus: 1.0e9" + more +
         "}\n    pose: {xyz: " + list(place) + "}\n" + beside;
}

BodySpec rigidBox(const std::string& name, const Eigen::Vector3d& place, double side = 0.1)
{
  const std::string size = test_support::text(side);
  BodySpec body;
  body.name = name;
  body.urdf_xml = "<robot name='r'><link name='" + name +
                  "'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/>"
                  "</inertial><collision><geometry><box size='" +
                  size + ' ' + size + ' ' + size + "'/></geometry></collision></link></robot>";
  body.base = BaseType::FLOATING;
  body.pose = Eigen::Isometry3d::Identity();
  body.pose->translation() = place;
  return body;
}

std::string loadingMessage(const std::string& yaml)
{
  return messageOf([&] { Simulator simulator(loadScenario(yaml, "test.yaml")); });
}

TEST(ElasticWeldTest, AWeldElsewhereLeavesTheContactsOfDeformableBodies)
{
  // Block, rod and rigid boxes at rest; then two of the boxes are welded, and a third to the world.
  Scenario scenario = loadScenario("time_step: 0.001\nground: {friction: 0.5}\nbodies:\n" +
                                       block("block", "[0.1, 0.1]", "[4, 4]", {0.0, 0.0, 0.05}, ", damping: 0.002") +
                                       rod("hair", {0.5, 0.0, 0.004}, ", sections: 4"),
                                   "test");
  scenario.bodies.push_back(rigidBox("one", {1.0, 0.0, 0.05}));
  scenario.bodies.push_back(rigidBox("two", {1.2, 0.0, 0.05}));
  scenario.bodies.push_back(rigidBox("three", {1.5, 0.0, 0.05}));
  Simulator simulator(scenario);
  const auto run = [&](int steps)
  {
    for (int step = 0; step < steps; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      for (int body = 0; body < simulator.bodyCount(); ++body)
        for (const Eigen::Isometry3d& pose : simulator.data(body).link_pose)
          ASSERT_GT(pose.translation().z(), -1e-6) << simulator.bodyName(body) << " at " << simulator.time();
    }
  };
  run(100);
  ASSERT_TRUE(simulator.attach({2, "one"}, {3, "two"}).converged());
  run(200);
  ASSERT_TRUE(simulator.attach({4, "three"}, {}).converged());
  run(200);
  for (const int body : {0, 1})
    EXPECT_TRUE(std::any_of(simulator.contacts().begin(), simulator.contacts().end(),
                            [&](const ContactState& contact)
                            { return simulator.shape(contact.shape_a).body == body && contact.impulse.z() > 0.0; }))
        << simulator.bodyName(body) << " is carried";
}

TEST(ElasticWeldTest, WeldsAndLoopsToDeformableBodiesAreRefusedByName)
{
  const std::string bodies =
      "bodies:\n" + block("jelly", "[0.1, 0.1]", "[2, 2]", {0.0, 0.0, 1.0}) + rod("hair", {0.5, 0.0, 1.0}, "");
  Scenario scenario = loadScenario(bodies, "test");
  scenario.bodies.push_back(rigidBox("box", {1.0, 0.0, 1.0}));
  Simulator simulator(scenario);
  for (const int body : {0, 1})
  {
    const std::string& name = simulator.bodyName(body);
    for (const LinkRef& other : {LinkRef{2, "box"}, LinkRef{}})
    {
      EXPECT_THAT(messageOf(
                      [&] {
                        simulator.attach({body, name}, other);
                      }),
                  HasSubstr("body '" + name + "' is deformable"));
      EXPECT_THAT(messageOf(
                      [&] {
                        simulator.attach(other, {body, name});
                      }),
                  HasSubstr("body '" + name + "' is deformable"));
    }
    SimulationState state = simulator.state();
    Closure weld;
    weld.body_a = 2;
    weld.frame_a = 0;
    weld.body_b = body;
    weld.frame_b = 0;
    state.rows.welds.push_back(weld);
    EXPECT_THAT(messageOf([&] { simulator.setState(state); }), HasSubstr("deformable"));
    EXPECT_THAT(loadingMessage(bodies + "loops:\n  - {type: point, a: {body: " + name + ", link: " + name +
                               "}, b: {body: world, xyz: [0, 0, 1]}}\n"),
                HasSubstr("body '" + name + "' is deformable"));
  }
  EXPECT_TRUE(simulator.welds().empty());
  EXPECT_TRUE(simulator.step().converged());
}

TEST(ElasticPlacementTest, ABodyThatTouchesNothingStaysWhereItIs)
{
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("elastic_scene_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "nodes.csv") << "x, y, z, surface\n0, 0, 0, 0\n1, 0, 0, 0\n";
  const std::string header = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n";
  std::ofstream(folder / "M.mtx") << header << "1 1 2\n2 1 1\n2 2 2\n";
  std::ofstream(folder / "K.mtx") << header << "1 1 9\n2 1 -9\n2 2 9\n";
  const std::string yaml = "ground: {}\nbodies:\n  - name: ghost\n    elastic: {mass: " + (folder / "M.mtx").string() +
                           ", stiffness: " + (folder / "K.mtx").string() +
                           ", nodes: " + (folder / "nodes.csv").string() + "}\n";
  Simulator simulator(loadScenario(yaml, "test"));
  EXPECT_TRUE(simulator.data(0).base_pose.matrix().isIdentity(0.0));
  for (int step = 0; step < 10; ++step)
  {
    ASSERT_TRUE(simulator.step().converged());
    ASSERT_TRUE(simulator.data(0).base_pose.matrix().allFinite());
  }
  std::filesystem::remove_all(folder);
}

class OverlapTest : public testing::TestWithParam<int>
{
protected:
  std::string small(const std::string& name, const Eigen::Vector3d& place) const
  {
    if (GetParam() == 1)
      return "  - name: " + name + "\n    elastic: {bar: 0.1, cells: 4, " + MATERIAL +
             "}\n    pose: {xyz: " + list(place) + "}\n";
    return GetParam() == 2 ? block(name, "[0.1, 0.1]", "[4, 4]", place)
                           : block(name, "[0.1, 0.1, 0.1]", "[4, 4, 4]", place);
  }
  std::string scene(const Eigen::Vector3d& shift) const
  {
    return "gravity: [0, 0, 0]\nbodies:\n" + small("one", {0.0, 0.0, 1.0}) +
           small("two", Eigen::Vector3d(0.0, 0.0, 1.0) + shift);
  }
};

TEST_P(OverlapTest, DeeperThanACellIsRefusedAndLessIsAWarning)
{
  // Shifts along x: the overlap is 0.1 - shift, a cell 0.025.
  for (const double depth : {0.026, 0.04, 0.049})
    for (const double sign : {-1.0, 1.0})
    {
      const std::string message = loadingMessage(scene({sign * (0.1 - depth), 0.0, 0.0}));
      EXPECT_THAT(message, HasSubstr("deep in elastic body"));
      EXPECT_THAT(message, HasSubstr("'one'"));
      EXPECT_THAT(message, HasSubstr("'two'"));
    }
  for (const double depth : {0.001, 0.01, 0.024})
  {
    Simulator simulator(loadScenario(scene({0.1 - depth, 0.0, 0.0}), "test"));
    EXPECT_THAT(simulator.warnings(), testing::Contains(HasSubstr("deep in elastic body"))) << depth;
  }
  for (const double gap : {0.0, 1e-6, 0.02})
  {
    Simulator simulator(loadScenario(scene({0.1 + gap, 0.0, 0.0}), "test"));
    EXPECT_THAT(simulator.warnings(), testing::IsEmpty()) << gap;
  }
  // Beside it, in whatever direction a bar or plane body does not have.
  Simulator beside(loadScenario(scene({0.02, GetParam() == 3 ? 0.11 : 0.1, 0.0}), "test"));
  EXPECT_THAT(beside.warnings(), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Dimensions, OverlapTest, testing::Values(1, 2, 3));

TEST(ElasticOverlapTest, WhatIsWhollyInsideIsRefusedTooAndASpawnedBodyAlways)
{
  const std::string large =
      "gravity: [0, 0, 0]\nbodies:\n" + block("large", "[0.6, 0.6, 0.6]", "[4, 4, 4]", {0.0, 0.0, 1.0});
  Dice dice(5);
  for (int draw = 0; draw < 5; ++draw)
  {
    const Eigen::Vector3d place = Eigen::Vector3d(0.0, 0.0, 1.0) + dice.vector(0.09);
    EXPECT_THAT(loadingMessage(large + block("inner", "[0.05, 0.05, 0.05]", "[2, 2, 2]", place)),
                HasSubstr("body 'inner' starts"));
    EXPECT_THAT(loadingMessage(large + rod("inner", place)), HasSubstr("body 'inner' starts"));
    Scenario scenario = loadScenario(large, "test");
    scenario.bodies.push_back(rigidBox("inner", place, 0.02));
    EXPECT_THAT(messageOf([&] { Simulator simulator(scenario); }), HasSubstr("body 'inner' starts"));
    // At 0.02 m below a face a load warns, while who spawns is refused.
    Simulator simulator(loadScenario(large, "test"));
    const Scenario other =
        loadScenario("bodies:\n" + block("late", "[0.2, 0.2, 0.2]", "[2, 2, 2]", {0.38, place.y(), place.z()}), "test");
    EXPECT_THAT(messageOf([&] { simulator.spawn(other.bodies.front()); }), HasSubstr("expected a free place"));
    EXPECT_EQ(simulator.bodyCount(), 1);
  }
}

TEST(ElasticWrenchTest, TorquesOnElasticBodiesAreRefusedEverywhere)
{
  Simulator simulator(
      loadScenario("bodies:\n" + block("jelly", "[0.1, 0.1]", "[2, 2]", {0.0, 0.0, 1.0}, ", fixed: [top]"), "test"));
  ExternalWrench wrench;
  wrench.link = "jelly";
  wrench.torque = Eigen::Vector3d(0.0, 1e-9, 0.0);
  EXPECT_THAT(messageOf([&] { simulator.addWrench(0, wrench); }),
              HasSubstr("body 'jelly': found a torque, expected a force alone"));
  EXPECT_THAT(messageOf([&] { simulator.replaceWrench(0, wrench); }), HasSubstr("expected a force alone"));
  SimulationState state = simulator.state();
  state.bodies[0].wrenches.push_back(wrench);
  state.bodies[0].wrenches.back().frame = 0;
  EXPECT_THAT(messageOf([&] { simulator.setState(state); }), HasSubstr("expected a force alone"));
  EXPECT_TRUE(simulator.state().bodies[0].wrenches.empty());
  wrench.torque.setZero();
  wrench.force = Eigen::Vector3d(1.0, 0.0, 0.0);
  simulator.addWrench(0, wrench);
  ASSERT_TRUE(simulator.step().converged());
  EXPECT_GT(simulator.velocity(0).norm(), 0.0);
}

/** A rod along x without gravity, in one step from rest to rest: to first order the beam of the textbooks. */
Eigen::VectorXd bent(const ExternalWrench& wrench, int pieces)
{
  Simulator simulator(loadScenario("quasi_static: true\ngravity: [0, 0, 0]\nbodies:\n" +
                                       rod("hair", {0.0, 0.0, 1.0}, ", pieces: " + std::to_string(pieces)),
                                   "test"));
  simulator.addWrench(0, wrench);
  EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  return simulator.position(0);
}

TEST(RodWrenchTest, CurvaturesAreTheMomentsOverTheStiffness)
{
  // kappa_2 = M_2/(E I), kappa_3 = M_3/(E I), twist = M_1/(G J): of a force at s, a moment force x (s - x) along the
  // rod, whose mean over a piece is what a piece of constant curvature has.
  const double inertia = 0.25 * 3.141592653589793 * std::pow(0.002, 4);
  constexpr double E = 1.0e9;
  const double twisting = 2.0 * inertia * E / 3.0;  // nu = 0.5
  constexpr int PIECES = 5;
  constexpr double PIECE = 0.2 / PIECES;
  Dice dice(11);
  for (int draw = 0; draw < 10; ++draw)
  {
    ExternalWrench wrench;
    wrench.link = "hair";
    wrench.world_frame = dice.chance(0.5);
    wrench.force = 1e-4 * dice.vector(1.0);
    wrench.torque = 1e-5 * dice.vector(1.0);
    wrench.point =
        Eigen::Vector3d(dice.uniform(0.0, 0.2), 1e-3 * dice.uniform(-1.0, 1.0), 1e-3 * dice.uniform(-1.0, 1.0));
    const Eigen::VectorXd q = bent(wrench, PIECES);
    for (int k = 0; k < PIECES; ++k)
    {
      // Mean over the piece of what the wrench makes on a cross-section at x < s.
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      constexpr int SAMPLES = 2000;
      for (int i = 0; i < SAMPLES; ++i)
        if (const double x = (k + (i + 0.5) / SAMPLES) * PIECE; x < wrench.point.x())
        {
          const Eigen::Vector3d arm(wrench.point.x() - x, wrench.point.y(), wrench.point.z());
          mean += (wrench.torque + arm.cross(wrench.force)) / SAMPLES;
        }
      const Eigen::Vector3d expected(mean[0] / twisting, mean[1] / (E * inertia), mean[2] / (E * inertia));
      // A section is the least that a rod knows of: eight a piece.
      const double largest = (wrench.torque.norm() + 0.2 * wrench.force.norm()) / (E * inertia);
      EXPECT_LT((q.segment<3>(3 * k) - expected).norm(),
                (k == static_cast<int>(wrench.point.x() / PIECE) ? 0.1 : 1e-6) * largest)
          << "piece " << k << " draw " << draw;
    }
  }
}

TEST(RodWrenchTest, ItsWorkIsInTheLedger)
{
  Simulator simulator(
      loadScenario("time_step: 0.0001\nbodies:\n" +
                       rod("hair", {0.0, 0.0, 1.0}, ", damping: 0.001",
                           "    wrenches: [{link: hair, force: [0, 0.01, 0.02], torque: [1.0e-5, 0, 0], "
                           "point: [0.2, 0, 0], until: 0.05}]\n"),
                   "test"));
  double work = 0.0;
  while (simulator.time() < 0.1)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    const EnergyLedger& energy = simulator.report().energy;
    work = std::max(work, std::abs(energy.actuators));
    EXPECT_LT(std::abs(energy.balance_error), 1e-3 * std::max(work, 1e-6)) << "of order two at " << simulator.time();
  }
  EXPECT_GT(work, 1e-6);
}

TEST(ElasticSizeTest, CellsAndSectionsInAllAreBounded)
{
  const auto cells = [](const std::string& what)
  { return loadingMessage("bodies:\n  - name: big\n    elastic: {" + what + ", " + MATERIAL + "}\n"); };
  for (const char* const what :
       {"box: [1, 1], cells: [1000000, 1000000]", "box: [1, 1, 1], cells: [1290, 1290, 1291]",
        "box: [1, 1, 1], cells: [1000000, 1000000, 1000000]", "box: [1, 1], cells: [65536, 65536]"})
    EXPECT_THAT(cells(what), testing::AllOf(HasSubstr("cells"), HasSubstr("100000")));
  EXPECT_THAT(cells("bar: 1, cells: 100001"), HasSubstr("expected an integer in [1, 1e+05]"));
  EXPECT_THAT(loadingMessage("bodies:\n" + rod("hair", {0.0, 0.0, 1.0}, ", pieces: 1000, sections: 1000")),
              testing::AllOf(HasSubstr("pieces"), HasSubstr("2000000")));
  EXPECT_EQ(loadingMessage("bodies:\n" + rod("hair", {0.0, 0.0, 1.0}, ", pieces: 1, sections: 1000")), "no error");
}

TEST(ElasticSceneTest, YoungModulusOfARodIsOneOrOneAPiece)
{
  const auto with = [](const std::string& young)
  {
    return loadingMessage(
        "bodies:\n  - name: hair\n    rod: {length: 0.2, radius: 0.002, pieces: 3, density: 1300, "
        "young_modulus: " +
        young + "}\n    pose: {xyz: [0, 0, 1]}\n");
  };
  EXPECT_EQ(with("1.0e7"), "no error");
  EXPECT_EQ(with("[1.0e7, 2.0e7, 3.0e7]"), "no error");
  for (const char* const wrong : {"[1.0e7, 2.0e7]", "[]", "[1.0e7]"})
    EXPECT_THAT(with(wrong), testing::AllOf(HasSubstr("young_modulus"), HasSubstr("one for each of 3 pieces")))
        << wrong;
  for (const char* const wrong : {"0", "-1", ".nan", "stiff", "[1.0e7, 0, 1.0e7]", "{a: 1}"})
    EXPECT_THAT(with(wrong), HasSubstr("young_modulus")) << wrong;
}

}  // namespace
}  // namespace frictional_contact_sim
