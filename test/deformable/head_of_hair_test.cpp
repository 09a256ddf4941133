// Generated heads of hair: rods that fall on a head that moves, and on each other. No step fails, nothing is inside the
// head by closed distances, no forces outside the cone, equal bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;
using test_support::list;
using test_support::text;

constexpr double STEP = 0.0005;
constexpr double HEAD_RADIUS = 0.06;
constexpr double HEIGHT = 0.4;
constexpr double ROD_RADIUS = 0.001;
constexpr double LENGTH = 0.15;
constexpr int SECTIONS = 3;
constexpr int PIECES = 5;

Scenario headOfHair(std::uint32_t seed)
{
  Dice dice(seed);
  const std::string motion = "{type: sine, axis: " + list(dice.vector(1.0).normalized()) +
                             ", amplitude: " + text(dice.uniform(0.0, 0.04)) +
                             ", frequency: " + text(dice.uniform(1.0, 4.0)) + "}";
  std::string yaml = "time_step: " + text(STEP) + "\nmaterials: {default: {friction: " + text(dice.uniform(0.0, 0.6)) +
                     "}}\nbodies:\n";
  const int hairs = dice.integer(12, 22);
  const double young = dice.logUniform(3e5, 8e6);
  for (int k = 0; k < hairs; ++k)
  {
    // From the crown down, and round by the golden angle.
    const double z = 1.0 - 1.2 * (k + 0.5) / hairs;
    const double yaw = 2.39996 * k;
    const Eigen::Vector3d normal(std::sqrt(1.0 - z * z) * std::cos(yaw), std::sqrt(1.0 - z * z) * std::sin(yaw), z);
    const Eigen::Vector3d root = Eigen::Vector3d(0.0, 0.0, HEIGHT) + (HEAD_RADIUS + 0.003) * normal;
    yaml += "  - {name: hair_" + std::to_string(k) + ", rod: {length: " + text(LENGTH) +
            ", radius: " + text(ROD_RADIUS) + ", pieces: " + std::to_string(PIECES) +
            ", sections: " + std::to_string(SECTIONS) + ", density: 1300, young_modulus: " + text(young) +
            ", damping: 0.004, natural: " + list(dice.vector(10.0)) + "}, pose: {xyz: " + list(root) + ", rpy: [0, " +
            text(-std::asin(z)) + ", " + text(yaw) + "]}, motion: " + motion + "}\n";
  }
  yaml += "  - {name: head, base: fixed, pose: {xyz: [0, 0, " + text(HEIGHT) + "]}, motion: " + motion +
          ", urdf: head.urdf}\n";
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "head.urdf") << "<robot name='head'><link name='head'><inertial><mass value='1'/><inertia "
                                         "ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial><collision>"
                                         "<geometry><sphere radius='" +
                                             text(HEAD_RADIUS) + "'/></geometry></collision></link></robot>";
  return loadScenario(yaml, folder + "head_of_hair.yaml");
}

class HeadOfHairTest : public testing::TestWithParam<int>
{
};

TEST_P(HeadOfHairTest, NoStepFailsAndNoHairIsInTheHead)
{
  const Scenario scenario = headOfHair(GetParam());
  Simulator simulator(scenario);
  Simulator twin(scenario);
  const int head = simulator.bodyCount() - 1;
  const double half = 0.5 * LENGTH / (PIECES * SECTIONS);
  int touching = 0;
  int steps = 0;
  for (bool is_slow = true; is_slow && steps < 700; ++steps)
  {
    ASSERT_TRUE(simulator.step().converged()) << "step " << steps << ": " << simulator.outcome().message;
    double least = 1.0;
    double spin = 0.0;
    double speed = 0.0;
    for (int body = 0; body < head; ++body)
      for (const Vector6d& velocity : simulator.data(body).link_velocity)
      {
        spin = std::max(spin, velocity.tail<3>().squaredNorm());
        speed = std::max(speed, velocity.head<3>().norm());
      }
    // A tip that cracks like a whip and moves by many radii a step asks for a smaller step, and may fail without.
    is_slow = STEP * speed < 10.0 * ROD_RADIUS;
    const Eigen::Vector3d centre = simulator.data(head).link_pose[0].translation();
    for (int body = 0; body < head; ++body)
      for (size_t link = 1; link < simulator.data(body).link_pose.size(); ++link)
      {
        // The nearest point of the section's axis.
        const Eigen::Vector3d there = simulator.data(body).link_pose[link].inverse() * centre;
        const Eigen::Vector3d nearest(std::clamp(there.x(), -half, half), 0.0, 0.0);
        least = std::min(least, (there - nearest).norm() - HEAD_RADIUS - ROD_RADIUS);
      }
    // Nothing goes through but for the curvature of a path in a step, and that is pushed out again.
    ASSERT_GT(least, -1e-6 - STEP * STEP * 0.2 * ROD_RADIUS * spin) << "step " << steps;
    for (const ContactState& contact : simulator.contacts())
    {
      ASSERT_GE(contact.cone_margin, -1e-9);
      touching += contact.impulse.norm() > 0.0;
    }
  }
  EXPECT_GT(touching, 50) << "they have met; steps " << steps;
  for (int step = 0; step < steps; ++step)
    twin.step();
  EXPECT_EQ(simulator.stateHash(), twin.stateHash());
}

INSTANTIATE_TEST_SUITE_P(Seeds, HeadOfHairTest, testing::Range(1, 7));

}  // namespace
}  // namespace frictional_contact_sim
