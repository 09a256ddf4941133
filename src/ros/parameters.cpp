#include "frictional_contact_sim/ros/parameters.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "frictional_contact_sim/ros/parameter_reader.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/solver/registry.h"

namespace frictional_contact_sim
{
namespace
{
Eigen::Isometry3d toPose(const std::vector<double>& xyz, const std::vector<double>& rpy)
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
  pose.linear() =
      (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return pose;
}

void append(std::vector<std::string>& warnings, const ParameterReader& reader)
{
  for (const std::string& name : reader.unknown())
    warnings.push_back(name + ": unknown parameter, ignored");
}

/** @brief An unknown key of a material is refused, as in a scenario file: a misspelt friction is another simulation. */
Material readMaterial(ParameterReader& reader, const Material& fallback)
{
  Material material = fallback;
  reader.read("friction", material.friction, notNegative());
  reader.read("restitution", material.restitution, between(0.0, 1.0));
  for (const std::string& name : reader.unknown())
    throw ParameterError(name + ": unknown key, expected friction or restitution");
  return material;
}

/**
 * @brief The same layout as `materials` of a scenario file: default, pairs, and single materials by name. The default
 * is read first: the others take from it what they do not say.
 */
void readMaterials(ParameterReader& reader, MaterialTable& table)
{
  reader.read("default_friction", table.fallback.friction, notNegative());
  reader.read("default_restitution", table.fallback.restitution, between(0.0, 1.0));
  ParameterReader materials = reader.child("materials");
  ParameterReader fallback = materials.child("default");
  table.fallback = readMaterial(fallback, table.fallback);
  for (const std::string& name : materials.names())
  {
    if (name != "default" && name != "pairs")
    {
      ParameterReader one = materials.child(name);
      table.materials[name] = readMaterial(one, table.fallback);
    }
  }
  XmlRpc::XmlRpcValue pairs = materials.raw("pairs");
  if (!materials.has("pairs"))
    return;
  const std::string expected = "a list of {between: [a, b], friction: mu, restitution: e}";
  if (pairs.getType() != XmlRpc::XmlRpcValue::TypeArray)
    materials.fail("pairs", expected);
  for (int i = 0; i < pairs.size(); ++i)
  {
    ParameterReader pair(pairs[i], "~materials/pairs/" + std::to_string(i) + "/");
    std::vector<std::string> names;
    pair.read("between", names);
    if (names.size() != 2)
      materials.fail("pairs", expected);
    std::sort(names.begin(), names.end());
    table.pairs[{names[0], names[1]}] = readMaterial(pair, table.fallback);
  }
}

void readGround(ParameterReader& reader, NodeParameters& parameters)
{
  if (reader.isStruct("ground"))
  {
    ParameterReader ground = reader.child("ground");
    GroundSpec spec;
    ground.read("height", spec.height, anyNumber());
    double friction = 0.0;
    ground.read("friction", friction, notNegative());
    if (ground.has("friction"))
      spec.friction = friction;
    append(parameters.warnings, ground);
    parameters.scenario.ground = spec;
    return;
  }
  bool has_ground = true;
  if (reader.has("ground") && reader.raw("ground").getType() != XmlRpc::XmlRpcValue::TypeBoolean)
    reader.fail("ground", "true, false or {height: z, friction: mu}");
  reader.read("ground", has_ground);
  if (has_ground)
    parameters.scenario.ground = GroundSpec();
}

void readBasePose(ParameterReader& reader, BodySpec& body, std::vector<std::string>& warnings)
{
  if (!reader.has("base_pose"))
    return;
  std::vector<double> xyz(3, 0.0);
  std::vector<double> rpy(3, 0.0);
  if (reader.isStruct("base_pose"))
  {
    ParameterReader pose = reader.child("base_pose");
    pose.read("xyz", xyz, 3);
    pose.read("rpy", rpy, 3);
    append(warnings, pose);
  }
  else
  {
    std::vector<double> six;
    reader.raw("base_pose");
    if (!reader.isList("base_pose"))
      reader.fail("base_pose", "[x, y, z, roll, pitch, yaw] or {xyz: [x, y, z], rpy: [roll, pitch, yaw]}");
    reader.read("base_pose", six, 6);
    xyz.assign(six.begin(), six.begin() + 3);
    rpy.assign(six.begin() + 3, six.end());
  }
  body.pose = toPose(xyz, rpy);
}

/** @brief The robot of robot_description, with the parameters that a scenario file would have for it. */
void readRobot(ParameterReader& reader, const std::string& robot_description, NodeParameters& parameters)
{
  BodySpec body;
  body.name = "robot";
  body.urdf_xml = robot_description;
  std::string base = "auto";
  reader.read("base", base);
  try
  {
    body.base = parseBaseType(base);
  }
  catch (const std::invalid_argument&)
  {
    reader.fail("base", "auto, floating or fixed");
  }
  readBasePose(reader, body, parameters.warnings);
  ParameterReader positions = reader.child("initial_joint_positions");
  for (const std::string& joint : positions.names())
    positions.read(joint, body.joints[joint].position, anyNumber());
  reader.read("disable_collisions", body.disable_collisions);
  double min_joint_inertia = DEFAULT_JOINT_INERTIA;
  reader.read("min_joint_inertia", min_joint_inertia, positive());
  if (reader.has("min_joint_inertia"))
    body.min_joint_inertia = min_joint_inertia;
  readGround(reader, parameters);
  readMaterials(reader, parameters.scenario.materials);
  parameters.scenario.name = "robot_description";
  parameters.scenario.bodies.push_back(body);
}

/** @brief What overrides a scenario file when it is set. */
void readNumerics(ParameterReader& reader, Scenario& scenario)
{
  reader.read("time_step", scenario.time_step, between(1e-9, 1e3));  // stamps are whole nanoseconds, never zero
  std::vector<double> gravity(scenario.gravity.data(), scenario.gravity.data() + 3);
  reader.read("gravity", gravity, 3);
  scenario.gravity = Eigen::Vector3d(gravity[0], gravity[1], gravity[2]);
  reader.read("solver", scenario.solver);
  try
  {
    createSolver(scenario.solver);
  }
  catch (const std::invalid_argument& error)
  {
    throw ParameterError("~solver: " + std::string(error.what()));
  }
  reader.read("tolerance", scenario.stopping.tolerance, positive());
  reader.read("max_iterations", scenario.stopping.max_iterations, 1);
}

/** @brief Overrides the scenario's `failure`, key by key. */
void readFailure(ParameterReader& reader, FailureOptions& failure)
{
  std::string name = toString(failure.policy);
  reader.read("on_failure", name);
  try
  {
    failure.policy = parseFailurePolicy(name);
  }
  catch (const std::invalid_argument&)
  {
    reader.fail("on_failure", "stop, pause, hold or accept");
  }
  reader.read("fallback", failure.fallback);
  reader.read("step_time_limit", failure.time_limit, notNegative());
}

void readServoGains(ParameterReader& reader, NodeParameters& parameters)
{
  ParameterReader gains = reader.child("servo_gains");
  for (const std::string& name : gains.names())
  {
    ParameterReader one = gains.child(name);
    ServoGains& target = parameters.servo_gains[name];
    one.read("kp", target.kp, notNegative());
    one.read("kd", target.kd, notNegative());
    one.read("max_effort", target.max_effort, notNegative());
    append(parameters.warnings, one);
  }
}

/** @brief By making a file there: permissions alone say nothing to root or about a read-only file system. */
void requireWritable(const std::string& parameter, const std::string& folder)
{
  std::string file = folder + "/.writable_XXXXXX";
  const int descriptor = mkstemp(&file[0]);
  if (descriptor < 0)
    throw ParameterError(parameter + ": cannot write in the folder '" + folder + "': " + std::strerror(errno));
  close(descriptor);
  unlink(file.c_str());
}

void readFiles(ParameterReader& reader, NodeParameters& parameters)
{
  reader.read("dump_dir", parameters.dump_dir);
  if (!parameters.dump_dir.empty())
    requireWritable("~dump_dir", parameters.dump_dir);
  reader.read("max_dumps", parameters.max_dumps, 1);
  reader.read("bag", parameters.bag);
  if (!parameters.bag.empty())
  {
    const size_t slash = parameters.bag.rfind('/');
    requireWritable("~bag", slash == std::string::npos ? "." : parameters.bag.substr(0, slash + 1));
  }
}

void readRates(ParameterReader& reader, NodeParameters& parameters)
{
  reader.read("real_time_factor", parameters.real_time_factor, notNegative());
  reader.read("publish_rate", parameters.publish_rate, notNegative());
  reader.read("clock_rate", parameters.clock_rate, notNegative());
  reader.read("tf_rate", parameters.tf_rate, notNegative());
  reader.read("marker_rate", parameters.marker_rate, notNegative());
  reader.read("force_scale", parameters.force_scale, notNegative());
}

/** @brief Parameters of the robot of robot_description mean nothing beside a scenario file: say so by name. */
void warnAboutUnused(ParameterReader& reader, NodeParameters& parameters)
{
  for (const char* name : {"base", "base_pose", "initial_joint_positions", "disable_collisions", "min_joint_inertia",
                           "ground", "materials", "default_friction", "default_restitution"})
  {
    reader.raw(name);
    if (reader.has(name))
      parameters.warnings.push_back("~" + std::string(name) + ": ignored, the scenario file says it");
  }
}

}  // namespace

NodeParameters readParameters(const XmlRpc::XmlRpcValue& tree, const std::string& robot_description)
{
  ParameterReader reader(tree, "~");
  NodeParameters parameters;
  std::string scenario_file;
  reader.read("scenario", scenario_file);
  reader.raw("robot_description");
  if (!scenario_file.empty())
  {
    parameters.scenario = loadScenarioFile(scenario_file);
    warnAboutUnused(reader, parameters);
  }
  else if (!robot_description.empty())
  {
    readRobot(reader, robot_description, parameters);
  }
  else
  {
    throw ParameterError("robot_description: not set, and no ~scenario either: expected a URDF document or a file");
  }
  readNumerics(reader, parameters.scenario);
  bool hold = false;
  reader.read("hold_initial_position", hold);
  for (BodySpec& body : parameters.scenario.bodies)
    body.hold_initial_position = body.hold_initial_position || hold;
  readRates(reader, parameters);
  readFailure(reader, parameters.scenario.failure);
  readServoGains(reader, parameters);
  readFiles(reader, parameters);
  reader.read("start_paused", parameters.start_paused);
  reader.read("wait_for_subscribers", parameters.wait_for_subscribers);
  reader.read("lossless_topics", parameters.lossless_topics);
  reader.read("hold_limit", parameters.hold_limit, notNegative());
  reader.read("publish_clock", parameters.publish_clock);
  int num_steps = 0;
  reader.read("num_steps", num_steps, 0);
  parameters.num_steps = num_steps;
  reader.read("publish_base_tf", parameters.publish_base_tf);
  reader.read("seed", parameters.seed, 0);
  append(parameters.warnings, reader);
  return parameters;
}

}  // namespace frictional_contact_sim
