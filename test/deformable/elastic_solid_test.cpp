// Elastic bodies in the simulator: energy, momentum, impact, drag, penetration by a check of its own, state, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_file.h"

namespace frictional_contact_sim
{
namespace
{
const ElasticSolid& solidOf(const Simulator& simulator, int body)
{
  return static_cast<const ElasticSolid&>(*simulator.workspace(body).model.solid);
}

std::string number(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

/** A plane block by name. */
std::string block(const std::string& name, double x, double z, const std::string& more = "",
                  const std::string& pose_more = "")
{
  return "  - name: " + name +
         "\n    elastic: {box: [0.1, 0.1], cells: [4, 4], young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000" +
         more + "}\n    pose: {xyz: [" + number(x) + ", 0, " + number(z) + "]" + pose_more + "}\n";
}

Eigen::Vector3d momentum(const Simulator& simulator, int body)
{
  const ElasticSolid& solid = solidOf(simulator, body);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // sum of m v: rows of M times unit translations
  for (int axis = 0; axis < 3; ++axis)
    sum[axis] = solid.carried(axis).dot(simulator.velocity(body));
  return simulator.workspace(body).end.base_pose.linear() * sum;
}

TEST(FreeElasticBodyTest, KeepsItsEnergyAndMomentumOverAHundredThousandSteps)
{
  Simulator simulator(loadScenario("gravity: [0, 0, 0]\ntime_step: 0.0005\nbodies:\n" +
                                       std::string("  - name: block\n    elastic: {box: [0.1, 0.1], cells: [2, 2], "
                                                   "young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000}\n"),
                                   "test"));
  const ElasticSolid& solid = solidOf(simulator, 0);
  std::mt19937 random(5);
  std::normal_distribution<double> gauss(0.0, 0.05);
  Eigen::VectorXd v(solid.velocities());
  for (double& component : v)
    component = gauss(random);
  // No rigid rotation: out of it goes what it has of angular momentum.
  const Eigen::VectorXd turn = solid.rigidVelocity(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY());
  v -= turn * (turn.dot(solid.mass() * v) / turn.dot(solid.mass() * turn));
  simulator.velocity(0) = v;
  simulator.stateChanged();
  const EnergyLedger start = simulator.report().energy;
  const Eigen::Vector3d p = momentum(simulator, 0);
  const double energy = start.kinetic + start.potential;
  double worst = 0.0;
  double stored = 0.0;
  for (int step = 0; step < 100000; ++step)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    const EnergyLedger& now = simulator.report().energy;
    worst = std::max(worst, std::abs(now.kinetic + now.potential - energy));
    stored = std::max(stored, now.potential);
  }
  EXPECT_GT(stored, 0.2 * energy) << "it vibrates";
  EXPECT_LT(worst, 1e-10 * energy);
  EXPECT_LT((momentum(simulator, 0) - p).norm(), 1e-10 * std::sqrt(2.0 * energy * solid.totalMass()));
  EXPECT_LT(std::abs(turn.dot(solid.mass() * simulator.velocity(0))), 1e-10 * std::sqrt(energy));
}

TEST(DampedElasticBodyTest, LosesWhatTheLedgerBooks)
{
  Simulator simulator(loadScenario("gravity: [0, 0, -9.81]\ntime_step: 0.001\nbodies:\n" +
                                       block("block", 0.0, 0.0, ", damping: 0.01, fixed: [left]"),
                                   "test"));
  for (int step = 0; step < 400; ++step)
    ASSERT_TRUE(simulator.step().converged());
  const EnergyLedger& energy = simulator.report().energy;
  EXPECT_GT(energy.joints, 0.0);
  EXPECT_LT(std::abs(energy.balance_error), 1e-13);
  // At rest: K q carries the weight, and the sum of the supports' forces is the weight of the free nodes.
  const ElasticSolid& solid = solidOf(simulator, 0);
  const Eigen::VectorXd weight = -9.81 * solid.carried(2);
  EXPECT_LT((solid.stiffness() * simulator.position(0) - weight).norm(), 1e-6 * weight.norm());
}

/** Time at which the bars part, and the velocities of their centres then. */
struct BarImpact
{
  double parted = 0.0;
  double left = 0.0;
  double right = 0.0;
  double early_stress = 0.0;  ///< mean until 2 l1/c, over -E v0/(2 c)
  double late_stress = 0.0;  ///< mean from there to 4 l1/c
};

BarImpact runBars(int cells, double right_length)
{
  constexpr double E = 2.1e11;
  constexpr double DENSITY = 8000.0;
  constexpr double AREA = 1e-4;
  const double c = std::sqrt(E / DENSITY);
  EXPECT_NEAR(c, 5123.0, 1.0);  // table 1.1 with its densities a thousand times larger
  const double dt = 0.5 / (cells * c);
  const auto bar = [&](const std::string& name, double length, double x, double v)
  {
    return "  - name: " + name + "\n    elastic: {bar: " + number(length) +
           ", cells: " + std::to_string(static_cast<int>(std::lround(cells * length))) +
           ", young_modulus: " + number(E) + ", density: " + number(DENSITY) + ", area: " + number(AREA) +
           "}\n    pose: {xyz: [" + number(x) + ", 0, 0]}\n    velocity: {linear: [" + number(v) + ", 0, 0]}\n";
  };
  Simulator simulator(loadScenario("gravity: [0, 0, 0]\ntime_step: " + number(dt) +
                                       "\nmaterials: {default: {friction: 0, restitution: 0}}\nbodies:\n" +
                                       bar("left", 1.0, -0.5, 1.0) +
                                       bar("right", right_length, 0.5 * right_length, 0.0),
                                   "test"));
  BarImpact result;
  const double transit = 1.0 / c;
  double early = 0.0;
  double late = 0.0;
  while (simulator.time() < 5.0 * transit)
  {
    EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    double impulse = 0.0;
    for (const ContactState& contact : simulator.contacts())
      impulse += contact.impulse.norm();
    if (impulse > 1e-3 * E * AREA / (2.0 * c) * dt)
      result.parted = simulator.time();
    const double middle = simulator.time() - 0.5 * dt;
    (middle < 2.0 * transit ? early : late) += middle < 4.0 * transit ? impulse : 0.0;
    // The ends never pass each other.
    const auto end = [&](int body, double side)
    {
      double place = -side * 1e9;
      for (const Eigen::Isometry3d& pose : simulator.data(body).link_pose)
        place = side * std::max(side * place, side * pose.translation().x());
      return place;
    };
    EXPECT_GT(end(1, -1.0) - end(0, 1.0), -1e-9);
  }
  result.early_stress = early / (2.0 * transit) / (E * AREA / (2.0 * c));
  result.late_stress = late / (2.0 * transit) / (E * AREA / (2.0 * c));
  result.left = momentum(simulator, 0).x() / solidOf(simulator, 0).totalMass();
  result.right = momentum(simulator, 1).x() / solidOf(simulator, 1).totalMass();
  result.parted /= transit;
  EXPECT_NEAR(result.left + right_length * result.right, 1.0, 1e-9);  // momentum
  return result;
}

TEST(TwoBarsTest, PartAfterFourTransitsWithTheVelocitiesOfTheThesis)
{
  // Cadoux (2009), section 1.1: l2 = 2 l1, contact stress -E v0/(2c) until 2 l1/c, none until 4 l1/c; then 0 and v0/2.
  const BarImpact coarse = runBars(25, 2.0);
  const BarImpact fine = runBars(100, 2.0);
  for (const auto& [run, cell] : {std::make_pair(coarse, 1.0 / 25), std::make_pair(fine, 1.0 / 100)})
  {
    EXPECT_NEAR(run.early_stress, 1.0, cell) << "one cell of a front that is sharp";
    EXPECT_NEAR(run.late_stress, 0.0, cell);
    EXPECT_LT(run.parted, 4.0 + 2.0 * cell);
    EXPECT_NEAR(run.left, 0.0, cell);
    EXPECT_NEAR(run.right, 0.5, cell);
  }
  EXPECT_LT(std::abs(fine.right - 0.5), 0.6 * std::abs(coarse.right - 0.5));
}

TEST(TwoBarsTest, ApparentRestitutionIsTheRatioOfLengths)
{
  // (1.17): alpha = (v2 - v1)/v0 of the centres = l1/l2 for l2 >= 2 l1.
  for (const double length : {2.0, 2.5, 4.0})
  {
    const BarImpact run = runBars(50, length);
    EXPECT_NEAR(run.right - run.left, 1.0 / length, 1.0 / 50) << "l2 = " << length;
  }
}

class DraggedSquareTest : public testing::TestWithParam<double>
{
};

TEST_P(DraggedSquareTest, EveryStepHasAnAnswerAndIsCertified)
{
  // Cadoux (2009), section 3.4.7: H has full row rank (a node a contact), so that a solution exists for every mu.
  Scenario scenario = loadScenarioFile(std::string(PROJECT_DIR) + "/config/scenarios/dragged_square.yaml");
  scenario.materials.fallback.friction = GetParam();
  scenario.ground->friction = GetParam();
  Simulator simulator(scenario);
  int sliding = 0;
  while (simulator.time() < 0.06)
  {
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    EXPECT_EQ(simulator.report().certificate.existence, Existence::CERTIFIED) << "at " << simulator.time();
    double normal = 0.0;
    double tangential = 0.0;
    for (const ContactState& contact : simulator.contacts())
    {
      normal += contact.impulse.z();
      tangential -= contact.impulse.x();
      EXPECT_LE(contact.impulse.head<2>().norm(), GetParam() * contact.impulse.z() + 1e-9);
      sliding += contact.mode == ContactMode::SLIDING && contact.impulse.z() > 0.0;
    }
    EXPECT_LE(tangential, GetParam() * normal + 1e-9);
    for (const Eigen::Isometry3d& pose : simulator.data(0).link_pose)
      EXPECT_GT(pose.translation().z(), -1e-9);
  }
  EXPECT_TRUE(sliding > 0 || GetParam() > 1.0);
}

INSTANTIATE_TEST_SUITE_P(AnyFriction, DraggedSquareTest, testing::Values(0.0, 0.1, 0.5, 1.0, 10.0),
                         [](const testing::TestParamInfo<double>& info)
                         { return "mu_x10_" + std::to_string(std::lround(10.0 * info.param)); });

/** Depth of a point in a polygon of the surface nodes of a plane body (even-odd rule and distances to its edges): no
 * code shared with the detection. */
double depthIn(const Simulator& simulator, int body, const Eigen::Vector3d& x)
{
  const std::vector<Facet>& facets = solidOf(simulator, body).facets();
  const MultibodyData& data = simulator.data(body);
  bool inside = false;
  double nearest = 1e9;
  for (const Facet& facet : facets)
  {
    const Eigen::Vector3d a = data.link_pose[facet.links[0]].translation();
    const Eigen::Vector3d b = data.link_pose[facet.links[1]].translation();
    if ((a.z() > x.z()) != (b.z() > x.z()) && x.x() < a.x() + (x.z() - a.z()) / (b.z() - a.z()) * (b.x() - a.x()))
      inside = !inside;
    const double share = std::max(0.0, std::min(1.0, (x - a).dot(b - a) / (b - a).squaredNorm()));
    nearest = std::min(nearest, (x - a - share * (b - a)).norm());
  }
  return inside ? nearest : -nearest;
}

TEST(StackedBlocksTest, NoNodeGoesThroughAnotherSurfaceOrTheGroundAndMomentumIsTheForces)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-0.02, 0.02);
  for (int run = 0; run < 6; ++run)
  {
    const double x = place(random);
    Simulator simulator(loadScenario("time_step: 0.001\nmaterials: {default: {friction: 0.6}}\nground: {}\nbodies:\n" +
                                         block("lower", 0.0, 0.05, ", damping: 0.001") +
                                         block("upper", x, 0.153 + std::abs(place(random)), ", damping: 0.001"),
                                     "test"));
    double worst = 0.0;
    double last = 0.0;
    for (int step = 0; step < 400; ++step)
    {
      const Eigen::Vector3d before = momentum(simulator, 0) + momentum(simulator, 1);
      ASSERT_TRUE(simulator.step().converged())
          << "run " << run << " step " << step << ": " << simulator.outcome().message;
      Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
      for (const ContactState& contact : simulator.contacts())
        if (simulator.shape(contact.shape_b).body < 0)
          impulse += contact.impulse;
      const double mass = solidOf(simulator, 0).totalMass() + solidOf(simulator, 1).totalMass();
      impulse.z() -= 0.001 * 9.81 * mass;
      EXPECT_LT((momentum(simulator, 0) + momentum(simulator, 1) - before - impulse).norm(), 1e-10);
      last = simulator.report().energy.balance_error;
      for (int body = 0; body < 2; ++body)
        for (size_t link = 1; link < simulator.data(body).link_pose.size(); ++link)
        {
          const Eigen::Vector3d& node = simulator.data(body).link_pose[link].translation();
          worst = std::max({worst, -node.z(), depthIn(simulator, 1 - body, node)});
        }
    }
    EXPECT_LT(worst, 1e-6) << "run " << run;
    EXPECT_LT(std::abs(last), 1e-9) << "M and K are constant, impulses sum up exactly";
    EXPECT_LT(simulator.velocity(1).cwiseAbs().maxCoeff(), 0.05) << "it has come to lie";
  }
}

