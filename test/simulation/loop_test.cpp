// Kinematic loops: closed at the start, closed after any number of steps, under contact and mass ratios; the motion of
// the same mechanism as a tree; what its forces do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/config/config_error.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/link_forces.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
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

Eigen::Isometry3d placement(const Eigen::Vector3d& position, const Eigen::Vector3d& axis)
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = position;
  pose.linear() = orientationAlong(axis);
  return pose;
}

TEST(LoopTest, AFourBarKeepsClosureAndEnergyForManyTurns)
{
  const FourBar bar;
  for (const std::string type : {"point", "axis"})
  {
    Scenario scenario = fourBarScene(bar, type, 0.8);
    scenario.gravity.setZero();
    scenario.bodies[0].joints["drive"].velocity = -9.0;
    AuditedSimulator simulator(scenario);
    EXPECT_THAT(simulator.warnings(), testing::Contains(testing::HasSubstr("was open by")));
    const double energy = energyOf(simulator);
    double fastest = 0.0;
    double worst = 0.0;
    double angle = 0.0;
    for (int step = 0; step < 20000; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      fastest = std::max(fastest, simulator.velocity(0).cwiseAbs().maxCoeff() * bar.coupler);
      worst = std::max(worst, openness(simulator, simulator.loops()[0]));
      angle = simulator.position(0)[0];
      // The loop joint sees the midpoints: at the end the two are apart by a chord's height at most.
      if (step > 0)  // the start is closed at its own pose, not at the first midpoint
      {
        ASSERT_LE(simulator.report().bilateral_violation, 1e-9) << step;
      }
    }
    EXPECT_LE(worst, 2.0 * 1e-6 * fastest * fastest / bar.rocker);
    EXPECT_GT(std::abs(angle), 6.0 * M_PI);  // it has turned, three times at the least
    EXPECT_NEAR(energyOf(simulator), energy, 1e-4 * simulator.report().energy.kinetic + 1e-4);
  }
}

/** Rocker's angle of the closed four-bar by the law of cosines: where circles about both pivots meet. */
double gapOfCircles(const FourBar& bar, double drive, double knee, double pivot)
{
  const double x =
      bar.crank * std::cos(drive) + bar.coupler * std::cos(drive + knee) - bar.ground - bar.rocker * std::cos(pivot);
  const double z = -bar.crank * std::sin(drive) - bar.coupler * std::sin(drive + knee) + bar.rocker * std::sin(pivot);
  return std::hypot(x, z);
}

TEST(LoopTest, AStartThatDoesNotCloseIsClosedByTheJointsThatNobodySet)
{
  Dice dice(20261128);
  for (int trial = 0; trial < 40; ++trial)
  {
    FourBar bar;
    bar.crank = dice.uniform(0.1, 0.22);
    bar.coupler = dice.uniform(0.4, 0.5);
    bar.rocker = dice.uniform(0.35, 0.45);
    const double drive = dice.uniform(-3.0, 3.0);
    Scenario scenario = fourBarScene(bar, dice.chance(0.5) ? "point" : "axis", drive);
    scenario.gravity.setZero();
    AuditedSimulator simulator(scenario);
    const Eigen::VectorXd q = simulator.position(0);
    EXPECT_EQ(q[0], drive);
    EXPECT_LT(gapOfCircles(bar, q[0], q[1], q[2]), 1e-9);
    EXPECT_LT(openness(simulator, simulator.loops()[0]), 1e-9);
    // At rest nothing moves.
    for (int step = 0; step < 20; ++step)
      simulator.step();
    EXPECT_LT((simulator.position(0) - q).norm(), 1e-12);
    EXPECT_LT(openness(simulator, simulator.loops()[0]), 2e-10);
  }
}

TEST(LoopTest, WhatCannotBeClosedIsRefusedByName)
{
  FourBar bar;
  bar.ground = 2.0;
  try
  {
    Simulator simulator(fourBarScene(bar, "point", 0.0));
    ADD_FAILURE() << "was taken";
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("loop 'linkage/closure'"), testing::HasSubstr("cannot be closed")));
  }
}

