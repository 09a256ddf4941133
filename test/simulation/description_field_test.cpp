// Descriptions as users have them (../shared/field), each with a generator of its whole kind. Right values are those of
// the cases' READMEs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "frictional_contact_sim/simulation/scenario_error.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
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
namespace fs = std::filesystem;

std::string field(const std::string& file)
{
  return std::string(PROJECT_DIR) + "/../shared/field/" + file;
}

/** False, with a word, where the cases are not there. */
bool has(const std::string& file)
{
  const bool is_there = fs::exists(field(file));
  if (!is_there)
    std::printf("skipped: no %s\n", field(file).c_str());
  return is_there;
}

/** To the end of the case, every step converged. */
std::unique_ptr<AuditedSimulator> run(const Scenario& scenario)
{
  auto simulator = std::make_unique<AuditedSimulator>(scenario);
  while (simulator->time() < scenario.duration - 0.5 * scenario.time_step)
    EXPECT_TRUE(simulator->step().converged());
  return simulator;
}

std::vector<std::string> warningsWith(const Simulator& simulator, const std::string& part)
{
  std::vector<std::string> found;
  for (const std::string& warning : simulator.warnings())
    if (warning.find(part) != std::string::npos)
      found.push_back(warning);
  return found;
}

double angle(const Simulator& simulator, const std::string& joint)
{
  const MultibodyModel& model = simulator.model(0);
  return simulator.position(0)[model.joints[model.findJoint(joint)].q_index];
}

TEST(DescriptionFieldTest, TwoSlashesInAPackageUriAreOne)
{
  if (!has("package_double_slash/part.yaml"))
    return;
  const char* path = std::getenv("ROS_PACKAGE_PATH");
  const std::string before = path == nullptr ? "" : path;
  setenv("ROS_PACKAGE_PATH", field("package_double_slash").c_str(), 1);
  const auto simulator = run(loadScenarioFile(field("package_double_slash/part.yaml")));
  setenv("ROS_PACKAGE_PATH", before.c_str(), 1);
  EXPECT_GT(simulator->shapeCount(), 1);
}

TEST(DescriptionFieldTest, MapCoordinatesAreRight)
{
  if (!has("map_coordinates/utm.yaml"))
    return;
  const auto simulator = run(loadScenarioFile(field("map_coordinates/utm.yaml")));
  EXPECT_NEAR(simulator->position(0)[2], 0.05, 1e-9);
  EXPECT_LT(simulator->velocity(0).norm(), 1e-8);
  EXPECT_NEAR(simulator->position(0)[0], 500000.3, 1e-9);
  EXPECT_NEAR(simulator->position(0)[1], 4649776.7, 1e-8);
}

/** A cube slides and stops; where it starts must not matter beyond the resolution of its coordinates. */
TEST(DescriptionFieldTest, MotionAtRandomMapCoordinatesIsThatAtTheOrigin)
{
  for (std::uint32_t seed = 0; seed < 10; ++seed)
  {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    Scenario scene = groundScene(dice.uniform(0.1, 1.0));
    scene.duration = 0.3;
    addBody(scene, "cube", boxUrdf({0.1, 0.1, 0.1}, 1.0), poseAt(0.0, 0.0, 0.0501)).linear_velocity =
        Eigen::Vector3d(dice.uniform(-1.0, 1.0), dice.uniform(-1.0, 1.0), 0.0);
    const auto near = run(scene);
    const Eigen::Vector3d origin(dice.logUniform(1e3, 2.5e7), -dice.logUniform(1e3, 2.5e7), 0.0);
    scene.bodies[0].pose->translation() += origin;
    const auto far = run(scene);
    const Eigen::Vector3d difference = far->position(0).head<3>() - origin - near->position(0).head<3>();
    EXPECT_LT(difference.norm(), 300 * 8e-9);  // a rounding each step
    EXPECT_LT((far->velocity(0) - near->velocity(0)).norm(), 1e-7);
  }
}

TEST(DescriptionFieldTest, CoordinatesBeyondAllMapsAreRefusedByFileAndKey)
{
  if (!has("map_coordinates/cube.urdf"))
    return;
  Dice dice(5);
  for (int k = 0; k < 20; ++k)
  {
    const double far = dice.logUniform(3.1e7, 1e300) * (dice.chance(0.5) ? 1.0 : -1.0);
    const std::string yaml = "bodies:\n  - {name: cube, urdf: cube.urdf, pose: {xyz: [0, " + text(far) + ", 0]}}\n";
    try
    {
      const Simulator simulator(loadScenario(yaml, field("map_coordinates/far.yaml")));
      FAIL() << far;
    }
    catch (const std::exception& error)
    {
      for (const char* part : {"far.yaml:2:", "bodies[0]", "'cube'", "pose.xyz", "expected less than", "origin"})
        EXPECT_THAT(error.what(), testing::HasSubstr(part));
    }
  }
}

