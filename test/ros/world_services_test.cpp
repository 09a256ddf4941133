// Several robots, names that stay, and what ~spawn and ~attach make of a request.
#include "frictional_contact_sim/ros/world_services.h"

#include <gtest/gtest.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <functional>

#include "frictional_contact_sim/ros/body_joint_publisher.h"

namespace frictional_contact_sim
{
namespace
{
using XmlRpc::XmlRpcValue;

std::string pendulum()
{
  return "<robot name='p'><link name='world'/><link name='rod'><inertial><mass value='1'/><inertia ixx='0.1' ixy='0' "
         "ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link><joint name='hinge' type='continuous'><parent "
         "link='world'/><child link='rod'/><axis xyz='0 1 0'/></joint></robot>";
}

std::string noDescription(const std::string&)
{
  return "";
}

BodySpec body(const std::string& name, double x)
{
  BodySpec spec;
  spec.name = name;
  spec.urdf_xml = pendulum();
  spec.pose = Eigen::Isometry3d(Eigen::Translation3d(x, 0.0, 1.0));
  return spec;
}

std::string refusal(const std::function<void()>& request)
{
  try
  {
    request();
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "";
}

TEST(NameRulesTest, NamesStayWhileBodiesComeAndGo)
{
  Scenario scenario;
  scenario.bodies = {body("one", 0.0)};
  Simulator simulator(scenario);
  NameRules rules = nameRules(simulator);
  EXPECT_EQ(makeNameTable(simulator, rules).joints[0].name, "hinge");
  simulator.spawn(body("two", 1.0));
  rules.prefixed.insert("two");
  NameTable names = makeNameTable(simulator, rules);
  EXPECT_EQ(names.joints[0].name, "hinge");
  EXPECT_EQ(names.joints[1].name, "two/hinge");
  EXPECT_EQ(names.frames[1][1], "two/rod");
  EXPECT_EQ(findJoint(names, "two/hinge"), 1);
  sensor_msgs::JointState message;
  simulator.position(1)[0] = 0.5;
  fillBodyJointState(simulator, names, 1, ros::Time(0, 1), message);
  EXPECT_EQ(message.name, std::vector<std::string>{"hinge"});
  EXPECT_EQ(message.position, std::vector<double>{0.5});
  simulator.remove("one");
  names = makeNameTable(simulator, rules);
  ASSERT_EQ(names.joints.size(), 1U);
  EXPECT_EQ(names.joints[0].name, "two/hinge");
}

TEST(NameRulesTest, TwinsOfAScenarioKeepTheirPrefixWhenOneIsLeft)
{
  Scenario scenario;
  scenario.bodies = {body("left", 0.0), body("right", 1.0)};
  Simulator simulator(scenario);
  const NameRules rules = nameRules(simulator);
  EXPECT_EQ(rules.first, "left");
  simulator.remove("left");
  EXPECT_EQ(makeNameTable(simulator, rules).joints[0].name, "right/hinge");
}

TEST(RobotsParameterTest, RobotsAreBodiesOfTheScenario)
{
  XmlRpcValue tree;
  tree["robots"]["left"]["description"] = "left_urdf";
  tree["robots"]["right"]["description"] = pendulum();
  tree["robots"]["right"]["base"] = "fixed";
  tree["robots"]["right"]["pose"]["xyz"].setSize(3);
  for (int i = 0; i < 3; ++i)
    tree["robots"]["right"]["pose"]["xyz"][i] = 1.0 + i;
  tree["default_friction"] = 0.25;
  tree["base_pose"] = "not used";
  const auto find = [](const std::string& name) { return name == "left_urdf" ? pendulum() : std::string(); };
  const NodeParameters parameters = readParameters(tree, "<robot name='not used'/>", find);
  ASSERT_EQ(parameters.scenario.bodies.size(), 2U);
  EXPECT_EQ(parameters.scenario.bodies[0].urdf_xml, pendulum());
  EXPECT_EQ(parameters.scenario.bodies[1].base, BaseType::FIXED);
  EXPECT_EQ(parameters.scenario.bodies[1].pose->translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(parameters.robots, (std::set<std::string>{"left", "right"}));
  EXPECT_EQ(parameters.scenario.materials.fallback.friction, 0.25);
  EXPECT_TRUE(parameters.scenario.ground.has_value());
  ASSERT_EQ(parameters.warnings.size(), 1U);
  EXPECT_EQ(parameters.warnings[0], "~base_pose: ignored, ~robots says it");
  // What is wrong is one line that names it.
  tree["robots"]["left"]["description"] = "nowhere";
  const std::string line = refusal([&] { readParameters(tree, "", find); });
  EXPECT_NE(line.find("robots/left/description"), std::string::npos) << line;
  EXPECT_NE(line.find("found 'nowhere', expected a URDF document"), std::string::npos) << line;
}

TEST(WorldRequestTest, LinksAreFoundByEveryNameTheyHave)
{
  Scenario scenario;
  scenario.bodies = {body("one", 0.0), body("two", 1.0)};
  const Simulator simulator(scenario);
  const NameTable names = makeNameTable(simulator);
  const auto read = [&](const std::string& body, const std::string& link)
  { return readLink("_a", body, link, simulator, names); };
  EXPECT_EQ(read("two", "rod").body, 1);
  EXPECT_EQ(read("", "two/rod").body, 1);
  EXPECT_EQ(read("", "two/rod").link, "rod");
  EXPECT_EQ(read("world", "").body, -1);
  EXPECT_EQ(read("", "world").body, -1) << "two bodies have a link of that name: the world itself";
  EXPECT_NE(refusal([&] { read("", "rod"); }).find("which 2 bodies have"), std::string::npos);
  EXPECT_NE(refusal([&] { read("three", "rod"); }).find("body_a: found 'three'"), std::string::npos);
  EXPECT_NE(refusal([&] { read("one", "rood"); }).find("did you mean 'rod'?"), std::string::npos);
  EXPECT_NE(refusal([&] { read("world", "rood"); }).find("body_a: found 'world'"), std::string::npos);
}

TEST(WorldRequestTest, ASpawnIsReadInTheFrameOfALink)
{
  Scenario scenario;
  scenario.bodies = {body("one", 3.0)};
  scenario.bodies[0].joints["hinge"].position = 0.5;
  const Simulator simulator(scenario);
  const NameTable names = makeNameTable(simulator);
  Spawn::Request request;
  request.name = "new";
  request.urdf = pendulum();
  FrameResolver frames(simulator, names, false);
  EXPECT_FALSE(readSpawn(request, frames, noDescription).pose) << "all zero: not given";
  request.frame_id = "rod";
  request.pose.position.x = 1.0;
  request.pose.orientation.w = 1.0;
  request.twist.linear.z = 2.0;
  const BodySpec spec = readSpawn(request, frames, noDescription);
  // The rod is turned by 0.5 about y: its x axis points to (cos, 0, -sin), its z axis to (sin, 0, cos).
  EXPECT_LE((spec.pose->translation() - Eigen::Vector3d(3.0 + std::cos(0.5), 0.0, 1.0 - std::sin(0.5))).norm(), 1e-12);
  EXPECT_LE((spec.linear_velocity - 2.0 * Eigen::Vector3d(std::sin(0.5), 0.0, std::cos(0.5))).norm(), 1e-12);
}

}  // namespace
}  // namespace frictional_contact_sim
