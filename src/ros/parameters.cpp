#include "frictional_contact_sim/ros/parameters.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/ros/parameter_tree.h"
#include "frictional_contact_sim/simulation/scenario_files.h"
#include "frictional_contact_sim/simulation/scenario_keys.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"

namespace frictional_contact_sim
{
namespace
{
void readPositions(const ConfigNode& node, BodySpec& body)
{
  for (const auto& [joint, position] : node.entries())
    body.joints[joint].position = position.number();
}

/** @brief What a scenario file would say of the robot of robot_description. */
ConfigKeys robotKeys(BodySpec& body)
{
  return bodyKeys(body) +
         ConfigKeys{poseKey("base_pose", body), linkMaterialsKey("link_materials", body),
                    key(
                        "initial_joint_positions", [&body](const ConfigNode& node) { readPositions(node, body); })};
}

/** @brief And of what it meets. */
ConfigKeys worldKeys(Scenario& scenario)
{
  return ConfigKeys{frictionKey("default_friction", scenario.materials.fallback.friction),
                    restitutionKey("default_restitution", scenario.materials.fallback.restitution)} +
         surroundingKeys(scenario);
}

/** @brief Short names beside the scenario's own ones, which they override. */
ConfigKeys shortKeys(Scenario& scenario)
{
  return {
      solverOptionsKey("solver_options", scenario), toleranceKey(scenario.stopping),
      maxIterationsKey(scenario.stopping),          failurePolicyKey("on_failure", scenario.failure),
      key("fallback", scenario.failure.fallback),   key("step_time_limit", scenario.failure.time_limit, notNegative())};
}

void readServoGains(const ConfigNode& node, std::map<std::string, ServoGains>& servo_gains)
{
  for (const auto& [joint, gains] : node.entries())
  {
    ServoGains& target = servo_gains[joint];
    gains.readMap({key("kp", target.kp, notNegative()), key("kd", target.kd, notNegative()),
                   key("velocity_gain", target.velocity_gain, notNegative()),
                   key("max_effort", target.max_effort, notNegative())});
  }
}

/** @brief By making a file there: permissions alone say nothing to root or about a read-only file system. */
void requireWritable(const ConfigNode& node, const std::string& folder)
{
  std::string file = folder + "/.writable_XXXXXX";
  const int descriptor = mkstemp(&file[0]);
  if (descriptor < 0)
    node.fail("cannot write in the folder '" + folder + "': " + std::strerror(errno));
  close(descriptor);
  unlink(file.c_str());
}

ConfigKeys fileKeys(NodeParameters& parameters)
{
  const auto read_dump_folder = [&parameters](const ConfigNode& node)
  {
    parameters.dump_dir = node.anyText();
    if (!parameters.dump_dir.empty())
      requireWritable(node, parameters.dump_dir);
  };
  const auto read_bag = [&parameters](const ConfigNode& node)
  {
    parameters.bag = node.anyText();
    const size_t slash = parameters.bag.rfind('/');
    if (!parameters.bag.empty())
      requireWritable(node, slash == std::string::npos ? "." : parameters.bag.substr(0, slash + 1));
  };
  return {key("dump_dir", read_dump_folder), key("max_dumps", parameters.max_dumps, 1), key("bag", read_bag)};
}

ConfigKeys nodeKeys(NodeParameters& parameters)
{
  return {key("real_time_factor", parameters.real_time_factor, notNegative()),
          key("publish_rate", parameters.publish_rate, notNegative()),
          key("clock_rate", parameters.clock_rate, notNegative()),
          key("tf_rate", parameters.tf_rate, notNegative()),
          key("marker_rate", parameters.marker_rate, notNegative()),
          key("force_scale", parameters.force_scale, notNegative()),
          key(
              "servo_gains", [&](const ConfigNode& node) { readServoGains(node, parameters.servo_gains); }),
          key("start_paused", parameters.start_paused),
          key(
              "wait_for_subscribers", [&](const ConfigNode& node) { parameters.wait_for_subscribers = node.texts(); }),
          key(
              "num_steps", [&](const ConfigNode& node) { parameters.num_steps = node.integer(0); }),
          key(
              "lossless_topics", [&](const ConfigNode& node) { parameters.lossless_topics = node.texts(); }),
          key("hold_limit", parameters.hold_limit, notNegative()),
          key("publish_base_tf", parameters.publish_base_tf),
          key("publish_link_tf", parameters.publish_link_tf),
          key("link_topics", parameters.link_topics),
          key("publish_clock", parameters.publish_clock),
          key("seed", parameters.seed, 0)};
}

/** @brief Parameters that mean nothing beside what says it already: named in a warning. */
ConfigKeys unusedKeys(const ConfigKeys& keys, const std::string& who, NodeParameters& parameters)
{
  ConfigKeys unused;
  for (const ConfigKey& one : keys)
    if (one.name != "hold_initial_position" && one.name != "gravity_compensation")  // go for all bodies
      unused.push_back(key(one.name, [&parameters, who, name = one.name](const ConfigNode&)
                           { parameters.warnings.push_back("~" + name + ": ignored, " + who + " says it"); }));
  return unused;
}

/** @brief ~robots: bodies beside those of the scenario file, with its keys of a body. */
void readRobots(const ConfigNode& robots, const FindDescription& find, NodeParameters& parameters)
{
  Scenario& scenario = parameters.scenario;
  for (const auto& [name, robot] : robots.entries())
  {
    if (!isTopicPart(name))
      robot.fail("the name of a robot is a part of topics: expected a letter, then letters, digits and _");
    for (const BodySpec& other : scenario.bodies)
      if (other.name == name)
        robot.fail("the scenario has a body of that name already");
    BodySpec body;
    body.name = name;
    const auto read_description = [&body, &find](const ConfigNode& node)
    {
      try
      {
        body.urdf_xml = findDocument(node.anyText(), find);
      }
      catch (const ParameterError& error)
      {
        node.fail(error.what());
      }
    };
    robot.readMap(bodyKeys(body) +
                  ConfigKeys{required(key("description", read_description)), linkMaterialsKey("materials", body)});
    checkMaterials(robot, "materials", body, scenario.materials);
    scenario.bodies.push_back(body);
    parameters.robots.insert(name);
  }
}
/** @brief What makes servos of all bodies, whatever the scenario file says of each. */
ConfigKeys servoKeys(BodySpec& all)
{
  return {key("hold_initial_position", all.hold_initial_position),
          key("gravity_compensation", all.gravity_compensation)};
}

/** @brief All that are not the robot's. */
ConfigKeys otherKeys(NodeParameters& parameters)
{
  const auto known = [](const ConfigNode&) {};
  return numericKeys(parameters.scenario) + shortKeys(parameters.scenario) + fileKeys(parameters) +
         nodeKeys(parameters) +
         ConfigKeys{key("scenario", known), key("robot_description", known), key("robots", known)};
}
}  // namespace

std::vector<std::string> parameterNames()
{
  NodeParameters parameters;
  BodySpec robot;
  std::vector<std::string> names;
  for (const ConfigKey& one : robotKeys(robot) + worldKeys(parameters.scenario) + otherKeys(parameters))
    names.push_back(one.name);
  return names;
}

std::string findDocument(const std::string& text, const FindDescription& find)
{
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '<')
    return text;
  const std::string document = text.empty() || !find ? "" : find(text);
  if (document.empty())
    throw ParameterError("found '" + inOneLine(text, 80) +
                         "', expected a URDF document or the name of a parameter that holds one");
  return document;
}