TEST(DescriptionFieldTest, BuriedStartIsNamedWithItsDepthAndIsNoExplosion)
{
  if (!has("buried_start/buried.yaml"))
    return;
  const auto simulator = run(loadScenarioFile(field("buried_start/buried.yaml")));
  simulator->waive("rise");  // it is lifted out
  EXPECT_THAT(warningsWith(*simulator, "deep in"),
              testing::ElementsAre(testing::AllOf(testing::HasSubstr("body 'cube'"), testing::HasSubstr("the ground"),
                                                  testing::HasSubstr(" 0.3 m deep"))));
  EXPECT_LT(simulator->velocity(0).norm(), 0.05);
}

/** The depth in "... starts 0.3 m deep in ...". */
double depthIn(const std::string& warning)
{
  return std::stod(warning.substr(warning.find(" starts ") + 8));
}

TEST(DescriptionFieldTest, RandomDepthsAreNamedOnceAPairAndRestIsNot)
{
  for (std::uint32_t seed = 0; seed < 40; ++seed)
  {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const double size = dice.logUniform(0.02, 2.0);
    const bool rests = dice.chance(0.3);
    const double in_ground = rests ? dice.uniform(-1e-9, 1e-5) * size : dice.logUniform(2e-3, 0.4) * size;
    const double in_box = rests ? dice.uniform(-1e-9, 1e-5) * size : dice.logUniform(2e-3, 0.4) * size;
    Scenario scene = groundScene(0.5);
    addBody(scene, "low", boxUrdf({size, size, size}, 1.0), poseAt(0.0, 0.0, 0.5 * size - in_ground));
    addBody(scene, "high", boxUrdf({size, size, size}, 1.0), poseAt(0.1 * size, 0.0, 1.5 * size - in_ground - in_box));
    const Simulator simulator(scene);
    const std::vector<std::string> ground = warningsWith(simulator, "deep in the ground");
    const std::vector<std::string> box = warningsWith(simulator, "deep in body");
    ASSERT_EQ(ground.size(), rests ? 0u : 1u);
    ASSERT_EQ(box.size(), rests ? 0u : 1u);
    if (rests)
      continue;
    EXPECT_NEAR(depthIn(ground[0]), in_ground, 1e-5 * in_ground);
    EXPECT_NEAR(depthIn(box[0]), in_box, 1e-5 * in_box);
    EXPECT_THAT(box[0], testing::AllOf(testing::HasSubstr("'low'"), testing::HasSubstr("'high'")));
  }
}

TEST(DescriptionFieldTest, ChainOfMimicsIsClosedAndMovesAsOne)
{
  if (!has("mimic_of_mimic/coupling.yaml"))
    return;
  const Scenario scenario = loadScenarioFile(field("mimic_of_mimic/coupling.yaml"));
  const Simulator start(scenario);
  EXPECT_NEAR(angle(start, "drive_joint"), 0.3, 1e-15);
  EXPECT_NEAR(angle(start, "mid_joint"), 0.4, 1e-15);
  EXPECT_NEAR(angle(start, "tip_joint"), -1.1, 1e-15);
  EXPECT_EQ(start.velocity(0).norm(), 0.0);
  const auto end = run(scenario);
  const double h = scenario.time_step;
  EXPECT_NEAR(angle(*end, "drive_joint"), 0.8, h);
  EXPECT_NEAR(angle(*end, "mid_joint"), 1.4, 2.0 * h);
  EXPECT_NEAR(angle(*end, "tip_joint"), -4.1, 6.0 * h);
  const MultibodyModel& model = end->model(0);
  EXPECT_NEAR(end->velocity(0)[model.joints[model.findJoint("tip_joint")].v_index], -6.0, 1e-9);
}

/** Joints of one world, each free or following one of the others, in random order in the file. */
struct MimicForest
{
  explicit MimicForest(Dice& dice, bool with_cycle)
  {
    const int count = dice.integer(3, 12);
    std::vector<std::string> joints;
    std::vector<double> start;
    std::string links = "<link name='world'/>";
    for (int i = 0; i < count; ++i)
    {
      const std::string name = std::to_string(i);
      int followed = i > 0 && dice.chance(0.7) ? dice.integer(0, i - 1) : -1;
      if (with_cycle && i < 3)
        followed = (i + 1) % 3;
      const double multiplier = dice.uniform(0.3, 2.0) * (dice.chance(0.5) ? 1.0 : -1.0);
      const double offset = dice.uniform(-0.5, 0.5);
      angles.push_back(followed < 0 || with_cycle ? dice.uniform(-1.0, 1.0)
                                                  : multiplier * angles[static_cast<size_t>(followed)] + offset);
      links += "<link name='l" + name +
               "'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' "
               "ixz='0' iyz='0'/></inertial></link>";
      std::string joint = "<joint name='j" + name + "' type='continuous'><parent link='world'/><child link='l" + name +
                          "'/><axis xyz='0 0 1'/>";
      if (followed >= 0)
        joint += "<mimic joint='j" + std::to_string(followed) + "' multiplier='" + number(multiplier) + "' offset='" +
                 number(offset) + "'/>";
      else
        body.joints["j" + name] = {angles.back(), 0.0};
      joints.push_back(joint + "</joint>");
    }
    for (size_t i = joints.size(); i > 1; --i)
      std::swap(joints[i - 1], joints[static_cast<size_t>(dice.integer(0, static_cast<int>(i) - 1))]);
    body.name = "forest";
    body.urdf_xml = "<robot name='forest'>" + links;
    for (const std::string& joint : joints)
      body.urdf_xml += joint;
    body.urdf_xml += "</robot>";
  }

