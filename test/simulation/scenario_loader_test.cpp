// Every mistake in a scenario file is one line that names the file, the key, and what was expected.
#include "frictional_contact_sim/simulation/scenario_loader.h"

#include <gtest/gtest.h>

#include <string>

namespace frictional_contact_sim
{
namespace
{
const std::string FILE_NAME = std::string(PROJECT_DIR) + "/test/simulation/scene.yaml";
const std::string BLOCK = std::string(PROJECT_DIR) + "/urdf/block.urdf";

std::string withBody(const std::string& lines)
{
  return "bodies:\n  - name: block\n    urdf: " + BLOCK + "\n" + lines;
}

TEST(ScenarioLoaderTest, ReadsEveryKeyOfTheFormat)
{
  const Scenario scenario = loadScenario(
      "time_step: 0.002\nduration: 3\ngravity: [0, 0, -1.6]\n"
      "solver: {name: gauss_seidel, tolerance: 1.0e-9, max_iterations: 77}\n"
      "materials:\n  default: {friction: 0.5, restitution: 0.25}\n"
      "  pairs: [{between: [steel, rubber], friction: 0.9, restitution: 0.1}]\n"
      "ground: {friction: 0.4, height: 0.1}\n" +
          withBody(
              "    base: floating\n    pose: {xyz: [1, 2, 3], rpy: [0, 0, 1.5707963267948966]}\n"
              "    velocity: {linear: [1, 0, 0], angular: [0, 0, 2]}\n"
              "    joints: {hip: {position: 0.1, velocity: 0.2}}\n"
              "    commands: {hip: {position: 0.2, kp: 80, kd: 2}, knee: {velocity: 1, max_effort: 5}}\n"
              "    wrenches: [{link: base, force: [10, 0, 0], point: [0, 0, 1], frame: link, from: 0.5, until: 1}]\n"
              "    material: rubber\n    disable_collisions: [[a, b]]\n"),
      FILE_NAME);
  EXPECT_EQ(scenario.time_step, 0.002);
  EXPECT_EQ(scenario.solver, "gauss_seidel");
  EXPECT_EQ(scenario.stopping.max_iterations, 77);
  EXPECT_EQ(scenario.materials.pairs.at({"rubber", "steel"}).friction, 0.9);
  EXPECT_EQ(scenario.ground->height, 0.1);
  const BodySpec& body = scenario.bodies.at(0);
  EXPECT_NEAR((body.pose->linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_EQ(body.commands.at("knee").mode, JointCommand::Mode::VELOCITY);
  EXPECT_EQ(body.commands.at("hip").kp, 80.0);
  EXPECT_FALSE(body.wrenches.at(0).world_frame);
  EXPECT_EQ(body.joints.at("hip").velocity, 0.2);
}

TEST(ScenarioLoaderTest, SolverIsANameOrAMapWithOptions)
{
  EXPECT_EQ(loadScenario("solver: admm\n" + withBody(""), FILE_NAME).solver, "admm");
  const Scenario scenario = loadScenario(
      "solver: {name: cadoux_fixed_point, options: {inner: admm, relaxation: 0.5}}\n" + withBody(""), FILE_NAME);
  EXPECT_EQ(scenario.solver, "cadoux_fixed_point");
  EXPECT_EQ(scenario.solver_options, (SolverOptions{{"inner", "admm"}, {"relaxation", "0.5"}}));
}

TEST(ScenarioLoaderTest, GroundIsAMapOrAWord)
{
  EXPECT_TRUE(loadScenario("ground:\n" + withBody(""), FILE_NAME).ground.has_value());
  EXPECT_TRUE(loadScenario("ground: true\n" + withBody(""), FILE_NAME).ground.has_value());
  EXPECT_FALSE(loadScenario("ground: false\n" + withBody(""), FILE_NAME).ground.has_value());
  EXPECT_FALSE(loadScenario(withBody(""), FILE_NAME).ground.has_value());
}

struct BadCase
{
  const char* name;
  std::string yaml;
  const char* key;  ///< must be in the message
  const char* expected;  ///< so must this
};

class BadScenarioTest : public testing::TestWithParam<BadCase>
{
};

TEST_P(BadScenarioTest, IsOneClearLine)
{
  try
  {
    loadScenario(GetParam().yaml, FILE_NAME);
    FAIL() << "accepted";
  }
  catch (const ScenarioError& error)
  {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find("scene.yaml"), std::string::npos) << message;
    EXPECT_NE(message.find(GetParam().key), std::string::npos) << message;
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadScenarioTest,
    testing::Values(
        BadCase{"unknown_key", "bodys: []\n", "bodys", "unknown key"},
        BadCase{"no_bodies", "duration: 1\n", "bodies", "expected"},
        BadCase{"broken_yaml", "bodies: [\n", "scene.yaml", "not valid YAML"},
        BadCase{"not_a_map", "hello\n", "the document", "expected a map"},
        BadCase{"negative_step", "time_step: -1\n" + withBody(""), "time_step", "in [1e-09, 1000]"},
        BadCase{"nan_gravity", "gravity: [0, 0, .nan]\n" + withBody(""), "gravity[2]", "finite"},
        BadCase{"two_numbers", "gravity: [0, 0]\n" + withBody(""), "gravity", "3 numbers"},
        BadCase{"word_for_number", "duration: long\n" + withBody(""), "duration", "expected a number"},
        BadCase{"unknown_solver", "solver: {name: magic}\n" + withBody(""), "solver.name", "gauss_seidel"},
        BadCase{"zero_tolerance", "solver: {tolerance: 0}\n" + withBody(""), "solver.tolerance", "> 0"},
        BadCase{"negative_friction", "materials: {default: {friction: -0.1}}\n" + withBody(""),
                "materials.default.friction", ">= 0"},
        BadCase{"restitution_two", "materials: {default: {restitution: 2}}\n" + withBody(""),
                "materials.default.restitution", "in [0, 1]"},
        BadCase{"missing_urdf", "bodies: [{name: a, urdf: nowhere.urdf}]\n", "bodies[0].urdf", "nowhere.urdf"},
        BadCase{"missing_name", "bodies: [{urdf: a.urdf}]\n", "bodies[0].name", "expected a text"},
        BadCase{"same_name", withBody("  - name: block\n    urdf: " + BLOCK + "\n"), "bodies[1].name", "twice"},
        BadCase{"bad_base", withBody("    base: flying\n"), "bodies[0].base", "floating"},
        BadCase{"two_commands", withBody("    commands: {hip: {effort: 1, position: 2}}\n"), "commands.hip",
                "exactly one"},
        BadCase{"bad_frame", withBody("    wrenches: [{link: a, frame: moon}]\n"), "wrenches[0].frame",
                "world or link"},
        BadCase{"unknown_material", withBody("    material: rubber\n"), "bodies[0].material", "materials"},
        BadCase{"unknown_policy", "failure: {policy: explode}\n" + withBody(""), "failure.policy",
                "stop, pause, hold or accept"},
        BadCase{"unknown_failure_key", "failure: {polcy: stop}\n" + withBody(""), "polcy", "unknown key"},
        BadCase{"fallback_is_no_name", "failure: {fallback: admm}\n" + withBody(""), "failure.fallback",
                "true or false"},
        BadCase{"negative_time_limit", "failure: {time_limit: -1}\n" + withBody(""), "failure.time_limit", ">= 0"},
        BadCase{"failure_is_no_word", "failure: stop\n" + withBody(""), "failure", "map"},
        BadCase{"unknown_option", "solver: {name: admm, options: {penlty: 2}}\n" + withBody(""),
                "solver.options.penlty", "did you mean 'penalty'?"},
        BadCase{"option_out_of_range", "solver:\n  name: admm\n  options:\n    penalty: -2\n" + withBody(""),
                "scene.yaml:4: key 'solver.options.penalty'", "found '-2', expected a number > 0"},
        BadCase{"options_against_each_other",
                "solver: {name: fb_bfgs, options: {curvature: 0.1, sufficient_decrease: 0.2}}\n" + withBody(""),
                "solver.options", "> sufficient_decrease"},
        BadCase{"near_key", "gravty: [0, 0, 0]\n" + withBody(""), "gravty", "did you mean 'gravity'?"},
        BadCase{"near_policy", "failure: {policy: hodl}\n" + withBody(""), "failure.policy", "did you mean 'hold'?"},
        BadCase{"twice", "duration: 1\nduration: 2\n" + withBody(""), "scene.yaml:2: key 'duration'", "found twice"},
        BadCase{"long_step", "time_step: 1001\n" + withBody(""), "time_step", "in [1e-09, 1000]"},
        BadCase{"self_collision", withBody("    self_collision: 1\n"), "bodies[0].self_collision", "true or false"},
        BadCase{"quasi_static", "quasi_static: perhaps\n" + withBody(""), "quasi_static", "true or false"}),
    [](const testing::TestParamInfo<BadCase>& info) { return info.param.name; });

TEST(ScenarioLoaderTest, MissingFileIsNamed)
{
  try
  {
    loadScenarioFile("/nowhere/scene.yaml");
    FAIL() << "accepted";
  }
  catch (const ScenarioError& error)
  {
    EXPECT_NE(std::string(error.what()).find("/nowhere/scene.yaml"), std::string::npos);
  }
}
}  // namespace
}  // namespace frictional_contact_sim
