#include "frictional_contact_sim/simulation/scenario_loader.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "creep_curve_reader.h"
#include "frictional_contact_sim/solver/registry.h"
#include "yaml_reader.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = std::numeric_limits<double>::infinity();

void readFinite(const YamlReader& map, const char* key, double& value)
{
  if (map.has(key))
    value = map.child(key).number();
}

void readNonNegative(const YamlReader& map, const char* key, double& value)
{
  if (map.has(key))
    value = map.child(key).number(0.0, INFINITE, "a number >= 0");
}

void readVector(const YamlReader& map, const char* key, Eigen::Vector3d& value)
{
  if (map.has(key))
    value = map.child(key).vector3();
}

void readSolver(const YamlReader& solver, Scenario& scenario)
{
  solver.expectMap({"name", "tolerance", "max_iterations"});
  if (solver.has("name"))
  {
    scenario.solver = solver.child("name").text();
    try
    {
      createSolver(scenario.solver);
    }
    catch (const std::invalid_argument& error)
    {
      solver.child("name").fail(error.what());
    }
  }
  if (solver.has("tolerance"))
  {
    const YamlReader tolerance = solver.child("tolerance");
    scenario.stopping.tolerance = tolerance.number();
    if (!(scenario.stopping.tolerance > 0.0))
      tolerance.fail("found '" + tolerance.text() + "', expected a number > 0");
  }
  if (solver.has("max_iterations"))
    scenario.stopping.max_iterations = solver.child("max_iterations").integer(0);
}

Material readMaterial(const YamlReader& map, const Material& fallback)
{
  Material material = fallback;
  readNonNegative(map, "friction", material.friction);
  if (map.has("restitution"))
    material.restitution = map.child("restitution").number(0.0, 1.0, "a number from 0 to 1");
  return material;
}

std::string resolveRelative(const YamlReader& path)
{
  const std::filesystem::path folder = std::filesystem::absolute(path.file()).parent_path();
  try
  {
    return resolvePath(path.text(), folder.string());
  }
  catch (const ModelError& error)
  {
    path.fail(error.what());
  }
}

/** law: creep takes its friction from the curve, whose shape depends on it. */
void readPairLaw(const YamlReader& pair, Material& material)
{
  const std::string law = pair.has("law") ? pair.child("law").text() : "coulomb";
  if (law != "coulomb" && law != "creep")
    pair.child("law").fail("found '" + law + "', expected coulomb or creep");
  if (law == "coulomb")
  {
    if (pair.has("curve"))
      pair.child("curve").fail("found '" + pair.child("curve").text() + "', expected none without law: creep");
    return;
  }
  if (!pair.has("curve"))
    pair.fail("law creep: found no curve, expected curve: FILE");
  material.creep = readCreepCurve(resolveRelative(pair.child("curve")));
  if (pair.has("friction") && material.friction != material.creep->friction)
    pair.child("friction")
        .fail("found '" + pair.child("friction").text() + "', expected the curve's friction " +
              std::to_string(material.creep->friction) + " or no entry");
  material.friction = material.creep->friction;
}

void readMaterials(const YamlReader& materials, MaterialTable& table)
{
  materials.expectMap();
  if (materials.has("default"))
  {
    materials.child("default").expectMap({"friction", "restitution"});
    table.fallback = readMaterial(materials.child("default"), table.fallback);
  }
  for (const auto& entry : materials.node())
  {
    const std::string name = entry.first.Scalar();
    if (name == "default" || name == "pairs")
      continue;
    materials.child(name).expectMap({"friction", "restitution"});
    table.materials[name] = readMaterial(materials.child(name), table.fallback);
  }
  if (!materials.has("pairs"))
    return;
  const YamlReader pairs = materials.child("pairs");
  pairs.expectSequence("pairs");
  for (size_t i = 0; i < pairs.node().size(); ++i)
  {
    const YamlReader pair = pairs.item(i);
    pair.expectMap({"between", "friction", "restitution", "law", "curve"});
    const YamlReader between = pair.child("between");
    if (!between.node().IsDefined() || !between.node().IsSequence() || between.node().size() != 2)
      pair.fail("expected between: [material, material]");
    Material material = readMaterial(pair, table.fallback);
    readPairLaw(pair, material);
    table.pairs[std::minmax(between.item(0).text(), between.item(1).text())] = material;
  }
}