  static std::string number(double value)
  {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", value);
    return digits;
  }

  BodySpec body;
  std::vector<double> angles;
};

TEST(DescriptionFieldTest, RandomMimicForestsStartClosedAndStayClosed)
{
  for (std::uint32_t seed = 0; seed < 60; ++seed)
  {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const MimicForest forest(dice, false);
    Scenario scene;
    scene.bodies.push_back(forest.body);
    for (const auto& [joint, init] : forest.body.joints)
      scene.bodies[0].commands[joint].target = dice.uniform(-1.0, 1.0);
    AuditedSimulator simulator(scene);
    for (size_t i = 0; i < forest.angles.size(); ++i)
      EXPECT_NEAR(angle(simulator, "j" + std::to_string(i)), forest.angles[i], 1e-13);
    for (int step = 0; step < 20; ++step)
      ASSERT_TRUE(simulator.step().converged());
    for (const Joint& joint : simulator.model(0).joints)
    {
      if (joint.mimic.joint < 0)
        continue;
      const double followed = simulator.position(0)[simulator.model(0).joints[joint.mimic.joint].q_index];
      EXPECT_NEAR(simulator.position(0)[joint.q_index], joint.mimic.multiplier * followed + joint.mimic.offset, 1e-9);
    }
  }
}

TEST(DescriptionFieldTest, CyclesOfMimicsAreRefusedByName)
{
  for (std::uint32_t seed = 0; seed < 20; ++seed)
  {
    Dice dice(seed);
    Scenario scene;
    scene.bodies.push_back(MimicForest(dice, true).body);
    try
    {
      const Simulator simulator(scene);
      FAIL() << "a cycle is taken";
    }
    catch (const ModelError& error)
    {
      EXPECT_THAT(error.what(), testing::ContainsRegex("joint 'j[0-9]+': <mimic> follows itself: 'j"));
    }
  }
}

TEST(DescriptionFieldTest, JointAtItsLimitInFreeFallStaysThere)
{
  for (const auto& [file, limit] : {std::make_pair("finger_a", 0.263), std::make_pair("finger_b", 0.4398)})
  {
    const std::string path = std::string("limit_in_free_fall/") + file + ".yaml";
    if (!has(path))
      return;
    const auto simulator = run(loadScenarioFile(field(path)));
    for (const Joint& joint : simulator->model(0).joints)
    {
      if (velocitySize(joint.type) == 1 && joint.limit.lower > 0.0)
      {
        EXPECT_NEAR(simulator->position(0)[joint.q_index], limit, 1e-9);
      }
    }
  }
}

TEST(DescriptionFieldTest, RandomFingersAtTheirLimitsFallFreely)
{
  for (std::uint32_t seed = 0; seed < 30; ++seed)
  {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    std::string xml = "<robot name='hand'><link name='l0'><inertial><mass value='" + text(dice.logUniform(0.1, 10.0)) +
                      "'/><inertia ixx='0.01' iyy='0.02' izz='0.015' ixy='0' ixz='0' iyz='0'/></inertial></link>";
    const int fingers = dice.integer(1, 8);
    std::vector<double> limits;
    for (int i = 1; i <= fingers; ++i)
    {
      const double side = dice.chance(0.5) ? 1.0 : -1.0;
      const double near = dice.uniform(0.1, 1.0);
      const double far = near + dice.uniform(0.1, 3.0);
      limits.push_back(side * near);
      const std::string name = std::to_string(i);
      xml += "<link name='l" + name + "'><inertial><origin xyz='" + text(dice.vector(0.1)) + "'/><mass value='" +
             text(dice.logUniform(0.01, 1.0)) +
             "'/><inertia ixx='1e-4' iyy='1e-4' izz='1e-4' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j" +
             name + "' type='revolute'><parent link='l" + std::to_string(dice.integer(0, i - 1)) + "'/><child link='l" +
             name + "'/><origin xyz='" + text(dice.vector(0.2)) + "' rpy='" + text(dice.vector(3.0)) +
             "'/><axis xyz='0 1 0'/><limit lower='" + text(side > 0.0 ? near : -far) + "' upper='" +
             text(side > 0.0 ? far : -near) + "' effort='10' velocity='10'/></joint>";
    }
    Scenario scene = groundScene(0.8);
    scene.duration = 0.1;
    BodySpec& body = addBody(scene, "hand", xml + "</robot>", poseAt(0.0, 0.0, 2.0));
    body.base = BaseType::FLOATING;
    const auto simulator = run(scene);
    for (int i = 1; i <= fingers; ++i)
      EXPECT_NEAR(angle(*simulator, "j" + std::to_string(i)), limits[static_cast<size_t>(i) - 1], 1e-9);
  }
}

}  // namespace
}  // namespace frictional_contact_sim