TEST(ElasticStateTest, TheSameRunHasTheSameBitsAndASavedStateGoesOn)
{
  const Scenario scenario = loadScenario(
      "time_step: 0.001\nground: {friction: 0.4}\nbodies:\n" + block("block", 0.0, 0.053, ", damping: 0.002"), "test");
  Simulator one(scenario);
  Simulator two(scenario);
  for (int step = 0; step < 150; ++step)
  {
    one.step();
    two.step();
  }
  EXPECT_GT(one.contacts().size(), 0u);
  ASSERT_EQ(one.stateHash(), two.stateHash());
  const std::string file = testing::TempDir() + "elastic_state.bin";
  saveState(one, file);
  Simulator three(scenario);
  loadState(three, file);
  for (int step = 0; step < 60; ++step)
  {
    one.step();
    three.step();
  }
  EXPECT_EQ(one.stateHash(), three.stateHash());
  one.reset();
  EXPECT_TRUE(one.position(0).isZero(0.0));
}

TEST(ElasticRotationTest, IsRefusedByNameOnceItPassesATenthOfARadian)
{
  Simulator simulator(
      loadScenario("gravity: [0, 0, 0]\ntime_step: 0.001\nbodies:\n  - name: spinner\n    elastic: {box: [0.1, 0.1], "
                   "cells: [2, 2], young_modulus: 1.0e6, poisson_ratio: 0.3, density: 1000}\n    "
                   "velocity: {angular: [0, 1, 0]}\n",
                   "test"));
  double turned = 0.0;
  while (simulator.step().converged())
    turned = solidOf(simulator, 0).rotation(simulator.position(0));
  EXPECT_NEAR(turned, 0.1, 0.002);
  EXPECT_NEAR(simulator.time(), 0.1, 0.003);
  EXPECT_NE(simulator.outcome().message.find("elastic body 'spinner' has turned by"), std::string::npos)
      << simulator.outcome().message;
}

