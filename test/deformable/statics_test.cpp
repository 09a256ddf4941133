// Statics: known thresholds of equilibrium by bisection, each answer with its proof.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>

#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "static_scene.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.141592653589793;

TEST(StaticsTest, BrickOnAnInclineStandsWhereTheFrictionIsTheTangent)
{
  // Cadoux (2009), figures 1.8, 1.9, by Coulomb: mu = tan(angle) whatever the weight; a low brick does not tip.
  for (const double angle : {0.1, 0.4, 0.6})
    for (const double mass : {0.1, 10.0})
    {
      const auto scene = [&](double friction)
      {
        Scenario scenario = statics(friction);
        // The plane leans: gravity does.
        scenario.gravity = 9.81 * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
        scenario.ground = GroundSpec{};
        scenario.bodies.push_back(bodySpec("brick", mass, box(0.4, 0.4, 0.1), place(0.0, 0.05)));
        return stands(scenario);
      };
      EXPECT_NEAR(threshold(0.0, 1.0, 2e-6, scene), std::tan(angle), 4e-6);
    }
}

TEST(StaticsTest, LadderLeansAtItsSteepestWhereBothFrictionsAreUsedUp)
{
  // tan(theta_min) = (1 - mu_f mu_w)/(2 mu_f), one mu for both: a thin rod between ground and wall.
  for (const double friction : {0.2, 0.4, 0.7})
  {
    const auto scene = [&](double theta)
    {
      Scenario scenario = statics(friction);
      scenario.ground = GroundSpec{};
      // A capsule along z, leaning towards +x: its caps touch ground and wall, its centre line has length l.
      const double length = 2.0;
      const double radius = 1e-6;
      Eigen::Isometry3d pose =
          place(0.5 * length * std::cos(theta), radius + 0.5 * length * std::sin(theta), 0.5 * PI - theta);
      scenario.bodies.push_back(
          bodySpec("ladder", 5.0, "<capsule radius='" + number(radius) + "' length='" + number(length) + "'/>", pose));
      const double top = length * std::cos(theta) + radius;
      scenario.bodies.push_back(bodySpec("wall", 1.0, box(1.0, 4.0, 6.0), place(top + 0.5, 1.0), BaseType::FIXED));
      return stands(scenario);
    };
    const double exact = std::atan((1.0 - friction * friction) / (2.0 * friction));
    EXPECT_NEAR(threshold(0.5 * exact, 1.5, 2e-6, scene), exact, 1e-5);
  }
}

TEST(StaticsTest, ThreeLogsNeedTwoMinusRootThree)
{
  // Two cylinders touch on the floor, a third lies on both: mu_log >= 2 - sqrt 3, floor as rough as it takes.
  const auto scene = [&](double friction)
  {
    Scenario scenario = statics(friction);
    scenario.ground = GroundSpec{};
    scenario.ground->friction = 1.0;
    const std::string log = "<cylinder radius='0.1' length='0.5'/>";
    const auto lying = [](double x, double z)
    {
      Eigen::Isometry3d pose(Eigen::AngleAxisd(0.5 * PI, Eigen::Vector3d::UnitX()));
      pose.translation() = Eigen::Vector3d(x, 0.0, z);
      return pose;
    };
    scenario.bodies.push_back(bodySpec("left", 3.0, log, lying(-0.1, 0.1)));
    scenario.bodies.push_back(bodySpec("right", 3.0, log, lying(0.1, 0.1)));
    scenario.bodies.push_back(bodySpec("top", 3.0, log, lying(0.0, 0.1 + 0.1 * std::sqrt(3.0))));
    return stands(scenario);
  };
  EXPECT_NEAR(threshold(0.1, 0.5, 2e-6, scene), 2.0 - std::sqrt(3.0), 1e-5);
}

