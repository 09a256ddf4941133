// Rods as bodies: closed forms of shape, frequency and bending, energy, contact between rods by a check of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>
#include <string>

#include "frictional_contact_sim/deformable/super_helix.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.141592653589793;

RodSpec hair(int pieces, int sections)
{
  RodSpec spec;
  spec.length = 0.2;
  spec.radius = 0.002;
  spec.pieces = pieces;
  spec.sections = sections;
  spec.density = 1300.0;
  spec.young_modulus = {1.0e7};
  return spec;
}

std::string number(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string rod(const std::string& name, const std::string& place, const std::string& more = "",
                const std::string& beside = "")
{
  return "  - name: " + name + "\n    rod: {length: 0.2, radius: 0.002, density: 1300, young_modulus: 1.0e7" + more +
         "}\n    pose: " + place + "\n" + beside;
}

TEST(SuperHelixTest, UniformCurvatureAndTwistAreAHelix)
{
  // Radius kappa/(kappa^2 + tau^2), pitch 2 pi tau/(kappa^2 + tau^2), any number of pieces.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> some(-30.0, 30.0);
  for (int run = 0; run < 10; ++run)
  {
    RodSpec spec = hair(5, 4);
    spec.natural = {some(random), some(random), some(random)};
    const RodShape shape = SuperHelix(spec).shapeAt(Eigen::VectorXd::Zero(15));
    const Eigen::Vector3d kappa(spec.natural[0], spec.natural[1], spec.natural[2]);
    const Eigen::Vector3d axis = kappa.normalized();
    const double radius = std::hypot(kappa[1], kappa[2]) / kappa.squaredNorm();
    // The axis passes through root + (axis x e_1) / |kappa|.
    const Eigen::Vector3d centre = axis.cross(Eigen::Vector3d::UnitX()) / kappa.norm();
    for (size_t j = 0; j < shape.points.size(); ++j)
    {
      const Eigen::Vector3d arm = shape.points[j] - centre;
      const double along = axis.dot(arm);
      EXPECT_NEAR((arm - along * axis).norm(), radius, 1e-12);
      EXPECT_NEAR(along, axis[0] * 0.2 * (j + 0.5) / 20.0, 1e-12);
    }
  }
}

TEST(SuperHelixTest, PointColumnsAreTheDerivativeOfThePoses)
{
  // Against central differences of the closed shape; the quadrature of the columns is of order two in the section.
  double error[2];
  for (int k = 0; k < 2; ++k)
  {
    Scenario scenario = loadScenario("bodies:\n" + rod("hair", "{xyz: [0, 0, 1], rpy: [0.3, 0.7, 0.2]}",
                                                       ", pieces: 3, sections: " + std::to_string(8 << k) +
                                                           ", natural: [3, 8, -5], start: [4, 6, 2]"),
                                     "test");
    Simulator simulator(scenario);
    const BodyModel& model = simulator.workspace(0).model;
    BodyState state = simulator.state().bodies[0];
    Body body(model, state);
    body.middle.base_pose = state.base_pose;
    moveToImpact(body);
    const int link = 24 << k;  // the last
    PointColumns columns;
    addPointColumns(body, {link, 0, body.middle.link_pose[link].translation()}, 1.0, columns);
    ASSERT_EQ(columns.size(), 9u);
    error[k] = 0.0;
    for (const auto& [coordinate, motion] : columns)
    {
      Eigen::Vector3d end[2];
      for (int side = 0; side < 2; ++side)
      {
        Eigen::VectorXd q = state.q;
        q[coordinate] += (side == 0 ? -1.0 : 1.0) * 1e-4;
        MultibodyData data = body.middle;
        model.solid->setPoses(q, data);
        end[side] = data.link_pose[link].translation();
      }
      const Eigen::Vector3d difference = (end[1] - end[0]) / 2e-4;
      error[k] = std::max(error[k], (motion - difference).norm() / (difference.norm() + 1e-3));
    }
  }
  EXPECT_LT(error[1], 2e-3);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.3);
}