TEST(LoopTest, RedundantRowsAreNamedAndChangeNoMotion)
{
  const FourBar bar;
  Simulator point(fourBarScene(bar, "point", 0.5));
  Simulator axis(fourBarScene(bar, "axis", 0.5));
  // In the plane two rows act: the third of a point, and with it both about axes, are the hinges' own.
  EXPECT_THAT(point.warnings(), testing::Contains(testing::HasSubstr("1 of its 3 rows")));
  EXPECT_THAT(axis.warnings(), testing::Contains(testing::HasSubstr("3 of its 5 rows")));
  for (int step = 0; step < 500; ++step)
  {
    ASSERT_TRUE(point.step().converged());
    ASSERT_TRUE(axis.step().converged()) << axis.outcome().message;
  }
  EXPECT_LT((point.position(0) - axis.position(0)).norm(), 1e-8);
}

/** The same four-bar cut elsewhere: all on the other side of the loop. */
TEST(LoopTest, TheSameMechanismCutElsewhereMovesTheSameToTheSchemesOrder)
{
  const FourBar bar;
  const double density = bar.mass / bar.crank;
  double difference[2] = {0.0, 0.0};
  for (const int halves : {0, 1})
  {
    Scenario one = fourBarScene(bar, "point", 0.8);
    one.time_step = 0.002 / (1 << halves);
    Simulator simulator(one);
    const Eigen::VectorXd q = simulator.position(0);
    // rocker - coupler as a chain, crank alone; closed at the knee
    const std::string urdf =
        "<robot name='other'><link name='frame'/>" + rodLink("crank", bar.crank, bar.mass) +
        rodLink("coupler", -bar.coupler, density * bar.coupler) + rodLink("rocker", bar.rocker, density * bar.rocker) +
        hinge("drive", "frame", "crank", 0.0) + hinge("pivot", "frame", "rocker", bar.ground) +
        hinge("wrist", "rocker", "coupler", bar.rocker) +
        "<loop_joint name='knee' type='point'><parent link='crank'/><child link='coupler'/><origin xyz='" +
        text(bar.crank) + " 0 0'/><child_origin xyz='" + text(-bar.coupler) + " 0 0'/></loop_joint></robot>";
    Scenario two = one;
    two.bodies.clear();
    BodySpec& body = addBody(two, "other", urdf, poseAt(0.0, 0.0, 1.0));
    body.base = BaseType::FIXED;
    body.joints["drive"].position = q[0];
    body.joints["pivot"].position = q[2];
    body.joints["wrist"].position = q[0] + q[1] - q[2];
    Simulator other(two);
    for (int step = 0; step < 150 * (1 << halves); ++step)
    {
      ASSERT_TRUE(simulator.step().converged());
      ASSERT_TRUE(other.step().converged());
    }
    EXPECT_GT((simulator.position(0) - q).norm(), 0.1);
    difference[halves] = std::abs(simulator.position(0)[0] - other.position(0)[0]);
  }
  EXPECT_LT(difference[0], 1e-3);
  EXPECT_LT(difference[1], 0.35 * difference[0] + 1e-12);  // a quarter
}