/** A voussoir of a semicircular arch as a mesh about the arch's centre. */
std::string voussoir(const std::string& file, double inner, double outer, double from, double to)
{
  std::ofstream stl(file);
  stl.precision(17);
  Eigen::Vector3d corner[2][2][2];  // angle, radius, y
  for (int a = 0; a < 2; ++a)
    for (int r = 0; r < 2; ++r)
      for (int y = 0; y < 2; ++y)
      {
        const double angle = a == 0 ? from : to;
        const double radius = r == 0 ? inner : outer;
        corner[a][r][y] = {radius * std::cos(angle), y == 0 ? -0.1 : 0.1, radius * std::sin(angle)};
      }
  for (int a = 0; a < 2; ++a)
    for (int r = 0; r < 2; ++r)
      for (int y = 0; y < 2; ++y)
        stl << "v " << corner[a][r][y].transpose() << '\n';
  // Index 1 + 4 a + 2 r + y; each quadrilateral as two triangles, outwards.
  for (const char* face : {"1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"})
  {
    int i[4];
    std::istringstream(face) >> i[0] >> i[1] >> i[2] >> i[3];
    stl << "f " << i[0] << ' ' << i[1] << ' ' << i[2] << "\nf " << i[0] << ' ' << i[2] << ' ' << i[3] << '\n';
  }
  return "<mesh filename='file://" + file + "'/>";
}

/** Semicircle of mean radius 1 on a fixed floor, weights from the volumes. */
Scenario arch(int stones, double thickness, double friction)
{
  Scenario scenario = statics(friction);
  const double inner = 1.0 - 0.5 * thickness;
  const double outer = 1.0 + 0.5 * thickness;
  const double part = PI / stones;
  const double half = 0.5 * part;
  // Of a prism of four corners: a trapezium with parallel sides 2 r sin(half), height (outer - inner) cos(half).
  const double centre = 2.0 / 3.0 * std::cos(half) * (outer * outer + outer * inner + inner * inner) / (outer + inner);
  for (int k = 0; k < stones; ++k)
  {
    const std::string file = testing::TempDir() + "voussoir_" + std::to_string(k) + ".obj";
    const std::string mesh = voussoir(file, inner, outer, k * part, (k + 1) * part);
    const double middle = (k + 0.5) * part;
    BodySpec body;
    body.name = "stone" + std::to_string(k);
    body.urdf_xml = "<robot name='s'><link name='s'><inertial><origin xyz='" + number(centre * std::cos(middle)) +
                    " 0 " + number(centre * std::sin(middle)) +
                    "'/><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial>"
                    "<collision><geometry>" +
                    mesh + "</geometry></collision></link></robot>";
    body.pose = Eigen::Isometry3d::Identity();
    scenario.bodies.push_back(body);
  }
  for (const double side : {-1.0, 1.0})
    scenario.bodies.push_back(
        bodySpec(side < 0.0 ? "left_pier" : "right_pier", 1.0, box(0.6, 0.4, 0.2), place(side, -0.1), BaseType::FIXED));
  return scenario;
}

TEST(StaticsTest, SemicircularArchNeedsItsThicknessAndItsFriction)
{
  // Heyman (1966), Milankovitch: t/R = 0.1075 for the continuous arch with stones that do not slide; 10 stones 0.1075,
  // 18 stones 0.1060. That thickness suffices down to mu = 0.3958, where sliding comes in; no thickness below 0.309.
  const auto by_thickness = [](int stones, double friction, double width)
  { return threshold(0.09, 0.13, width, [&](double thickness) { return stands(arch(stones, thickness, friction)); }); };
  EXPECT_NEAR(by_thickness(10, 2.0, 5e-4), 0.1075, 0.01 * 0.1075);
  const double least = by_thickness(18, 2.0, 2e-4);
  EXPECT_NEAR(least, 0.1060, 0.01 * 0.1060);
  const double limit =
      threshold(0.3, 0.5, 1e-3, [&](double friction) { return stands(arch(18, least + 2e-4, friction)); });
  EXPECT_NEAR(limit, 0.3958, 0.01 * 0.3958);
}