TEST(SuperHelixTest, ClampedStraightRodVibratesAsABeam)
{
  // First mode omega = 3.5160 sqrt(E I/(rho A L^4)) (Euler-Bernoulli, clamped and free), by the zero crossings of a
  // small vibration; from above, more pieces nearer.
  const double area = PI * 4e-6;
  const double inertia = 0.25 * PI * 1.6e-11;
  const double exact = 3.5160 * std::sqrt(1.0e7 * inertia / (1300.0 * area)) / 0.04;
  double error[2];
  for (int k = 0; k < 2; ++k)
  {
    Scenario scenario =
        loadScenario("gravity: [0, 0, 0]\ntime_step: 0.0025\nbodies:\n" +
                         rod("beam", "{xyz: [0, 0, 1]}", ", pieces: " + std::to_string(3 << k) + ", sections: 8"),
                     "test");
    Simulator simulator(scenario);
    // The static shape under a tip load, M(s) ~ (L - s): nearly the first mode.
    const int pieces = 3 << k;
    for (int piece = 0; piece < pieces; ++piece)
      simulator.position(0)[3 * piece + 1] = 1e-3 * (1.0 - (piece + 0.5) / pieces);
    simulator.stateChanged();
    double last = simulator.position(0)[1];
    std::vector<double> crossings;
    for (int step = 0; step < 4000 && crossings.size() < 9; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      const double now = simulator.position(0)[1];
      if (now * last < 0.0)
        crossings.push_back(simulator.time() - 0.0025 * now / (now - last));
      last = now;
    }
    ASSERT_EQ(crossings.size(), 9u);
    const double omega = 8.0 * PI / (crossings.back() - crossings.front());
    error[k] = omega / exact - 1.0;
  }
  EXPECT_LT(std::abs(error[1]), 0.02);
  EXPECT_LT(std::abs(error[1]), std::abs(error[0]) + 1e-3);
}

TEST(SuperHelixTest, SwingingRodKeepsItsEnergyToOrderTwo)
{
  // Rate terms of the acceleration: with a wrong one the energy drifts whatever dt is. Step and sections are halved
  // together: the columns of a point are a quadrature of order two in the section.
  double worst[2];
  for (int k = 0; k < 2; ++k)
  {
    const double dt = 2.5e-4 / (1 << k);
    Scenario scenario = loadScenario(
        "time_step: " + number(dt) + "\nbodies:\n" +
            rod("hair", "{xyz: [0, 0, 1]}",
                ", pieces: 3, natural: [1, 2, 4], start: [1.5, 3.5, 2], sections: " + std::to_string(12 << k)),
        "test");
    Simulator simulator(scenario);
    const double start = simulator.report().energy.kinetic + simulator.report().energy.potential;
    double largest = 0.0;
    worst[k] = 0.0;
    while (simulator.time() < 0.1 - 0.5 * dt)
    {
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
      const EnergyLedger& energy = simulator.report().energy;
      worst[k] = std::max(worst[k], std::abs(energy.kinetic + energy.potential - start));
      largest = std::max(largest, energy.kinetic);
    }
    EXPECT_LT(worst[k], 0.06 * largest);
  }
  EXPECT_LT(worst[1], 0.4 * worst[0]);
}

TEST(SuperHelixTest, CantileverHangsAsTheBeamSays)
{
  // Small load: tip w = rho A g L^4/(8 E I) by load steps from rest to rest; pieces of constant curvature: order two.
  const double area = PI * 4e-6;
  const double inertia = 0.25 * PI * 1.6e-11;
  const double stiff = 1.0e9;
  const double exact = 1300.0 * area * 9.81 * std::pow(0.2, 4) / (8.0 * stiff * inertia);
  double error[2];
  for (int k = 0; k < 2; ++k)
  {
    Scenario scenario = loadScenario(
        "quasi_static: true\nbodies:\n  - name: beam\n    rod: {length: 0.2, radius: 0.002, density: "
        "1300, young_modulus: 1.0e9, pieces: " +
            std::to_string(4 << k) + ", sections: " + std::to_string(16 >> k) + "}\n    pose: {xyz: [0, 0, 1]}\n",
        "test");
    Simulator simulator(scenario);
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    const MultibodyData& data = simulator.data(0);
    const double half = 0.5 * 0.2 / 64.0;
    const Eigen::Vector3d tip = data.link_pose.back() * Eigen::Vector3d(half, 0.0, 0.0);
    error[k] = (1.0 - tip.z()) / exact - 1.0;
  }
  EXPECT_LT(std::abs(error[1]), 0.01);
  EXPECT_NEAR(std::log2(std::abs(error[0] / error[1])), 2.0, 0.5);
}

/** Least distance of the centre lines by dense samples along each section's axis: nothing of the narrow phase. */
double leastDistance(const Simulator& simulator, int a, int b)
{
  double least = 1e9;
  const double half = 0.5 * 0.2 / 48.0;
  for (size_t i = 1; i < simulator.data(a).link_pose.size(); ++i)
    for (size_t j = 1; j < simulator.data(b).link_pose.size(); ++j)
    {
      const Eigen::Isometry3d& one = simulator.data(a).link_pose[i];
      const Eigen::Isometry3d& other = simulator.data(b).link_pose[j];
      if ((one.translation() - other.translation()).norm() > 0.02)
        continue;
      for (int s = -5; s <= 5; ++s)
        for (int t = -5; t <= 5; ++t)
          least = std::min(least, (one * Eigen::Vector3d(0.2 * s * half, 0.0, 0.0) -
                                   other * Eigen::Vector3d(0.2 * t * half, 0.0, 0.0))
                                      .norm());
    }
  return least;
}