TEST(LoopTest, FreeRodsHeldByLoopsAloneMoveAsATree)
{
  // Maximal coordinates: a double pendulum of two free rods and three kinds of loops, beside the tree.
  const double length = 0.4;
  const auto rod = [&](const std::string& name)
  { return "<robot name='rod'>" + rodLink(name, length, 1.0) + "</robot>"; };
  double difference[2] = {0.0, 0.0};
  for (const int halves : {0, 1})
  {
    Scenario free = groundScene(0.5);
    free.ground.reset();
    free.time_step = 0.002 / (1 << halves);
    addBody(free, "upper", rod("upper"), poseAt(0.0, 0.0, 2.0));
    addBody(free, "lower", rod("lower"), poseAt(length, 0.0, 2.0));
    LoopSpec top{"top", LoopType::AXIS, {"upper", "upper"}, {}, ""};
    top.a.placement.linear() = orientationAlong(Eigen::Vector3d::UnitY());
    top.b.placement = placement({0.0, 0.0, 2.0}, Eigen::Vector3d::UnitY());
    LoopSpec middle{"middle", LoopType::AXIS, {"lower", "lower"}, {"upper", "upper"}, ""};
    middle.a.placement.linear() = orientationAlong(Eigen::Vector3d::UnitY());
    middle.b.placement = placement({length, 0.0, 0.0}, Eigen::Vector3d::UnitY());
    free.loops = {top, middle};
    AuditedSimulator loops(free);
    EXPECT_TRUE(loops.warnings().empty()) << testing::PrintToString(loops.warnings());

    Scenario tree = free;
    tree.loops.clear();
    tree.bodies.clear();
    addBody(tree, "pendulum",
            "<robot name='pendulum'><link name='frame'/>" + rodLink("upper", length, 1.0) +
                rodLink("lower", length, 1.0) + hinge("shoulder", "frame", "upper", 0.0) +
                hinge("elbow", "upper", "lower", length) + "</robot>",
            poseAt(0.0, 0.0, 2.0))
        .base = BaseType::FIXED;
    Simulator reference(tree);
    for (int step = 0; step < 300 * (1 << halves); ++step)
    {
      ASSERT_TRUE(loops.step().converged()) << loops.outcome().message;
      ASSERT_TRUE(reference.step().converged());
    }
    const auto tip = [&](const Simulator& simulator, int body)
    {
      const MultibodyModel& model = simulator.model(body);
      return Eigen::Vector3d(framePose(model, simulator.data(body), model.findFrame("lower")) *
                             Eigen::Vector3d(length, 0, 0));
    };
    EXPECT_GT((tip(reference, 0) - Eigen::Vector3d(2.0 * length, 0.0, 2.0)).norm(), 0.1);
    difference[halves] = (tip(loops, 1) - tip(reference, 0)).norm();
  }
  EXPECT_LT(difference[0], 5e-4);
  EXPECT_LT(difference[1], 0.35 * difference[0] + 1e-10);
}

TEST(LoopTest, MassRatiosOfAMillionStayClosed)
{
  for (const double ratio : {1e-6, 1e6})
  {
    Scenario scenario = emptySpace();
    scenario.gravity = {0.0, 0.0, -9.81};
    addBody(scenario, "light", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0.0, 0.0, 0.0));
    addBody(scenario, "heavy", boxUrdf({0.1, 0.1, 0.1}, ratio), poseAt(0.3, 0.0, 0.0));
    LoopSpec top{"top", LoopType::POINT, {"light", "body"}, {}, ""};
    top.a.placement.translation() = Eigen::Vector3d(-0.1, 0.0, 0.0);
    top.b.placement.translation() = Eigen::Vector3d(-0.1, 0.0, 0.0);
    LoopSpec link{"link", LoopType::POINT, {"heavy", "body"}, {"light", "body"}, ""};
    link.a.placement.translation() = Eigen::Vector3d(-0.2, 0.0, 0.0);
    link.b.placement.translation() = Eigen::Vector3d(0.1, 0.0, 0.0);
    scenario.loops = {top, link};
    AuditedSimulator simulator(scenario);
    for (int step = 0; step < 3000; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << ratio << " step " << step << " " << simulator.outcome().message;
      ASSERT_LT(simulator.report().bilateral_violation, 1e-8) << ratio << " step " << step;
    }
  }
}

TEST(LoopTest, AUrdfMayNameLinksAndOriginsOneAndTwoOrParentAndChild)
{
  const Scenario old_names = fourBarScene(FourBar(), "axis", 0.5);
  Scenario scenario = old_names;
  std::string& urdf = scenario.bodies[0].urdf_xml;
  const size_t loop = urdf.find("<loop_joint");
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"<parent", "<link1"}, {"<child ", "<link2 "}, {"<origin", "<origin1"}, {"<child_origin", "<origin2"}})
    urdf.replace(urdf.find(from, loop), from.size(), to);
  Simulator one(scenario);
  Simulator other(old_names);
  for (int step = 0; step < 20; ++step)
  {
    one.step();
    other.step();
  }
  EXPECT_EQ(one.stateHash(), other.stateHash());
  urdf.replace(urdf.find("<link2 link='coupler'/>"), 23, "");
  try
  {
    Simulator none(scenario);
    ADD_FAILURE() << "was taken";
  }
  catch (const std::exception& error)
  {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("closure"), testing::HasSubstr("link2")));
  }
}

