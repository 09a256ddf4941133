#include "body_loading.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "elastic_loading.h"
#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{
/// Of an initial velocity or joint position [SI]: beyond it nothing is meant seriously.
constexpr double LARGEST_NUMBER = 1e6;
/// Of a coordinate of the base [m]: map coordinates (UTM, Web Mercator, earth-centred) are below 2.1e7, where a double
/// still resolves 4e-9 m.
constexpr double LARGEST_COORDINATE = 3e7;
constexpr double DROP_HEIGHT = 0.001;  ///< lowest collision point above the ground where no pose is given [m]

[[noreturn]] void fail(const std::string& body, const std::string& message)
{
  throw std::invalid_argument("body '" + body + "': " + message);
}

template <typename Named>
std::vector<std::string> namesOf(const std::vector<Named>& things)
{
  std::vector<std::string> names;
  for (const Named& thing : things)
    names.push_back(thing.name);
  return names;
}

/** "unknown joint 'hipp', did you mean 'hip'?" */
template <typename Named>
[[noreturn]] void failUnknown(const std::string& body, const std::string& what, const std::string& name,
                              const std::vector<Named>& things)
{
  const std::string nearest = nearestName(name, namesOf(things));
  fail(body, what + " '" + name + "'" + (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
}

int findSingleJoint(const BodyModel& model, const std::string& name, const std::string& purpose)
{
  const int joint = model.tree.findJoint(name);
  if (joint < 0)
    failUnknown(model.name, purpose + " names an unknown joint", name, model.tree.joints);
  if (velocitySize(model.tree.joints[joint].type) != 1)
    fail(model.name, purpose + ": joint '" + name + "' has not exactly one coordinate");
  return joint;
}

/** Start of a mimic joint from the one it follows, that one first: chains may stand in any order (circles are refused).
 */
void followMimic(const Draft& body, int index)
{
  const Joint& joint = body.model.tree.joints[index];
  if (joint.mimic.joint < 0)
    return;
  followMimic(body, joint.mimic.joint);
  const Joint& followed = body.model.tree.joints[joint.mimic.joint];
  body.state.q[joint.q_index] = joint.mimic.multiplier * body.state.q[followed.q_index] + joint.mimic.offset;
  body.state.v[joint.v_index] = joint.mimic.multiplier * body.state.v[followed.v_index];
}

/** Joint positions: as given; else zero, or the nearest limit where zero is out of range. Mimic joints follow. */
void setInitialJoints(const BodySpec& spec, const Draft& body, std::vector<std::string>& warnings)
{
  const BodyModel& model = body.model;
  for (const Joint& joint : model.tree.joints)
    if (velocitySize(joint.type) == 1)
    {
      const double start = std::clamp(0.0, joint.limit.lower, joint.limit.upper);
      body.state.q[joint.q_index] = start;
      if (start != 0.0 && spec.joints.count(joint.name) == 0)
        warnings.push_back("body '" + model.name + "': joint '" + joint.name + "' starts at its limit " +
                           std::to_string(start) + ", since zero is outside its range");
    }
  for (const auto& [name, init] : spec.joints)
  {
    if (!(std::abs(init.position) < LARGEST_NUMBER) || !(std::abs(init.velocity) < LARGEST_NUMBER))
      fail(model.name, "joint '" + name + "' starts beyond 1e6 in position or velocity");
    const Joint& joint = model.tree.joints[findSingleJoint(model, name, "joints")];
    if (init.position < joint.limit.lower || init.position > joint.limit.upper)
      warnings.push_back("body '" + model.name + "': joint '" + name + "' starts at " + std::to_string(init.position) +
                         ", outside its limits " + std::to_string(joint.limit.lower) + " .. " +
                         std::to_string(joint.limit.upper));
    body.state.q[joint.q_index] = init.position;
    body.state.v[joint.v_index] = init.velocity;
  }
  for (size_t j = 0; j < model.tree.joints.size(); ++j)
    followMimic(body, static_cast<int>(j));
}

void expectBelow(const std::string& body, const std::string& key, const Eigen::Vector3d& vector, double largest,
                 const std::string& unit)
{
  for (const double component : vector)
  {
    if (std::abs(component) < largest)
      continue;
    std::ostringstream text;
    text.precision(10);
    text << key << " has the component " << component << ", expected less than " << largest << unit;
    fail(body, text.str());
  }
}

void setBasePose(const Draft& body, const Eigen::Isometry3d& pose)
{
  if (body.model.tree.joints.front().type == JointType::FLOATING)
  {
    body.state.q.head<3>() = pose.translation();
    body.state.q.segment<4>(3) = Eigen::Quaterniond(pose.linear()).normalized().coeffs();
  }
  else
    body.state.base_pose = pose;
}

void setInitialBase(const BodySpec& spec, const Draft& body)
{
  const BodyModel& model = body.model;
  const bool floating = model.tree.joints.front().type == JointType::FLOATING;
  const Eigen::Vector3d position = spec.pose ? Eigen::Vector3d(spec.pose->translation()) : Eigen::Vector3d::Zero();
  expectBelow(model.name, "pose.xyz", position, LARGEST_COORDINATE, " m; move the scene's origin nearer");
  expectBelow(model.name, "velocity.linear", spec.linear_velocity, LARGEST_NUMBER, " m/s");
  expectBelow(model.name, "velocity.angular", spec.angular_velocity, LARGEST_NUMBER, " rad/s");
  setBasePose(body, spec.pose.value_or(Eigen::Isometry3d::Identity()));
  if (floating)
  {
    body.state.v.head<3>() = spec.linear_velocity;
    body.state.v.segment<3>(3) = spec.angular_velocity;
  }
  else if (!spec.linear_velocity.isZero() || !spec.angular_velocity.isZero())
    fail(model.name, "velocity is for a floating base; a fixed base takes 'motion'");
  if (!spec.motion)
    return;
  if (floating)
    fail(model.name, "motion is for a fixed base, but its base is floating");
  // What hangs on its joints would feel the acceleration.
  if (model.nv > 0 && (spec.motion->isProgram() || !spec.motion->velocity.angular.isZero()))
    fail(model.name, std::string("motion") + (spec.motion->isProgram() ? " over time" : ".angular") +
                         " is for a body without joints, this one has " + std::to_string(model.nv) +
                         ": weld a floating base to a body that moves (loops)");
  startMotion(*spec.motion, body);
}

void setSurfaces(const BodySpec& spec, const Draft& body)
{
  for (const auto& [link, motion] : spec.surface_velocity)
  {
    expectBelow(spec.name, "surface_velocity.linear", motion.linear, LARGEST_NUMBER, " m/s");
    expectBelow(spec.name, "surface_velocity.angular", motion.angular, LARGEST_NUMBER, " rad/s");
    SurfaceMotion surface = motion;
    surface.frame = body.model.tree.findFrame(link);
    if (surface.frame < 0)
      failUnknown(spec.name, "surface_velocity names an unknown link", link, body.model.tree.frames);
    body.model.surfaces.push_back(surface);
  }
}

void setSprings(const BodySpec& spec, const Draft& body)
{
  for (const auto& [name, spring] : spec.springs)
  {
    const int joint = findSingleJoint(body.model, name, "springs");
    body.model.springs.push_back({joint, spring.stiffness, spring.rest});
    body.model.damping[body.model.velocityIndex(joint)] += spring.damping;
  }
}

void setSchedules(const BodySpec& spec, const Draft& body)
{
  for (const auto& [name, schedule] : spec.schedules)
  {
    if (spec.commands.count(name) == 0 || schedule.empty())
      fail(spec.name, "the command over time of joint '" + name + "' has no command or no times");
    const int joint = findSingleJoint(body.model, name, "commands");
    try
    {
      schedule.validate();
    }
    catch (const std::invalid_argument& error)
    {
      fail(spec.name, "the command over time of joint '" + name + "' " + error.what());
    }
    body.model.schedules[joint] = schedule;
    body.state.drives[joint].is_scheduled = true;
  }
}

void setCommands(const BodySpec& spec, const Draft& body)
{
  for (const auto& [name, command] : spec.commands)
  {
    const int joint = findSingleJoint(body.model, name, "commands");
    body.state.drives[joint] = makeDrive(body.model, joint, command);
  }
  setSchedules(spec, body);
  if (!spec.hold_initial_position)
    return;
  for (size_t j = 0; j < body.state.drives.size(); ++j)
  {
    const int joint = static_cast<int>(j);
    const Joint& moved = body.model.tree.joints[j];
    if (!body.model.isActuated(joint) || spec.commands.count(moved.name) > 0)
      continue;
    JointCommand hold;
    hold.mode = JointCommand::Mode::POSITION;
    hold.target = body.state.q[moved.q_index];
    body.state.drives[joint] = makeDrive(body.model, joint, hold);
  }
}

/** URDF's effort="0" often means that nobody filled it in. */
void warnOfDeadDrives(const BodyModel& model, std::vector<std::string>& warnings)
{
  for (size_t j = 0; j < model.tree.joints.size(); ++j)
    if (model.isActuated(static_cast<int>(j)) && model.tree.joints[j].limit.effort == 0.0)
      warnings.push_back("body '" + model.name + "': joint '" + model.tree.joints[j].name +
                         "' has the effort limit 0: commands do nothing there");
}

void setWrenches(const BodySpec& spec, const Draft& body)
{
  checkSensors(body.model.tree, spec.sensors);
  for (ExternalWrench wrench : spec.wrenches)
  {
    wrench.frame = body.model.tree.findFrame(wrench.link);
    if (wrench.frame < 0)
      failUnknown(body.model.name, "wrenches names an unknown link", wrench.link, body.model.tree.frames);
    body.state.wrenches.push_back(wrench);
  }
}

/** @return index of the body in the collision world */
int addShapes(const BodySpec& spec, const Draft& body, WorldModel& world)
{
  try
  {
    std::vector<std::string> warnings;
    const int handle = world.collision.addBody(body.model.tree, &warnings);
    for (const std::string& warning : warnings)
      world.warnings.push_back("body '" + spec.name + "': " + warning);
    body.model.setMeshReach(world.collision.meshReach(handle));
    return handle;
  }
  catch (const ModelError& error)
  {
    throw ModelError((spec.urdf_path.empty() ? "robot_description" : spec.urdf_path) + ": " + error.what());
  }
}

/** What of the body collides, and with which material. */
void checkLinks(const BodySpec& spec, const BodyModel& model)
{
  const auto check = [&](const std::string& what, const std::string& link)
  {
    if (model.tree.findFrame(link) < 0)
      failUnknown(model.name, what + " names an unknown link", link, model.tree.frames);
  };
  for (const auto& [link_1, link_2] : spec.disable_collisions)
  {
    check("disable_collisions", link_1);
    check("disable_collisions", link_2);
  }
  for (const auto& entry : spec.link_materials)
    check("materials", entry.first);
}

void place(const BodySpec& spec, const Draft& body, WorldModel& world)
{
  if (spec.elastic)
  {
    placeElastic(spec, body, world);
    return;
  }
  checkLinks(spec, body.model);
  const int handle = addShapes(spec, body, world);  // bodies and handles count alike
  if (!spec.self_collision)
    world.collision.disableSelfCollision(handle);
  for (const auto& [link_1, link_2] : spec.disable_collisions)
    world.collision.disablePair(handle, link_1, link_2);
  Body moved(body.model, body.state);
  updateEnd(moved);
  world.collision.setPoses(handle, moved.end);
  const double lowest = world.collision.lowestPoint(handle);
  if (!spec.pose && body.model.tree.joints.front().type == JointType::FLOATING && std::isfinite(lowest))
  {
    body.state.q[2] += (world.scenario.ground ? world.scenario.ground->height : 0.0) + DROP_HEIGHT - lowest;
    updateEnd(moved);
    world.collision.setPoses(handle, moved.end);
  }
  computeMassMatrix(body.model.tree, moved.end);
  if (!moved.end.mass_matrix.allFinite() || !factorizeMassMatrix(body.model.tree, body.model.damping, moved.end))
    fail(body.model.name, "its mass matrix is not positive definite at the initial position");
  for (size_t j = 0; j < body.model.tree.joints.size(); ++j)
    if (body.model.isActuated(static_cast<int>(j)))
      body.model.servo_inertia[j] = servoInertia(body.model, moved.end, static_cast<int>(j));
  setCommands(spec, body);
  warnOfDeadDrives(body.model, world.warnings);
  setWrenches(spec, body);
}

/** Messages about a body begin with where it was read. */
template <typename Load>
void atSource(const BodySpec& spec, const Load& load)
{
  try
  {
    load();
  }
  catch (const std::invalid_argument& error)
  {
    throw std::invalid_argument((spec.source.empty() ? "" : spec.source + ": ") + error.what());
  }
}
}  // namespace

BodyModel loadBody(const BodySpec& spec, std::vector<std::string>& warnings)
{
  if (spec.elastic)
    return loadElastic(spec);
  LoadedModel loaded = spec.urdf_path.empty()
                           ? loadUrdf(spec.urdf_xml, "robot_description", spec.base, spec.min_joint_inertia)
                           : loadUrdfFile(spec.urdf_path, spec.base, spec.min_joint_inertia);
  for (const std::string& warning : loaded.warnings)
    warnings.push_back("body '" + spec.name + "': " + warning);
  BodyModel model(std::move(loaded.model));
  model.name = spec.name;
  model.gravity_compensation = spec.gravity_compensation;
  return model;
}

void startMotion(const BaseMotion& motion, const Draft& body)
{
  body.model.base_motion = motion;
  body.model.base_motion.start = body.state.base_pose;
  if (motion.isProgram())
    body.state.base_pose = programPose(body.model.base_motion, 0.0);
}

void setInitialState(const BodySpec& spec, const Draft& body, std::vector<std::string>& warnings)
{
  atSource(
      spec,
      [&]()
      {
        if (spec.elastic)
        {
          setElasticState(spec, body);
          return;
        }
        setInitialJoints(spec, body, warnings);
        setInitialBase(spec, body);
        setSurfaces(spec, body);
        setSprings(spec, body);
      });
}

void placeBody(const BodySpec& spec, const Draft& body, WorldModel& world)
{
  atSource(
      spec, [&]() { place(spec, body, world); });
}

}  // namespace frictional_contact_sim