TEST(PressedElasticBlockTest, RigidBodyAndBlockShareTheForce)
{
  // A rigid slab on an elastic block of three dimensions: at rest the block carries slab and itself.
  const std::string slab =
      "<robot name='slab'><link name='slab'><inertial><mass value='2'/><inertia ixx='0.01' ixy='0' "
      "ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial><collision><geometry><box size='0.3 0.3 "
      "0.02'/></geometry></collision></link></robot>";
  Scenario scenario = loadScenario(
      "time_step: 0.001\nmaterials: {default: {friction: 0.5}}\nground: {}\nbodies:\n  - name: "
      "block\n    elastic: {box: [0.1, 0.1, 0.1], cells: [3, 3, 3], young_modulus: 1.0e5, "
      "poisson_ratio: 0.3, density: 1000, damping: 0.01}\n    pose: {xyz: [0, 0, 0.05]}\n",
      "test");
  BodySpec body;
  body.name = "slab";
  body.urdf_xml = slab;
  body.pose = Eigen::Isometry3d::Identity();
  body.pose->translation().z() = 0.111;
  scenario.bodies.push_back(body);
  Simulator simulator(scenario);
  for (int step = 0; step < 700; ++step)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  double on_ground = 0.0;
  double between = 0.0;
  for (const ContactState& contact : simulator.contacts())
    (simulator.shape(contact.shape_b).body < 0 ? on_ground : between) += std::abs(contact.impulse.z()) / 0.001;
  EXPECT_NEAR(on_ground, 3.0 * 9.81, 1e-3 * 3.0 * 9.81);
  EXPECT_NEAR(between, 2.0 * 9.81, 1e-3 * 2.0 * 9.81);
  for (size_t link = 1; link < simulator.data(0).link_pose.size(); ++link)
  {
    const Eigen::Vector3d& node = simulator.data(0).link_pose[link].translation();
    EXPECT_GT(node.z(), -1e-9);
    EXPECT_LT((simulator.data(1).link_pose[0].inverse() * node).z(), -0.01 + 1e-6);
  }
}

