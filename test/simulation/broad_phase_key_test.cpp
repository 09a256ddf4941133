// The scenario's broad_phase changes who looks for pairs, not a bit of what is simulated.
#include <gtest/gtest.h>

#include <random>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
namespace
{
/// 4 x 4 x 4 balls with friction that fall on the ground, each another millimetre out of line.
Scenario pile(BroadPhaseKind kind)
{
  Scenario scenario;
  scenario.ground.emplace();
  scenario.broad_phase = kind;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
  for (int k = 0; k < 64; ++k)
  {
    BodySpec body;
    body.name = "ball_" + std::to_string(k);
    body.urdf_xml =
        "<robot name='ball'><link name='ball'><inertial><mass value='10'/><inertia ixx='0.04' iyy='0.04' izz='0.04' "
        "ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
        "</robot>";
    body.pose.emplace(Eigen::Isometry3d::Identity());
    const double x = noise(random), y = noise(random);
    body.pose->translation() = Eigen::Vector3d(0.21 * (k % 4) + x, 0.21 * (k / 4 % 4) + y, 0.105 + 0.21 * (k / 16));
    scenario.bodies.push_back(body);
  }
  return scenario;
}

TEST(BroadPhaseKeyTest, ListTreesAndAutoGiveTheSameBits)
{
  Simulator list(pile(BroadPhaseKind::LIST));
  Simulator trees(pile(BroadPhaseKind::FCL));
  Simulator automatic(pile(BroadPhaseKind::AUTO));
  for (int step = 0; step < 200; ++step)
  {
    list.step();
    trees.step();
    automatic.step();
    ASSERT_EQ(list.stateHash(), trees.stateHash()) << step;
    ASSERT_EQ(list.stateHash(), automatic.stateHash()) << step;
  }
  EXPECT_GE(list.contacts().size(), 64u);
}

TEST(BroadPhaseKeyTest, IsReadAndAnUnknownNameIsRefused)
{
  const auto kind = [](const std::string& line) { return loadScenario(line + "bodies: []\n", "file").broad_phase; };
  EXPECT_EQ(kind(""), BroadPhaseKind::AUTO);
  EXPECT_EQ(kind("broad_phase: auto\n"), BroadPhaseKind::AUTO);
  EXPECT_EQ(kind("broad_phase: fcl\n"), BroadPhaseKind::FCL);
  EXPECT_EQ(kind("broad_phase: list\n"), BroadPhaseKind::LIST);
  try
  {
    kind("broad_phase: tree\n");
    FAIL();
  }
  catch (const ScenarioError& error)
  {
    EXPECT_NE(std::string(error.what()).find("found 'tree', expected auto, fcl or list"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace frictional_contact_sim