TEST(LoopTest, ItsForcesHoldTheWeightOfWhatHangsOnThem)
{
  // A beam of 2 m on two point supports: each carries half, and link forces close Newton's equations.
  Scenario scenario = emptySpace();
  scenario.gravity = {0.0, 0.0, -9.81};
  addBody(scenario, "beam", boxUrdf({2.0, 0.1, 0.1}, 10.0), poseAt(0.0, 0.0, 1.0));
  for (const double side : {-1.0, 1.0})
  {
    LoopSpec support{side < 0.0 ? "left" : "right", LoopType::POINT, {"beam", "body"}, {}, ""};
    support.a.placement.translation() = Eigen::Vector3d(side, 0.0, 0.0);
    support.b.placement.translation() = Eigen::Vector3d(side, 0.0, 1.0);
    scenario.loops.push_back(support);
  }
  Simulator simulator(scenario);
  EXPECT_THAT(simulator.warnings(), testing::Contains(testing::HasSubstr("loop 'right': 1 of its 3 rows")));
  for (int step = 0; step < 100; ++step)
    ASSERT_TRUE(simulator.step().converged());
  for (const int loop : {0, 1})
    EXPECT_LT((simulator.loopWrench(loop) - (Vector6d() << 0, 0, 5.0 * GRAVITY, 0, 0, 0).finished()).norm(), 1e-8);
}

TEST(LoopTest, UnderContactItStaysClosedAndNothingGoesThrough)
{
  // The rocker carries a ball beyond the wrist, which the driven crank presses on the ground until it stalls.
  FourBar bar;
  std::string urdf = fourBarUrdf(bar, loopElement(bar, "point"));
  const std::string ball =
      "<collision><origin xyz='0.4 0 0'/><geometry><sphere radius='0.05'/></geometry></collision></link>";
  const size_t rocker = urdf.find("<link name='rocker'>");
  urdf.replace(urdf.find("</link>", rocker), 7, ball);
  Scenario scenario = groundScene(0.5);
  scenario.stopping.tolerance = 1e-10;
  BodySpec& body = addBody(scenario, "linkage", urdf, poseAt(0.0, 0.0, 0.43));
  body.base = BaseType::FIXED;
  body.joints["drive"].position = -0.5;
  JointCommand drive;
  drive.mode = JointCommand::Mode::VELOCITY;
  drive.target = 3.0;
  drive.max_effort = 20.0;
  body.commands["drive"] = drive;
  AuditedSimulator simulator(scenario);
  int touching = 0;
  for (int step = 0; step < 3000; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    ASSERT_LT(simulator.report().bilateral_violation, 1e-8);
    for (const ContactState& contact : simulator.contacts())
      touching += contact.impulse.norm() > 0.0 ? 1 : 0;
  }
  EXPECT_GT(touching, 100);
}

TEST(LoopTest, SavedStatesGoOnToTheBit)
{
  Simulator whole(fourBarScene(FourBar(), "axis", 0.8));
  for (int step = 0; step < 100; ++step)
    whole.step();
  const SimulationState state = whole.state();
  for (int step = 0; step < 100; ++step)
    whole.step();
  Simulator second(fourBarScene(FourBar(), "axis", 0.8));
  second.setState(state);
  for (int step = 0; step < 100; ++step)
    second.step();
  EXPECT_EQ(firstDifference(whole.state(), second.state()), "");
  EXPECT_EQ(whole.stateHash(), second.stateHash());
}