struct BadElastic
{
  const char* name;
  const char* body;
  const char* says;
};

class BadElasticTest : public testing::TestWithParam<BadElastic>
{
};

TEST_P(BadElasticTest, IsOneLineThatNamesTheKey)
{
  const std::string yaml = std::string("ground: {}\nbodies:\n  - name: bad\n    ") + GetParam().body + "\n";
  try
  {
    Simulator simulator(loadScenario(yaml, "test.yaml"));
    FAIL() << "expected an error with " << GetParam().says;
  }
  catch (const std::exception& error)
  {
    const std::string message = error.what();
    EXPECT_NE(message.find(GetParam().says), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

#define MATERIAL "young_modulus: 1e6, poisson_ratio: 0.3, density: 1000"
INSTANTIATE_TEST_SUITE_P(
    Keys, BadElasticTest,
    testing::Values(
        BadElastic{"NoSource", "elastic: {" MATERIAL "}", "exactly one of box, bar, mesh"},
        BadElastic{"TwoSources", "elastic: {bar: 1, box: [1, 1], cells: [2, 2], " MATERIAL "}", "exactly one of"},
        BadElastic{"NoCells", "elastic: {box: [1, 1], " MATERIAL "}", "cells"},
        BadElastic{"OneSize", "elastic: {box: [1], cells: [2], " MATERIAL "}", "two sizes"},
        BadElastic{"CellsDoNotFit", "elastic: {box: [1, 1], cells: [2], " MATERIAL "}", "2 numbers"},
        BadElastic{"ZeroCells", "elastic: {box: [1, 1], cells: [0, 1], " MATERIAL "}", "cells"},
        BadElastic{"NegativeSize", "elastic: {box: [1, -1], cells: [2, 1], " MATERIAL "}", "box"},
        BadElastic{"NoModulus", "elastic: {box: [1, 1], cells: [2, 1], density: 1, poisson_ratio: 0}", "young_modulus"},
        BadElastic{"Incompressible",
                   "elastic: {box: [1, 1], cells: [2, 1], young_modulus: 1, density: 1, poisson_ratio: 0.5}",
                   "poisson_ratio"},
        BadElastic{"NoDensity", "elastic: {box: [1, 1], cells: [2, 1], young_modulus: 1, poisson_ratio: 0}", "density"},
        BadElastic{"UnknownSide", "elastic: {box: [1, 1], cells: [2, 1], fixed: [upper], " MATERIAL "}", "'upper'"},
        BadElastic{"AllFixed", "elastic: {box: [1, 1], cells: [1, 1], fixed: [bottom, top], " MATERIAL "}",
                   "every node is fixed"},
        BadElastic{"NoFile", "elastic: {mesh: none.msh, " MATERIAL "}", "none.msh"},
        BadElastic{"LoneMass", "elastic: {mass: M.mtx}", "M.mtx"},
        BadElastic{"Joints", "elastic: {bar: 1, cells: 2, " MATERIAL "}\n    joints: {a: {position: 1}}", "joints"},
        BadElastic{"MotionWithoutSupport",
                   "elastic: {bar: 1, cells: 2, " MATERIAL
                   "}\n    pose: {xyz: [0, 0, 1]}\n    motion: {linear: [1, 0, 0]}",
                   "no node is 'fixed'"},
        BadElastic{"Turning",
                   "elastic: {bar: 1, cells: 2, fixed: [left], " MATERIAL
                   "}\n    pose: {xyz: [0, 0, 1]}\n    motion: {angular: [1, 0, 0]}",
                   "neither turns nor"},
        BadElastic{"InTheGround", "elastic: {box: [1, 1], cells: [2, 2], " MATERIAL "}\n    pose: {xyz: [0, 0, 0.4]}",
                   "below the ground"},
        BadElastic{"Torque",
                   "elastic: {bar: 1, cells: 2, " MATERIAL
                   "}\n    pose: {xyz: [0, 0, 1]}\n    wrenches: [{link: bad, torque: [0, 1, 0]}]",
                   "torque"},
        BadElastic{"OtherLink",
                   "elastic: {bar: 1, cells: 2, " MATERIAL
                   "}\n    pose: {xyz: [0, 0, 1]}\n    wrenches: [{link: tip, force: [0, 1, 0]}]",
                   "'tip'"},
        BadElastic{"Damping", "elastic: {bar: 1, cells: 2, damping: -1, " MATERIAL "}", "damping"}),
    [](const testing::TestParamInfo<BadElastic>& info) { return std::string(info.param.name); });
#undef MATERIAL

}  // namespace
}  // namespace frictional_contact_sim
