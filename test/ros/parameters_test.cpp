#include "frictional_contact_sim/ros/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "frictional_contact_sim/solver/registry.h"

namespace frictional_contact_sim
{
namespace
{
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using XmlRpc::XmlRpcValue;

const char* const ROBOT = "<robot name=\"r\"/>";  // readParameters hands the document on without reading it

XmlRpcValue list(const std::vector<double>& numbers)
{
  XmlRpcValue value;
  value.setSize(static_cast<int>(numbers.size()));
  for (size_t i = 0; i < numbers.size(); ++i)
  {
    value[static_cast<int>(i)] = numbers[i];
  }
  return value;
}

XmlRpcValue names(const std::vector<std::string>& strings)
{
  XmlRpcValue value;
  value.setSize(static_cast<int>(strings.size()));
  for (size_t i = 0; i < strings.size(); ++i)
  {
    value[static_cast<int>(i)] = strings[i];
  }
  return value;
}

/** @brief The one line that a parameter gets, empty when it is taken. */
std::string complaint(const std::string& name, const XmlRpcValue& value)
{
  XmlRpcValue tree;
  tree[name] = value;
  try
  {
    readParameters(tree, ROBOT);
  }
  catch (const ParameterError& error)
  {
    return error.what();
  }
  return "";
}

TEST(ParametersTest, GravityCompensationGoesForTheBodiesOfAScenarioFileToo)
{
  XmlRpcValue tree;
  tree["scenario"] = std::string(PROJECT_DIR) + "/config/scenarios/grasp.yaml";
  EXPECT_FALSE(readParameters(tree, "").scenario.bodies.at(0).gravity_compensation);
  tree["gravity_compensation"] = true;
  const NodeParameters parameters = readParameters(tree, "");
  EXPECT_THAT(parameters.warnings, IsEmpty());
  for (const BodySpec& body : parameters.scenario.bodies)
    EXPECT_TRUE(body.gravity_compensation) << body.name;
}

TEST(ParametersTest, DefaultsAreThoseOfTheContract)
{
  const NodeParameters parameters = readParameters(XmlRpc::XmlRpcValue(), ROBOT);
  EXPECT_EQ(parameters.scenario.time_step, 0.001);
  EXPECT_EQ(parameters.scenario.gravity, Eigen::Vector3d(0.0, 0.0, -9.81));
  EXPECT_EQ(parameters.scenario.stopping.tolerance, 1e-8);
  EXPECT_TRUE(parameters.scenario.ground.has_value());
  EXPECT_EQ(parameters.scenario.materials.fallback.friction, 0.8);
  EXPECT_EQ(parameters.scenario.materials.fallback.restitution, 0.0);
  EXPECT_EQ(parameters.real_time_factor, 1.0);
  EXPECT_FALSE(parameters.start_paused);
  EXPECT_EQ(parameters.num_steps, 0);
  EXPECT_EQ(parameters.scenario.failure.policy, FailurePolicy::STOP);
  ASSERT_EQ(parameters.scenario.bodies.size(), 1u);
  EXPECT_EQ(parameters.scenario.bodies[0].urdf_xml, ROBOT);
  EXPECT_FALSE(parameters.scenario.bodies[0].pose.has_value());
  EXPECT_THAT(parameters.warnings, IsEmpty());
}

TEST(ParametersTest, FailureParametersOverrideTheScenarioKeyByKey)
{
  EXPECT_TRUE(readParameters(XmlRpc::XmlRpcValue(), ROBOT).scenario.failure.fallback);
  EXPECT_EQ(readParameters(XmlRpc::XmlRpcValue(), ROBOT).scenario.failure.time_limit, 0.0);
  const std::string file = testing::TempDir() + "/failure_parameters.yaml";
  std::ofstream(file) << "failure: {policy: hold, fallback: false, time_limit: 0.5}\nbodies: [{name: block, urdf: "
                      << PROJECT_DIR << "/urdf/block.urdf}]\n";
  XmlRpcValue tree;
  tree["scenario"] = file;
  FailureOptions failure = readParameters(tree, "").scenario.failure;
  EXPECT_EQ(failure.policy, FailurePolicy::HOLD);
  EXPECT_FALSE(failure.fallback);
  EXPECT_EQ(failure.time_limit, 0.5);
  tree["on_failure"] = "pause";
  tree["step_time_limit"] = 2;
  failure = readParameters(tree, "").scenario.failure;
  EXPECT_EQ(failure.policy, FailurePolicy::PAUSE);
  EXPECT_FALSE(failure.fallback);
  EXPECT_EQ(failure.time_limit, 2.0);
}

TEST(ParametersTest, EveryRegisteredSolverIsTaken)
{
  for (const SolverEntry& entry : solverRegistry())
  {
    EXPECT_EQ(complaint("solver", XmlRpcValue(entry.name)), "");
  }
}

TEST(ParametersTest, ValuesReachTheScenario)
{
  XmlRpcValue tree;
  tree["gravity"] = list({1.0, 2.0, 3.0});
  tree["base"] = "fixed";
  tree["base_pose"]["xyz"] = list({0.1, 0.2, 0.3});
  tree["base_pose"]["rpy"] = list({0.0, 0.0, 1.5707963267948966});
  tree["initial_joint_positions"]["knee"] = 0.5;
  tree["min_joint_inertia"] = 2e-6;
  tree["disable_collisions"].setSize(1);
  tree["disable_collisions"][0] = names({"thigh", "shank"});
  tree["ground"]["height"] = -1.0;
  tree["materials"]["pairs"].setSize(1);
  tree["materials"]["pairs"][0]["between"] = names({"rubber", "ground"});
  tree["materials"]["pairs"][0]["friction"] = 1;  // an integer is a number
  const Scenario scenario = readParameters(tree, ROBOT).scenario;
  const BodySpec& body = scenario.bodies.at(0);
  EXPECT_EQ(scenario.gravity, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(body.base, BaseType::FIXED);
  EXPECT_EQ(body.pose->translation(), Eigen::Vector3d(0.1, 0.2, 0.3));
  // A quarter turn about z takes x to y; round-off of the cosine of pi/2.
  EXPECT_LT((body.pose->linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_EQ(body.joints.at("knee").position, 0.5);
  EXPECT_EQ(body.min_joint_inertia, 2e-6);
  EXPECT_FALSE(readParameters(XmlRpc::XmlRpcValue(), ROBOT).scenario.bodies.at(0).min_joint_inertia);
  EXPECT_THAT(body.disable_collisions, ElementsAre(std::make_pair("thigh", "shank")));
  EXPECT_EQ(scenario.ground->height, -1.0);
  EXPECT_EQ(scenario.materials.pairs.at({"ground", "rubber"}).friction, 1.0);  // alphabetical order
}

TEST(ParametersTest, MaterialsTakeWhatTheyDoNotSayFromTheDefaultWhateverTheirNames)
{
  XmlRpcValue tree;
  tree["default_friction"] = 0.1;
  tree["materials"]["default"]["friction"] = 0.3;
  tree["materials"]["asphalt"]["restitution"] = 0.5;  // before and after "default" in the alphabet
  tree["materials"]["rubber"]["restitution"] = 0.6;
  tree["materials"]["pairs"].setSize(1);
  tree["materials"]["pairs"][0]["between"] = names({"asphalt", "rubber"});
  const MaterialTable table = readParameters(tree, ROBOT).scenario.materials;
  EXPECT_EQ(table.fallback.friction, 0.3);
  EXPECT_EQ(table.find("asphalt").friction, 0.3);
  EXPECT_EQ(table.find("rubber").friction, 0.3);
  EXPECT_EQ(table.find("asphalt").restitution, 0.5);
  EXPECT_EQ(table.pairs.at({"asphalt", "rubber"}).friction, 0.3);
}

TEST(ParametersTest, AnUnknownKeyOfAMaterialIsRefusedAsInAScenarioFile)
{
  XmlRpcValue materials;
  materials["rubber"]["frction"] = 0.9;
  EXPECT_THAT(complaint("materials", materials),
              testing::AllOf(HasSubstr("~materials/rubber/frction"), HasSubstr("did you mean 'friction'?")));
  XmlRpcValue creep;
  creep["pairs"].setSize(1);
  creep["pairs"][0]["between"] = names({"wheel", "rail"});
  creep["pairs"][0]["law"] = "creep";
  EXPECT_THAT(complaint("materials", creep), HasSubstr("~materials/pairs/0: law creep: found no curve"));
}

TEST(ParametersTest, ALineNamesParameterAndWhatWasFoundAndExpected)
{
  EXPECT_THAT(complaint("time_step", XmlRpcValue("fast")),
              testing::AllOf(HasSubstr("~time_step"), HasSubstr("'fast'"), HasSubstr("a number in [1e-09, 1000]")));
  EXPECT_THAT(complaint("time_step", XmlRpcValue(0.0)), HasSubstr("the number 0"));
  EXPECT_THAT(complaint("default_friction", XmlRpcValue(-0.5)),
              testing::AllOf(HasSubstr("~default_friction"), HasSubstr("-0.5"), HasSubstr(">= 0")));
  EXPECT_THAT(complaint("default_restitution", XmlRpcValue(1.5)), HasSubstr("[0, 1]"));
  EXPECT_THAT(complaint("ground", XmlRpcValue(1)), HasSubstr("~ground"));
  EXPECT_THAT(complaint("base", XmlRpcValue("flying")), HasSubstr("auto, floating or fixed"));
  EXPECT_THAT(complaint("gravity", list({0.0, -9.81})), HasSubstr("a list of 3"));
  EXPECT_THAT(complaint("base_pose", list({0.0, 0.0})), HasSubstr("a list of 6"));
  EXPECT_THAT(complaint("num_steps", XmlRpcValue(2.5)), HasSubstr("integer"));
  EXPECT_THAT(complaint("start_paused", XmlRpcValue(1)), HasSubstr("true or false"));
  EXPECT_THAT(complaint("disable_collisions", names({"a", "b"})),
              HasSubstr("~disable_collisions/0: found the string 'a', expected a pair of names"));
  EXPECT_THAT(complaint("on_failure", XmlRpcValue("explode")), HasSubstr("stop, pause, hold or accept"));
  EXPECT_THAT(complaint("fallback", XmlRpcValue(1)), HasSubstr("true or false"));
  EXPECT_THAT(complaint("step_time_limit", XmlRpcValue(-1.0)), HasSubstr(">= 0"));
  EXPECT_THAT(complaint("max_iterations", XmlRpcValue(-1)), HasSubstr(">= 0"));
  EXPECT_THAT(complaint("bag", XmlRpcValue("/nowhere/run.bag")), HasSubstr("/nowhere"));
}

TEST(ParametersTest, NumbersThatAreNotFiniteAreRefused)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const char* name : {"time_step", "tolerance", "default_friction", "real_time_factor", "publish_rate"})
  {
    EXPECT_THAT(complaint(name, XmlRpcValue(nan)), HasSubstr(name));
    EXPECT_THAT(complaint(name, XmlRpcValue(infinity)), HasSubstr(name));
  }
  EXPECT_THAT(complaint("gravity", list({0.0, 0.0, nan})), HasSubstr("~gravity/2: found the number nan"));
}

TEST(ParametersTest, AnUnknownSolverListsTheValidOnes)
{
  const std::string line = complaint("solver", XmlRpcValue("oracle"));
  EXPECT_THAT(line, HasSubstr("oracle"));
  for (const SolverEntry& entry : solverRegistry())
  {
    EXPECT_THAT(line, HasSubstr(entry.name));
  }
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

TEST(ParametersTest, UnknownParametersAreNamedAtEveryLevel)
{
  XmlRpcValue tree;
  tree["tolerence"] = 1e-8;
  tree["ground"]["hight"] = 1.0;
  tree["servo_gains"]["knee"]["ki"] = 1.0;
  const NodeParameters parameters = readParameters(tree, ROBOT);
  EXPECT_THAT(parameters.warnings, testing::UnorderedElementsAre(HasSubstr("~tolerence"), HasSubstr("~ground/hight"),
                                                                 HasSubstr("~servo_gains/knee/ki")));
}

TEST(ParametersTest, KeysOfAScenarioWorkAsParameters)
{
  XmlRpcValue tree;
  tree["solver"]["name"] = "cadoux_fixed_point";
  tree["solver"]["options"]["inner"] = "admm";
  tree["solver_options"]["relaxation"] = 0.5;
  tree["solver_options"]["cycle_window"] = 7;
  tree["contact_law"] = "velocity";
  tree["failure"]["policy"] = "hold";
  tree["self_collision"] = false;
  tree["materials"]["ice"]["friction"] = 0.1;
  tree["link_materials"]["foot"] = "ice";
  tree["commands"]["knee"]["times"] = list({0.0, 1.0});
  tree["commands"]["knee"]["positions"] = list({0.0, 0.5});
  const NodeParameters parameters = readParameters(tree, ROBOT);
  EXPECT_THAT(parameters.warnings, IsEmpty());
  const Scenario& scenario = parameters.scenario;
  EXPECT_EQ(scenario.solver, "cadoux_fixed_point");
  EXPECT_EQ(scenario.solver_options, (SolverOptions{{"cycle_window", "7"}, {"inner", "admm"}, {"relaxation", "0.5"}}));
  EXPECT_EQ(scenario.contact_law, ContactLawForm::VELOCITY);
  EXPECT_EQ(scenario.failure.policy, FailurePolicy::HOLD);
  EXPECT_FALSE(scenario.bodies.at(0).self_collision);
  EXPECT_EQ(scenario.bodies.at(0).link_materials.at("foot"), "ice");
  EXPECT_EQ(scenario.bodies.at(0).schedules.at("knee").targets, (std::vector<double>{0.0, 0.5}));
}

TEST(ParametersTest, OptionsOfTheMethodAreNamedByTheirParameter)
{
  XmlRpcValue options;
  options["newton_frst_rows"] = 3;
  EXPECT_THAT(complaint("solver_options", options),
              testing::AllOf(HasSubstr("~solver_options/newton_frst_rows: portfolio has no option"),
                             HasSubstr("did you mean 'newton_first_rows'?")));
  XmlRpcValue negative;
  negative["newton_first_rows"] = -3;
  EXPECT_THAT(complaint("solver_options", negative), HasSubstr("expected an integer >= 0"));
  XmlRpcValue against;
  against["newton_last_rows"] = 3;
  EXPECT_THAT(complaint("solver_options", against), HasSubstr("~solver_options: portfolio.newton_last_rows is 3"));
  EXPECT_THAT(complaint("solver_options", XmlRpcValue("fast")), HasSubstr("expected a map"));
}

/** @brief Random trees of parameters: taken with warnings, or one line that names a parameter. */
TEST(ParametersTest, RandomParametersAreTakenOrRefusedInOneLine)
{
  std::mt19937 dice(31);
  const std::vector<std::string> keys = {"solver",  "materials", "ground", "gravity",   "time_step", "solver_options",
                                         "base",    "commands",  "joints", "wrenches",  "failure",   "pairs",
                                         "default", "friction",  "name",   "base_pose", "nonsense",  "servo_gains"};
  const std::function<XmlRpcValue(int)> draw = [&](int depth) -> XmlRpcValue
  {
    switch (dice() % (depth > 3 ? 5 : 8))
    {
      case 0:
        return XmlRpcValue(static_cast<int>(dice() % 5) - 1);
      case 1:
        return XmlRpcValue(0.1 * static_cast<double>(dice() % 40) - 1.0);
      case 2:
        return XmlRpcValue(dice() % 2 == 0);
      case 3:
        return XmlRpcValue(keys[dice() % keys.size()]);
      case 4:
        return XmlRpcValue(std::numeric_limits<double>::quiet_NaN());
      case 5:
      {
        XmlRpcValue items;
        items.setSize(static_cast<int>(dice() % 4));
        for (int i = 0; i < items.size(); ++i)
          items[i] = draw(depth + 1);
        return items;
      }
      default:
      {
        XmlRpcValue map;
        map[keys[dice() % keys.size()]] = draw(depth + 1);
        map[keys[dice() % keys.size()]] = draw(depth + 1);
        return map;
      }
    }
  };
  int refused = 0;
  for (int k = 0; k < 3000; ++k)
  {
    std::string message;
    ASSERT_NO_THROW(message = complaint(keys[dice() % keys.size()], draw(0))) << k;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_TRUE(message.empty() || message[0] == '~') << message;
    refused += !message.empty();
  }
  EXPECT_GT(refused, 1000);
}

TEST(ParametersTest, ARobotOrAScenarioIsNeeded)
{
  EXPECT_THROW(readParameters(XmlRpcValue(), ""), ParameterError);
}

TEST(ParametersTest, ASetNumberOverridesTheScenarioFile)
{
  const std::string path = testing::TempDir() + "parameters_test.yaml";
  std::ofstream(path) << "time_step: 0.002\ngravity: [0, 0, -1]\nbodies:\n  - {name: box, urdf: " << PROJECT_DIR
                      << "/test/ros/box_10kg.urdf, base: floating}\n";
  XmlRpcValue tree;
  tree["scenario"] = path;
  tree["time_step"] = 0.004;
  tree["base"] = "fixed";
  const NodeParameters parameters = readParameters(tree, "");
  EXPECT_EQ(parameters.scenario.time_step, 0.004);
  EXPECT_EQ(parameters.scenario.gravity.z(), -1.0);
  EXPECT_EQ(parameters.scenario.bodies.at(0).base, BaseType::FLOATING);
  EXPECT_THAT(parameters.warnings, ElementsAre(HasSubstr("~base: ignored")));
}

}  // namespace
}  // namespace frictional_contact_sim