TEST(RodContactTest, RodsDrivenIntoEachOtherDoNotPass)
{
  // A soft rod falls over a stiffer one that lies across, others sway on a support that is shaken: nothing goes
  // through.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> some(-1.0, 1.0);
  int touched = 0;
  for (int run = 0; run < 4; ++run)
  {
    const double curvature_1 = 2.0 * some(random);
    const double curvature_2 = 2.0 * some(random);
    const double beside = 0.02 * some(random);
    Scenario scenario = loadScenario(
        "time_step: 0.001\nmaterials: {default: {friction: 0.2}}\nbodies:\n" +
            rod("falling", "{xyz: [-0.12, 0, 0.03]}",
                ", damping: 0.01, natural: [0, " + number(curvature_1) + ", " + number(curvature_2) + "]") +
            rod("across", "{xyz: [" + number(beside) + ", -0.1, 0], rpy: [0, 0, 1.5707963]}", ", damping: 0.01",
                "    motion: {type: sine, axis: [1, 0, 0], amplitude: 0.02, frequency: 3}\n"),
        "test");
    Simulator simulator(scenario);
    double least = 1.0;
    for (int step = 0; step < 300; ++step)
    {
      ASSERT_TRUE(simulator.step().converged())
          << "run " << run << " step " << step << ": " << simulator.outcome().message;
      least = std::min(least, leastDistance(simulator, 0, 1));
      for (const ContactState& contact : simulator.contacts())
      {
        touched += contact.impulse.norm() > 0.0;
        EXPECT_GE(contact.cone_margin, -1e-9);
      }
    }
    EXPECT_GT(least, 0.004 - 1e-6) << "run " << run << ": two radii of 2 mm";
  }
  EXPECT_GT(touched, 50);
}

TEST(RodContactTest, HangingRodLiesOnTheGroundAndCarriesItsWeight)
{
  Scenario scenario = loadScenario("time_step: 0.001\nmaterials: {default: {friction: 0.5}}\nground: {}\nbodies:\n" +
                                       rod("rope", "{xyz: [0, 0, 0.05]}", ", damping: 0.02"),
                                   "test");
  Simulator simulator(scenario);
  for (int step = 0; step < 1500; ++step)
    ASSERT_TRUE(simulator.step().converged()) << step << ": " << simulator.outcome().message;
  double force = 0.0;
  for (const ContactState& contact : simulator.contacts())
    force += contact.impulse.z() / 0.001;
  const double weight = 1300.0 * PI * 4e-6 * 0.2 * 9.81;
  EXPECT_GT(force, 0.2 * weight);
  EXPECT_LT(force, weight);
  for (size_t link = 1; link < simulator.data(0).link_pose.size(); ++link)
    EXPECT_GT(simulator.data(0).link_pose[link].translation().z(), 0.002 - 1e-6);
  EXPECT_LT(simulator.velocity(0).lpNorm<Eigen::Infinity>(), 0.5) << "[1/(m s)]: it has come to lie";
}

TEST(RodKeysTest, BadOnesAreOneLine)
{
  const auto message = [](const std::string& more, const std::string& beside = "")
  {
    try
    {
      Simulator simulator(loadScenario("bodies:\n" + rod("hair", "{xyz: [0, 0, 1]}", more, beside), "test.yaml"));
    }
    catch (const std::exception& error)
    {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message(""), "no error");
  EXPECT_NE(message(", pieces: 0").find("pieces"), std::string::npos);
  EXPECT_NE(message(", natural: [1, 2]").find("natural"), std::string::npos);
  EXPECT_NE(message(", pieces: 2, natural: [[1, 2, 3]]").find("2 pieces"), std::string::npos);
  EXPECT_NE(message(", poisson_ratio: 0.6").find("poisson_ratio"), std::string::npos);
  EXPECT_NE(message("", "    motion: {angular: [0, 0, 1]}\n").find("does not turn"), std::string::npos);
  EXPECT_NE(message("", "    velocity: {linear: [0, 0, 1]}\n").find("velocity"), std::string::npos);
}

}  // namespace
}  // namespace frictional_contact_sim