Eigen::Isometry3d readPose(const YamlReader& pose)
{
  pose.expectMap({"xyz", "rpy"});
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();
  readVector(pose, "xyz", xyz);
  readVector(pose, "rpy", rpy);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = xyz;
  // URDF's convention: roll, pitch, yaw about fixed axes.
  result.linear() =
      (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return result;
}

JointCommand readCommand(const YamlReader& map)
{
  map.expectMap({"effort", "position", "velocity", "kp", "kd", "max_effort"});
  JointCommand command;
  const std::pair<const char*, JointCommand::Mode> modes[] = {{"effort", JointCommand::Mode::EFFORT},
                                                              {"position", JointCommand::Mode::POSITION},
                                                              {"velocity", JointCommand::Mode::VELOCITY}};
  int given = 0;
  for (const auto& [key, mode] : modes)
    if (map.has(key))
    {
      command.mode = mode;
      command.target = map.child(key).number();
      ++given;
    }
  if (given != 1)
    map.fail("expected exactly one of effort, position, velocity");
  readNonNegative(map, "kp", command.kp);
  readNonNegative(map, "kd", command.kd);
  readNonNegative(map, "max_effort", command.max_effort);
  return command;
}

ExternalWrench readWrench(const YamlReader& map)
{
  map.expectMap({"link", "force", "torque", "point", "frame", "from", "until"});
  ExternalWrench wrench;
  wrench.link = map.child("link").text();
  readVector(map, "force", wrench.force);
  readVector(map, "torque", wrench.torque);
  readVector(map, "point", wrench.point);
  if (map.has("frame"))
  {
    const std::string frame = map.child("frame").text();
    if (frame != "world" && frame != "link")
      map.child("frame").fail("found '" + frame + "', expected world or link");
    wrench.world_frame = frame == "world";
  }
  readFinite(map, "from", wrench.from);
  readFinite(map, "until", wrench.until);
  if (!(wrench.until > wrench.from))
    map.fail("expected until later than from");
  return wrench;
}

void readBodyMotion(const YamlReader& map, BodySpec& body)
{
  if (map.has("velocity"))
  {
    const YamlReader velocity = map.child("velocity");
    velocity.expectMap({"linear", "angular"});
    readVector(velocity, "linear", body.linear_velocity);
    readVector(velocity, "angular", body.angular_velocity);
  }
  if (map.has("motion"))
  {
    const YamlReader motion = map.child("motion");
    motion.expectMap({"linear", "angular"});
    body.motion.emplace(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    readVector(motion, "linear", body.motion->first);
    readVector(motion, "angular", body.motion->second);
  }
}

void readJoints(const YamlReader& map, BodySpec& body)
{
  if (map.has("joints"))
  {
    const YamlReader joints = map.child("joints");
    joints.expectMap();
    for (const auto& entry : joints.node())
    {
      const YamlReader joint = joints.child(entry.first.Scalar());
      joint.expectMap({"position", "velocity"});
      JointInit& init = body.joints[entry.first.Scalar()];
      readFinite(joint, "position", init.position);
      readFinite(joint, "velocity", init.velocity);
    }
  }
  if (map.has("commands"))
  {
    const YamlReader commands = map.child("commands");
    commands.expectMap();
    for (const auto& entry : commands.node())
      body.commands[entry.first.Scalar()] = readCommand(commands.child(entry.first.Scalar()));
  }
}

void readDisabledCollisions(const YamlReader& list, BodySpec& body)
{
  list.expectSequence("pairs of links");
  for (size_t i = 0; i < list.node().size(); ++i)
  {
    const YamlReader pair = list.item(i);
    if (!pair.node().IsSequence() || pair.node().size() != 2)
      pair.fail("expected [link, link]");
    body.disable_collisions.emplace_back(pair.item(0).text(), pair.item(1).text());
  }
}

BodySpec readBody(const YamlReader& map)
{
  map.expectMap({"name", "urdf", "base", "pose", "velocity", "joints", "commands", "hold_initial_position", "wrenches",
                 "motion", "material", "disable_collisions", "min_joint_inertia"});
  BodySpec body;
  body.source = map.place();
  body.name = map.child("name").text();
  if (!std::regex_match(body.name, std::regex("[A-Za-z][A-Za-z0-9_]*")))
    map.child("name").fail("found '" + body.name + "', expected letters, digits and _, a letter first");
  body.urdf_path = resolveRelative(map.child("urdf"));
  if (map.has("base"))
  {
    try
    {
      body.base = parseBaseType(map.child("base").text());
    }
    catch (const std::invalid_argument& error)
    {
      map.child("base").fail(error.what());
    }
  }
  if (map.has("pose"))
    body.pose = readPose(map.child("pose"));
  readBodyMotion(map, body);
  readJoints(map, body);
  if (map.has("hold_initial_position"))
    body.hold_initial_position = map.child("hold_initial_position").boolean();
  if (map.has("wrenches"))
  {
    const YamlReader wrenches = map.child("wrenches");
    wrenches.expectSequence("wrenches");
    for (size_t i = 0; i < wrenches.node().size(); ++i)
      body.wrenches.push_back(readWrench(wrenches.item(i)));
  }
  if (map.has("material"))
    body.material = map.child("material").text();
  if (map.has("disable_collisions"))
    readDisabledCollisions(map.child("disable_collisions"), body);
  if (map.has("min_joint_inertia"))
    body.min_joint_inertia = map.child("min_joint_inertia").number(1e-30, 1e30, "a number > 0");
  return body;
}

void readBodies(const YamlReader& bodies, Scenario& scenario)
{
  bodies.expectSequence("bodies");
  std::set<std::string> names;
  for (size_t i = 0; i < bodies.node().size(); ++i)
  {
    scenario.bodies.push_back(readBody(bodies.item(i)));
    if (!names.insert(scenario.bodies.back().name).second)
      bodies.item(i).child("name").fail("found '" + scenario.bodies.back().name + "' twice, expected different names");
  }
}

/** A material that is used must be known: in the table, as a side of a pair, or `default`. */
void checkMaterials(const YamlReader& document, const Scenario& scenario)
{
  std::set<std::string> known = {"default"};
  for (const auto& entry : scenario.materials.materials)
    known.insert(entry.first);
  for (const auto& entry : scenario.materials.pairs)
    known.insert({entry.first.first, entry.first.second});
  for (size_t i = 0; i < scenario.bodies.size(); ++i)
    if (known.count(scenario.bodies[i].material) == 0)
      document.child("bodies")
          .item(i)
          .child("material")
          .fail("found '" + scenario.bodies[i].material + "', expected a name from materials");
}

void readContactLaw(const YamlReader& law, Scenario& scenario)
{
  const std::string name = law.text();
  if (name != "gap" && name != "velocity")
    law.fail("found '" + name + "', expected gap or velocity");
  scenario.contact_law = name == "gap" ? ContactLawForm::GAP : ContactLawForm::VELOCITY;
}

void readBroadPhase(const YamlReader& kind, Scenario& scenario)
{
  const std::string name = kind.text();
  if (name == "fcl")
    scenario.broad_phase = BroadPhaseKind::FCL;
  else if (name == "list")
    scenario.broad_phase = BroadPhaseKind::LIST;
  else if (name != "auto")
    kind.fail("found '" + name + "', expected auto, fcl or list");
}

void readFailure(const YamlReader& map, FailureOptions& failure)
{
  map.expectMap({"policy", "fallback", "time_limit"});
  if (map.has("policy"))
  {
    try
    {
      failure.policy = parseFailurePolicy(map.child("policy").text());
    }
    catch (const std::invalid_argument& error)
    {
      map.child("policy").fail(error.what());
    }
  }
  if (map.has("fallback"))
    failure.fallback = map.child("fallback").boolean();
  readNonNegative(map, "time_limit", failure.time_limit);
}

void readGround(const YamlReader& map, Scenario& scenario)
{
  map.expectMap({"friction", "height"});
  GroundSpec ground;
  if (map.has("friction"))
    ground.friction = map.child("friction").number(0.0, INFINITE, "a number >= 0");
  readFinite(map, "height", ground.height);
  scenario.ground = ground;
}

Scenario readScenario(const YamlReader& document)
{
  document.expectMap({"time_step", "duration", "gravity", "solver", "materials", "ground", "bodies", "loops",
                      "quasi_static", "contact_law", "failure", "broad_phase"});
  Scenario scenario;
  scenario.name = std::filesystem::path(document.file()).stem().string();
  if (document.has("time_step"))
  {
    scenario.time_step = document.child("time_step").number();
    if (!(scenario.time_step > 0.0))
      document.child("time_step").fail("found '" + document.child("time_step").text() + "', expected a number > 0");
  }
  readNonNegative(document, "duration", scenario.duration);
  readVector(document, "gravity", scenario.gravity);
  if (document.has("solver"))
    readSolver(document.child("solver"), scenario);
  if (document.has("materials"))
    readMaterials(document.child("materials"), scenario.materials);
  if (document.node()["ground"].IsDefined())
  {
    if (document.has("ground"))
      readGround(document.child("ground"), scenario);
    else
      scenario.ground = GroundSpec{};
  }
  if (!document.has("bodies"))
    document.fail("has no bodies, expected a list of them under the key 'bodies'");
  readBodies(document.child("bodies"), scenario);
  if (document.has("contact_law"))
    readContactLaw(document.child("contact_law"), scenario);
  if (document.has("broad_phase"))
    readBroadPhase(document.child("broad_phase"), scenario);
  if (document.has("failure"))
    readFailure(document.child("failure"), scenario.failure);
  if (document.has("loops") && document.node()["loops"].size() > 0)
    document.child("loops").fail("kinematic loops are not built yet, expected none");
  if (document.has("quasi_static") && document.child("quasi_static").boolean())
    document.child("quasi_static").fail("quasi-static problems are not built yet, expected false");
  checkMaterials(document, scenario);
  return scenario;
}
}  // namespace

Scenario loadScenario(const std::string& yaml, const std::string& source)
{
  YAML::Node node;
  try
  {
    node = YAML::Load(yaml);
    return readScenario(YamlReader(node, source, ""));
  }
  catch (const YAML::Exception& error)
  {
    throw ScenarioError(source + ":" + std::to_string(error.mark.line + 1) + ": not valid YAML: " + error.msg);
  }
}

Scenario loadScenarioFile(const std::string& path)
{
  std::ifstream file(path);
  if (!file)
    throw ScenarioError(path + ": cannot be read, expected a scenario file (YAML)");
  std::ostringstream text;
  text << file.rdbuf();
  return loadScenario(text.str(), path);
}

}  // namespace frictional_contact_sim