TEST(LoopTest, AScenarioNamesWhatIsWrong)
{
  const std::string head =
      "bodies: [{name: arm, urdf: " + std::string(PROJECT_DIR) + "/urdf/double_pendulum.urdf, base: fixed}]\nloops: ";
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"[{type: ball, a: {link: upper_rod}, b: {body: world}}]", "expected point, axis or weld"},
      {"[{type: point, a: {link: nowhere}, b: {body: world}}]", "link 'nowhere'"},
      {"[{type: point, a: {body: nobody, link: upper_rod}, b: {body: world}}]", "nobody"},
      {"[{type: point, a: {body: world}, b: {body: world}}]", "rigid"},
      {"[{type: point, axis: [0, 0, 1], a: {link: upper_rod}, b: {body: world}}]", "axis"},
      {"[{type: axis, axis: [0, 0, 0], a: {link: upper_rod}, b: {body: world}}]", "direction"},
      {"[{type: point, a: {link: upper_rod}}]", "loops[0].b"},
      {"[{type: point, a: {link: upper, xyz: [0, 0]}, b: {body: world}}]", "xyz"}};
  for (const auto& [loops, expected] : faults)
  {
    try
    {
      Simulator simulator(loadScenario(head + loops, "cell.yaml"));
      ADD_FAILURE() << loops << " was taken";
    }
    catch (const std::exception& error)
    {
      EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr(expected), testing::HasSubstr("cell.yaml"),
                                               testing::Not(testing::HasSubstr("\n"))))
          << loops;
    }
  }
}

/** Random closed chains: n free or jointed links in a ring, each joined to the next. */
TEST(LoopTest, RandomClosedChainsKeepClosureMomentumAndEnergy)
{
  for (std::uint32_t seed = 1; seed <= 20; ++seed)
  {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    Scenario scenario = emptySpace();
    const int count = dice.integer(3, 7);
    const double side = 2.0 * std::sin(M_PI / count);  // of the ring of radius 1
    for (int k = 0; k < count; ++k)
    {
      const double angle = 2.0 * M_PI * (k + 0.5) / count;
      Eigen::Isometry3d pose =
          poseAt(std::cos(M_PI / count) * std::cos(angle), std::cos(M_PI / count) * std::sin(angle), 0.0);
      pose.linear() = Eigen::AngleAxisd(angle + 0.5 * M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      const double thick = dice.uniform(0.05, 0.2);
      BodySpec& body = addBody(scenario, "link_" + std::to_string(k),
                               boxUrdf({0.7 * side, thick, thick}, dice.logUniform(0.1, 10.0)), pose);
      body.linear_velocity = dice.vector(0.5);
      body.angular_velocity = dice.vector(1.0);
    }
    for (int k = 0; k < count; ++k)
    {
      const bool is_axis = count > 5 && k % 3 == 0;
      LoopSpec loop{"joint_" + std::to_string(k),
                    is_axis ? LoopType::AXIS : LoopType::POINT,
                    {"link_" + std::to_string(k), "body"},
                    {"link_" + std::to_string((k + 1) % count), "body"},
                    ""};
      loop.a.placement.translation() = Eigen::Vector3d(0.5 * side, 0.0, 0.0);
      loop.b.placement.translation() = Eigen::Vector3d(-0.5 * side, 0.0, 0.0);
      scenario.loops.push_back(loop);
    }
    AuditedSimulator simulator(scenario);
    const auto momentum = [&]
    {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int body = 0; body < simulator.bodyCount(); ++body)
        sum +=
            simulator.model(body).totalMass() *
            pointVelocity(simulator.data(body), 0, centerOfMass(simulator.model(body), simulator.data(body))).head<3>();
      return sum;
    };
    const Eigen::Vector3d start = momentum();
    const double energy = energyOf(simulator);
    for (int step = 0; step < 300; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      if (step > 0)
      {
        ASSERT_LT(simulator.report().bilateral_violation, 1e-8) << "step " << step;
      }
    }
    EXPECT_LT((momentum() - start).norm(), 1e-9 * (1.0 + start.norm()));
    if (simulator.contacts().empty() && simulator.report().energy.impact == 0.0)
    {
      EXPECT_NEAR(energyOf(simulator), energy, 1e-3 * energy);
    }
  }
}

}  // namespace
}  // namespace frictional_contact_sim