TEST(StaticsTest, ForcesAtRestCarryTheWeightOfRandomStacks)
{
  // Any stack whose centres of mass are over what carries them stands without friction, and level k carries what is
  // above it; a box shifted beyond its edge does not, and that is proven.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-0.04, 0.04);
  std::uniform_real_distribution<double> mass(0.1, 10.0);
  for (int run = 0; run < 10; ++run)
  {
    Scenario scenario = statics(0.3);
    scenario.ground = GroundSpec{};
    double weight = 0.0;
    for (int level = 0; level < 5; ++level)
    {
      const double own = mass(random);
      weight += own * 9.81;
      scenario.bodies.push_back(bodySpec("box" + std::to_string(level), own, box(0.2, 0.2, 0.1),
                                         place(level == 0 ? 0.0 : 0.2 * shift(random), 0.05 + 0.1 * level)));
    }
    Simulator simulator(scenario);
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    double carried = 0.0;
    for (const ContactState& contact : simulator.contacts())
    {
      EXPECT_GE(contact.cone_margin, -1e-9);
      if (simulator.shape(contact.shape_b).body < 0)
        carried += contact.impulse.z() / scenario.time_step;
    }
    EXPECT_NEAR(carried, weight, 1e-6 * weight);
    scenario.bodies.back().pose->translation().x() += 0.15;
    EXPECT_FALSE(stands(scenario));
  }
}

TEST(StaticsTest, SqueezedBetweenWallsStandsThoughItMayFall)
{
  // A box that just fits between two fixed walls, no floor: r = 0 with a fall is an answer of the dynamic problem, and
  // yet forces that press as hard as they like hold it. Statics asks for those.
  Scenario scenario = statics(0.5);
  scenario.bodies.push_back(bodySpec("box", 1.0, box(0.2, 0.2, 0.2), place(0.0, 0.0)));
  for (const double side : {-1.0, 1.0})
    scenario.bodies.push_back(
        bodySpec(side < 0.0 ? "left" : "right", 1.0, box(0.2, 1.0, 1.0), place(0.2 * side, 0.0), BaseType::FIXED));
  EXPECT_TRUE(stands(scenario));
  scenario.bodies.pop_back();
  EXPECT_FALSE(stands(scenario));
}

TEST(ElasticStaticsTest, CantileverBendsAsTimoshenkoSaysWithTheOrderOfTheMesh)
{
  // Plane stress, tip load F: w = F L^3/(3 E I) + F L/(kappa G A), kappa = 5/6. P1 triangles are stiff and of order
  // two.
  constexpr double LENGTH = 1.0;
  constexpr double HEIGHT = 0.2;
  constexpr double E = 1.0e7;
  constexpr double FORCE = 10.0;
  const double inertia = std::pow(HEIGHT, 3) / 12.0;
  const double exact = FORCE * std::pow(LENGTH, 3) / (3.0 * E * inertia) +
                       FORCE * LENGTH / (5.0 / 6.0 * HEIGHT * E / 2.0);  // nu = 0: G = E/2
  double error[3];
  for (int k = 0; k < 3; ++k)
  {
    const int cells = 4 << k;
    Simulator simulator(loadScenario(
        "static: true\ngravity: [0, 0, 0]\nbodies:\n  - name: beam\n    elastic: {box: [1.0, 0.2], cells: [" +
            std::to_string(5 * cells) + ", " + std::to_string(cells) +
            "], young_modulus: 1.0e7, poisson_ratio: 0.0, density: 1000, plane: stress, fixed: [left]}\n    wrenches: "
            "[{link: beam, force: [0, 0, -10], point: [0.5, 0, 0]}]\n",
        "test"));
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    double tip = 0.0;  // of the axis's neighbours: the loaded node itself has the point load's own dent
    const MultibodyData& data = simulator.data(0);
    for (size_t link = 1; link < data.link_pose.size(); ++link)
      if (data.link_pose[link].translation().z() > 0.09)
        tip = std::min(tip, data.link_pose[link].translation().z() - 0.1);
    error[k] = -tip / exact - 1.0;
  }
  EXPECT_LT(std::abs(error[2] + (error[2] - error[1]) / 3.0), 0.005) << "extrapolated to no mesh";
  EXPECT_NEAR(std::log2((error[0] - error[1]) / (error[1] - error[2])), 2.0, 0.4);
}

