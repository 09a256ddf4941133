// What statics and quasi-statics may be asked of, and that only what touches carries.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "frictional_contact_sim/deformable/elastic_solid.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/dice.h"
#include "support/message_of.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::messageOf;

using testing::HasSubstr;

const char* const BOX =
    "<robot name='r'><link name='box'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' "
    "iyz='0' "
    "izz='0.01'/></inertial><collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link></robot>";

BodySpec boxAt(const std::string& name, double z)
{
  BodySpec body;
  body.name = name;
  body.urdf_xml = BOX;
  body.base = BaseType::FLOATING;
  body.pose = Eigen::Isometry3d::Identity();
  body.pose->translation().z() = z;
  return body;
}

Scenario scene(Regime regime, double time_step = 0.001)
{
  Scenario scenario;
  scenario.regime = regime;
  scenario.time_step = time_step;
  scenario.ground = GroundSpec{};
  return scenario;
}

std::string loadingMessage(const std::string& yaml)
{
  return messageOf([&] { Simulator simulator(loadScenario(yaml, "test.yaml")); });
}

TEST(StaticContactTest, OnlyWhatTouchesCarriesWhateverTheTimeStep)
{
  test_support::Dice dice(2);
  for (int draw = 0; draw < 20; ++draw)
  {
    const double time_step = dice.logUniform(1e-6, 10.0);
    const double gap = dice.logUniform(2e-9, 5.0);
    Scenario scenario = scene(Regime::STATIC, time_step);
    scenario.bodies.push_back(boxAt("box", 0.1 + gap));
    Simulator hovering(scenario);
    EXPECT_FALSE(hovering.step().converged()) << gap << " m above the ground, time_step " << time_step;
    EXPECT_THAT(hovering.outcome().message, HasSubstr("no equilibrium exists"));
    for (const double near : {0.0, 5e-10, -1e-4})
    {
      scenario.bodies.back().pose->translation().z() = 0.1 + near;
      Simulator standing(scenario);
      ASSERT_TRUE(standing.step().converged()) << standing.outcome().message << " time_step " << time_step;
      EXPECT_LE(standing.report().residual, 1e-8) << "forces at rest, time_step " << time_step;
      double carried = 0.0;
      for (const ContactState& contact : standing.contacts())
      {
        carried += contact.impulse.z() / time_step;
        EXPECT_LT(contact.velocity.norm(), 1e-15) << "nothing moves";
      }
      EXPECT_NEAR(carried, 9.81, 1e-6);
    }
  }
}

TEST(StaticContactTest, AFloatingBoxOverAStandingOneIsWhatFails)
{
  Scenario scenario = scene(Regime::STATIC, 1.0);
  scenario.bodies.push_back(boxAt("lower", 0.1));
  scenario.bodies.push_back(boxAt("upper", 0.3 + 1e-3));
  Simulator simulator(scenario);
  EXPECT_FALSE(simulator.step().converged());
  EXPECT_THAT(simulator.outcome().message, HasSubstr("'upper' moves most"));
}

std::string block(const std::string& fixed, const std::string& beside = "")
{
  return "bodies:\n  - name: block\n    elastic: {box: [0.1, 0.1], cells: [2, 2], young_modulus: 1.0e6, poisson_ratio: "
         "0.3, density: 1000" +
         fixed + "}\n    pose: {xyz: [0, 0, 1]}\n" + beside;
}

TEST(RegimeTest, StaticsTakesElasticBodiesThatAreHeldAndNoRods)
{
  EXPECT_EQ(loadingMessage("static: true\n" + block(", fixed: [top]")), "no error");
  EXPECT_THAT(loadingMessage("static: true\n" + block("")), HasSubstr("body 'block' moves freely"));
  EXPECT_THAT(
      loadingMessage("static: true\nbodies:\n  - name: hair\n    rod: {length: 0.2, radius: 0.002, density: 1300, "
                     "young_modulus: 1.0e7}\n    pose: {xyz: [0, 0, 1]}\n"),
      HasSubstr("body 'hair' is a rod"));
}

TEST(RegimeTest, ABlockOnOneNodeIsNotHeld)
{
  // By one node it may turn in the plane; by two it may not. In quasi-statics it creeps instead, to forces in balance.
  const ElasticMesh mesh = boxMesh({0.1, 0.1}, {2, 2});
  ElasticMaterial material;
  material.young_modulus = 1e6;
  material.poisson_ratio = 0.3;
  material.density = 1000.0;
  for (size_t a = 0; a < mesh.nodes.size(); ++a)
    for (size_t b = a; b < mesh.nodes.size(); ++b)
    {
      const ElasticSolid solid("block", assembleElastic(mesh, material), {static_cast<int>(a), static_cast<int>(b)},
                               0.0);
      EXPECT_EQ(solid.staticsRefusal().empty(), a != b) << a << ' ' << b;
    }
}

TEST(RegimeTest, VelocitiesAtTheStartAreRefusedWhereNothingHasInertia)
{
  const std::string velocity = "    velocity: {linear: [0, 0, 1]}\n";
  for (const char* const regime : {"quasi_static", "static"})
  {
    EXPECT_THAT(loadingMessage(std::string(regime) + ": true\n" + block("", velocity)),
                HasSubstr("body 'block' has a velocity at the start"));
    Scenario scenario = scene(regime == std::string("static") ? Regime::STATIC : Regime::QUASI_STATIC);
    scenario.bodies.push_back(boxAt("box", 0.1));
    scenario.bodies.back().linear_velocity.x() = 0.1;
    EXPECT_THAT(messageOf([&] { Simulator simulator(scenario); }), HasSubstr("body 'box' has a velocity at the start"));
    scenario.bodies.back().linear_velocity.setZero();
    Simulator simulator(scenario);
    simulator.velocity(0)[0] = 1.0;
    EXPECT_FALSE(simulator.stateChanged().taken);
    EXPECT_THAT(simulator.outcome().message, HasSubstr("expected none where every step is an equilibrium"));
    EXPECT_TRUE(simulator.velocity(0).isZero(0.0));
    SimulationState state = simulator.state();
    state.bodies[0].v[0] = 1.0;
    EXPECT_THAT(messageOf([&] { simulator.setState(state); }), HasSubstr("body 'box': it has a velocity"));
  }
}

TEST(RegimeTest, ASpawnedBodyIsAskedTheSame)
{
  Simulator simulator(loadScenario("static: true\n" + block(", fixed: [top]"), "test"));
  EXPECT_THAT(messageOf([&] { simulator.spawn(boxAt("box", 3.0)); }), HasSubstr("body 'box' moves freely"));
  const Scenario rod = loadScenario(
      "bodies:\n  - name: hair\n    rod: {length: 0.2, radius: 0.002, density: 1300, young_modulus: 1.0e7}\n    pose: "
      "{xyz: "
      "[0, 0, 3]}\n",
      "test");
  EXPECT_THAT(messageOf([&] { simulator.spawn(rod.bodies.front()); }), HasSubstr("is a rod"));
  Scenario quasi = scene(Regime::QUASI_STATIC);
  quasi.bodies.push_back(boxAt("box", 0.1));
  Simulator creeping(quasi);
  BodySpec moving = boxAt("moving", 3.0);
  moving.angular_velocity.z() = 1.0;
  EXPECT_THAT(messageOf([&] { creeping.spawn(moving); }), HasSubstr("has a velocity at the start"));
  EXPECT_EQ(creeping.bodyCount(), 1);
}

}  // namespace
}  // namespace frictional_contact_sim