NodeParameters readParameters(const XmlRpc::XmlRpcValue& tree, const std::string& robot_description,
                              const FindDescription& find_description)
{
  NodeParameters parameters;
  Scenario& scenario = parameters.scenario;
  const ConfigNode root = parameterTree(tree, &parameters.warnings);
  const std::string file = root.has("scenario") ? root.at("scenario").anyText() : "";
  BodySpec robot;
  BodySpec all;
  ConfigKeys keys;
  if (!file.empty())
  {
    scenario = loadScenarioFile(findScenario(file));
    keys = unusedKeys(robotKeys(robot) + worldKeys(scenario), "the scenario file", parameters) + servoKeys(all);
  }
  else if (root.has("robots"))
  {
    scenario.name = "robots";
    scenario.ground = GroundSpec();
    keys = worldKeys(scenario) + unusedKeys(robotKeys(robot), "~robots", parameters) + servoKeys(all);
  }
  else if (!robot_description.empty())
  {
    scenario.name = "robot_description";
    scenario.ground = GroundSpec();
    robot.name = "robot";
    robot.urdf_xml = robot_description;
    keys = robotKeys(robot) + worldKeys(scenario);
  }
  else
  {
    throw ParameterError(
        "robot_description: not set, and no ~scenario or ~robots either: expected a URDF document or a file");
  }
  root.readMap(keys + otherKeys(parameters));
  checkSolver(root.at("solver_options"), scenario);
  if (file.empty() && !root.has("robots"))
  {
    checkMaterials(root, "link_materials", robot, scenario.materials);
    scenario.bodies.push_back(robot);
  }
  if (root.has("robots"))
    readRobots(root.at("robots"), find_description, parameters);
  for (BodySpec& body : scenario.bodies)
  {
    body.hold_initial_position = body.hold_initial_position || all.hold_initial_position;
    body.gravity_compensation = body.gravity_compensation || all.gravity_compensation;
  }
  return parameters;
}

}  // namespace frictional_contact_sim