TEST(ElasticStaticsTest, QuasiStaticLoadStepsEndInTheStaticState)
{
  // A block that hangs from its top and is let down on the ground in ten steps or a hundred, without friction: the
  // state depends on where the supports are alone, not on the steps.
  const auto run = [](int steps)
  {
    Scenario scenario = loadScenario("quasi_static: true\ntime_step: " + number(1.0 / steps) +
                                         "\nmaterials: {default: {friction: 0}}\nground: {}\nbodies:\n  - name: "
                                         "block\n    elastic: {box: [0.1, 0.1], "
                                         "cells: [6, 6], young_modulus: 1.0e5, poisson_ratio: 0.3, density: 1000, "
                                         "fixed: [top]}\n    pose: {xyz: [0, "
                                         "0, 0.051]}\n    motion: {linear: [0, 0, -0.003]}\n",
                                     "test");
    Simulator simulator(scenario);
    for (int step = 0; step < steps; ++step)
      EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    double force = 0.0;
    for (const ContactState& contact : simulator.contacts())
      force += contact.impulse.z() / scenario.time_step;
    for (const Eigen::Isometry3d& pose : simulator.data(0).link_pose)
      EXPECT_GT(pose.translation().z(), -1e-9);
    EXPECT_TRUE(simulator.velocity(0).isZero(0.0));
    return std::make_pair(simulator.position(0), force);
  };
  const auto coarse = run(10);
  const auto fine = run(100);
  EXPECT_GT(fine.second, 10.0);
  EXPECT_NEAR(coarse.second, fine.second, 1e-3 * fine.second);
  EXPECT_LT((coarse.first - fine.first).lpNorm<Eigen::Infinity>(), 1e-6);
}

TEST(ElasticStaticsTest, BlockUnderItsOwnWeightIsLongerByHalfTheColumn)
{
  // A column that hangs: plane stress, nu = 0, u = rho g h^2/(2 E). In one dimension linear elements have it exact at
  // the nodes; here triangles share the load of the lowest cells unevenly, 2/16^2 of a sixteenth.
  Simulator simulator(
      loadScenario("static: true\nbodies:\n  - name: column\n    elastic: {box: [0.05, 0.4], cells: [2, 16], "
                   "young_modulus: 1.0e6, poisson_ratio: 0.0, density: 1000, plane: stress, fixed: [top]}\n",
                   "test"));
  ASSERT_TRUE(simulator.step().converged());
  double lowest = 0.0;
  for (const Eigen::Isometry3d& pose : simulator.data(0).link_pose)
    lowest = std::min(lowest, pose.translation().z());
  const double exact = 1000 * 9.81 * 0.16 / 2e6;
  EXPECT_NEAR(-lowest - 0.2, exact, 1e-3 * exact);
}

TEST(StaticsKeyTest, WhatCannotBeAskedIsRefusedByName)
{
  const auto message = [](const std::string& yaml)
  {
    try
    {
      Simulator simulator(loadScenario(yaml, "test.yaml"));
    }
    catch (const std::exception& error)
    {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const std::string free_block =
      "bodies:\n  - name: block\n    elastic: {bar: 1, cells: 2, young_modulus: 1e6, density: 1}\n";
  EXPECT_NE(message("static: true\n" + free_block).find("body 'block' moves freely"), std::string::npos)
      << message("static: true\n" + free_block);
  EXPECT_NE(message("static: true\nquasi_static: true\n" + free_block).find("expected one of them"), std::string::npos);
  EXPECT_NE(message("static: maybe\n" + free_block).find("static"), std::string::npos);
}

}  // namespace
}  // namespace frictional_contact_sim
