// What a scenario says of a body's links: self_collision, materials by link.
#include <gtest/gtest.h>

#include <set>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
const std::string INERTIAL =
    "<inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial>";

std::string box(const std::string& link, const std::string& xyz)
{
  return "<link name='" + link + "'>" + INERTIAL + "<collision><origin xyz='" + xyz +
         "'/><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>";
}

/** A wall, and a ram two joints from it, 0.5 m apart: links of one joint never collide. */
Scenario ramScene(bool self_collision)
{
  Scenario scene;
  scene.gravity.setZero();
  BodySpec body;
  body.name = "press";
  body.base = BaseType::FIXED;
  body.urdf_xml = "<robot name='press'>" + box("wall", "0 0 0") + "<link name='carriage'>" + INERTIAL + "</link>" +
                  box("ram", "0.6 0 0");
  for (const char* joint : {"coarse", "fine"})
    body.urdf_xml += std::string("<joint name='") + joint + "' type='prismatic'><parent link='" +
                     (joint[0] == 'c' ? "wall" : "carriage") + "'/><child link='" +
                     (joint[0] == 'c' ? "carriage" : "ram") +
                     "'/><axis xyz='1 0 0'/><limit lower='-5' upper='5' effort='100' velocity='10'/></joint>";
  body.urdf_xml += "</robot>";
  body.self_collision = self_collision;
  body.commands["fine"].target = -2.0;
  scene.bodies.push_back(body);
  return scene;
}

/** A sledge on two runners, which fixed joints hold to it. */
Scenario sledgeScene()
{
  Scenario scene = groundScene(0.8);
  scene.materials.materials["ice"].friction = 0.05;
  scene.materials.materials["rubber"].friction = 0.7;
  std::string urdf = "<robot name='sledge'><link name='seat'>" + INERTIAL + "</link>" + box("left", "0 0.3 0") +
                     box("right", "0 -0.3 0");
  for (const char* link : {"left", "right"})
    urdf += std::string("<joint name='") + link + "_mount' type='fixed'><parent link='seat'/><child link='" + link +
            "'/></joint>";
  BodySpec& body = addBody(scene, "sledge", urdf + "</robot>", poseAt(0, 0, 0.05));
  body.link_materials = {{"left", "ice"}, {"right", "rubber"}};
  return scene;
}

std::string complaint(const Scenario& scene)
{
  try
  {
    Simulator simulator(scene);
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "accepted";
}
}  // namespace

TEST(SelfCollisionTest, LinksMeetUnlessTheScenarioSaysOtherwise)
{
  double reached[2];
  for (const bool self_collision : {true, false})
  {
    Simulator simulator(ramScene(self_collision));
    for (int step = 0; step < 2000; ++step)
      ASSERT_TRUE(simulator.step().converged());
    const Eigen::VectorXd& q = simulator.position(0);
    reached[self_collision] = 0.6 + q[0] + q[1];  // between the centres of both boxes
  }
  EXPECT_NEAR(reached[true], 0.1, 1e-9);
  EXPECT_LT(reached[false], -0.5);
}

TEST(LinkMaterialsTest, EveryLinkHasItsOwn)
{
  Simulator simulator(sledgeScene());
  for (int step = 0; step < 5; ++step)
    ASSERT_TRUE(simulator.step().converged());
  std::set<std::string> seen;
  for (const ContactState& contact : simulator.contacts())
  {
    const ShapeInfo& a = simulator.shape(contact.shape_a);
    const std::string link = a.body >= 0 ? a.link_name : simulator.shape(contact.shape_b).link_name;
    EXPECT_EQ(contact.friction, link == "left" ? 0.05 : 0.7) << link;
    seen.insert(link);
  }
  EXPECT_EQ(seen, (std::set<std::string>{"left", "right"}));
}

TEST(LinkMaterialsTest, UnknownLinksAreNamedWithTheNearest)
{
  Scenario scene = sledgeScene();
  scene.bodies[0].link_materials = {{"rihgt", "ice"}};
  EXPECT_EQ(complaint(scene), "body 'sledge': materials names an unknown link 'rihgt', did you mean 'right'?");
  scene.bodies[0].link_materials.clear();
  scene.bodies[0].disable_collisions = {{"left", "rigth"}};
  EXPECT_EQ(complaint(scene), "body 'sledge': disable_collisions names an unknown link 'rigth', did you mean 'right'?");
  scene.bodies[0].disable_collisions.clear();
  scene.bodies[0].wrenches.push_back({"saet"});
  EXPECT_EQ(complaint(scene), "body 'sledge': wrenches names an unknown link 'saet', did you mean 'seat'?");
}

TEST(LinkMaterialsTest, AreReadFromAScenario)
{
  const auto load = [](const std::string& lines)
  {
    return loadScenario("materials: {ice: {friction: 0.05}}\nbodies:\n  - name: block\n    urdf: " +
                            std::string(PROJECT_DIR) + "/urdf/block.urdf\n" + lines,
                        "scene.yaml");
  };
  const BodySpec body = load("    materials: {runner: ice}\n    self_collision: false\n").bodies.at(0);
  EXPECT_EQ(body.link_materials.at("runner"), "ice");
  EXPECT_FALSE(body.self_collision);
  try
  {
    load("    materials:\n      runner: icce\n");
    FAIL() << "accepted";
  }
  catch (const ScenarioError& error)
  {
    EXPECT_STREQ(error.what(),
                 "scene.yaml:6: key 'bodies[0].materials.runner': found 'icce', did you mean 'ice'? expected a name "
                 "from materials: default, ice");
  }
}

}  // namespace frictional_contact_sim
