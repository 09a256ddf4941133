#include "frictional_contact_sim/simulation/world.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LARGEST_NUMBER =
    1e6;  ///< of an initial position or velocity [SI]: beyond it nothing is meant seriously
constexpr double DROP_HEIGHT = 0.001;  ///< lowest collision point above the ground where no pose is given [m]

[[noreturn]] void fail(const std::string& body, const std::string& message)
{
  throw std::invalid_argument("body '" + body + "': " + message);
}

int findSingleJoint(const Robot& robot, const std::string& name, const std::string& purpose)
{
  const int joint = robot.model.findJoint(name);
  if (joint < 0)
    fail(robot.name, purpose + " names an unknown joint '" + name + "'");
  if (velocitySize(robot.model.joints[joint].type) != 1)
    fail(robot.name, purpose + ": joint '" + name + "' has not exactly one coordinate");
  return joint;
}

/** Joint positions: as given; else zero, or the nearest limit where zero is out of range. Mimic joints follow. */
void setInitialJoints(const BodySpec& spec, Robot& robot, std::vector<std::string>& warnings)
{
  for (const Joint& joint : robot.model.joints)
    if (velocitySize(joint.type) == 1)
    {
      const double start = std::clamp(0.0, joint.limit.lower, joint.limit.upper);
      robot.q[joint.q_index] = start;
      if (start != 0.0 && spec.joints.count(joint.name) == 0)
        warnings.push_back("body '" + robot.name + "': joint '" + joint.name + "' starts at its limit " +
                           std::to_string(start) + ", since zero is outside its range");
    }
  for (const auto& [name, init] : spec.joints)
  {
    if (!(std::abs(init.position) < LARGEST_NUMBER) || !(std::abs(init.velocity) < LARGEST_NUMBER))
      fail(robot.name, "joint '" + name + "' starts beyond 1e6 in position or velocity");
    const Joint& joint = robot.model.joints[findSingleJoint(robot, name, "joints")];
    if (init.position < joint.limit.lower || init.position > joint.limit.upper)
      warnings.push_back("body '" + robot.name + "': joint '" + name + "' starts at " + std::to_string(init.position) +
                         ", outside its limits " + std::to_string(joint.limit.lower) + " .. " +
                         std::to_string(joint.limit.upper));
    robot.q[joint.q_index] = init.position;
    robot.v[joint.v_index] = init.velocity;
  }
  for (const Joint& joint : robot.model.joints)
    if (joint.mimic.joint >= 0)
    {
      const Joint& followed = robot.model.joints[joint.mimic.joint];
      robot.q[joint.q_index] = joint.mimic.multiplier * robot.q[followed.q_index] + joint.mimic.offset;
      robot.v[joint.v_index] = joint.mimic.multiplier * robot.v[followed.v_index];
    }
}

void setBasePose(Robot& robot, const Eigen::Isometry3d& pose)
{
  if (robot.model.joints.front().type == JointType::FLOATING)
  {
    robot.q.head<3>() = pose.translation();
    robot.q.segment<4>(3) = Eigen::Quaterniond(pose.linear()).normalized().coeffs();
  }
  else
  {
    robot.model.joints.front().placement = pose;
    robot.base_pose = pose;
  }
}

void setInitialBase(const BodySpec& spec, Robot& robot)
{
  const bool floating = robot.model.joints.front().type == JointType::FLOATING;
  const Eigen::Vector3d position = spec.pose ? Eigen::Vector3d(spec.pose->translation()) : Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d* vector : {&position, &spec.linear_velocity, &spec.angular_velocity})
    if (!(vector->cwiseAbs().maxCoeff() < LARGEST_NUMBER))
      fail(robot.name, "pose or velocity has a component that is not a number below 1e6");
  setBasePose(robot, spec.pose.value_or(Eigen::Isometry3d::Identity()));
  if (floating)
  {
    robot.v.head<3>() = spec.linear_velocity;
    robot.v.segment<3>(3) = spec.angular_velocity;
  }
  else if (!spec.linear_velocity.isZero() || !spec.angular_velocity.isZero())
    fail(robot.name, "velocity is for a floating base; a fixed base takes 'motion'");
  if (!spec.motion)
    return;
  if (floating)
    fail(robot.name, "motion is for a fixed base, but its base is floating");
  if (robot.model.nv > 0 && !spec.motion->second.isZero())
    fail(robot.name, "motion.angular is for a body without joints, this one has " + std::to_string(robot.model.nv));
  robot.base_motion = {spec.motion->first, spec.motion->second, true};
}

void setCommands(const BodySpec& spec, Robot& robot)
{
  for (const auto& [name, command] : spec.commands)
  {
    const int joint = findSingleJoint(robot, name, "commands");
    robot.actuators[joint] = makeActuator(robot, joint, command);
  }
  if (!spec.hold_initial_position)
    return;
  for (size_t j = 0; j < robot.model.joints.size(); ++j)
  {
    const int joint = static_cast<int>(j);
    if (!robot.isActuated(joint) || spec.commands.count(robot.model.joints[j].name) > 0)
      continue;
    JointCommand hold;
    hold.mode = JointCommand::Mode::POSITION;
    hold.target = robot.q[robot.model.joints[j].q_index];
    robot.actuators[joint] = makeActuator(robot, joint, hold);
  }
}

/** URDF's effort="0" often means that nobody filled it in. */
void warnOfDeadDrives(const Robot& robot, std::vector<std::string>& warnings)
{
  for (size_t j = 0; j < robot.actuators.size(); ++j)
    if (robot.isActuated(static_cast<int>(j)) && robot.model.joints[j].limit.effort == 0.0)
      warnings.push_back("body '" + robot.name + "': joint '" + robot.model.joints[j].name +
                         "' has the effort limit 0: commands do nothing there");
}

void setWrenches(const BodySpec& spec, Robot& robot)
{
  for (const ExternalWrench& wrench : spec.wrenches)
  {
    const int frame = robot.model.findFrame(wrench.link);
    if (frame < 0)
      fail(robot.name, "wrenches names an unknown link '" + wrench.link + "'");
    robot.wrenches.push_back(wrench);
    robot.wrench_frames.push_back(frame);
  }
}

Robot loadRobot(const BodySpec& spec, std::vector<std::string>& warnings)
{
  LoadedModel loaded = spec.urdf_path.empty() ? loadUrdf(spec.urdf_xml, "robot_description", spec.base)
                                              : loadUrdfFile(spec.urdf_path, spec.base);
  for (const std::string& warning : loaded.warnings)
    warnings.push_back("body '" + spec.name + "': " + warning);
  Robot robot(std::move(loaded.model));
  const auto limited = std::count_if(robot.model.joints.begin(), robot.model.joints.end(),
                                     [](const Joint& joint) { return std::isfinite(joint.limit.velocity); });
  if (limited > 0)
    warnings.push_back("body '" + spec.name + "': velocity limits of joints are not enforced (" +
                       std::to_string(limited) + " joints)");
  robot.name = spec.name;
  setInitialJoints(spec, robot, warnings);
  setInitialBase(spec, robot);
  return robot;
}

std::vector<SurfaceSide> surfaceSides(const Scenario& scenario, const std::vector<Robot>& robots,
                                      const CollisionWorld& collision)
{
  std::vector<SurfaceSide> sides;
  std::vector<int> next_shape(robots.size(), 0);
  for (int handle = 0; handle < collision.shapeCount(); ++handle)
  {
    const int robot = collision.shape(handle).robot;
    if (robot < 0)
      sides.push_back({"ground", scenario.ground->friction.value_or(-1.0)});
    else
      sides.push_back({scenario.bodies[robot].material, robots[robot].model.shapes[next_shape[robot]++].friction});
  }
  return sides;
}
}  // namespace

Actuator makeActuator(const Robot& robot, int joint, const JointCommand& command)
{
  const Joint& moved = robot.model.joints[joint];
  if (!robot.isActuated(joint))
    fail(robot.name, "joint '" + moved.name + "' takes no command: it " +
                         (moved.mimic.joint >= 0 ? "mimics another" : "has not exactly one coordinate"));
  const auto check = [&](const char* what, double value, bool ok)
  {
    if (!ok)
      fail(robot.name, "command of joint '" + moved.name + "': " + what + " is " + std::to_string(value) +
                           ", expected a finite number" + (what[0] == 't' ? "" : " >= 0"));
  };
  check("target", command.target, std::isfinite(command.target));
  check("kp", command.kp, std::isnan(command.kp) || (std::isfinite(command.kp) && command.kp >= 0.0));
  check("kd", command.kd, std::isnan(command.kd) || (std::isfinite(command.kd) && command.kd >= 0.0));
  check("max_effort", command.max_effort, command.max_effort >= 0.0);
  Actuator actuator;
  actuator.command = command;
  actuator.effort_limit = std::min(moved.limit.effort, command.max_effort);
  if (command.mode == JointCommand::Mode::EFFORT)
    actuator.command.target = std::clamp(command.target, -actuator.effort_limit, actuator.effort_limit);
  else
    fillDefaultGains(robot.servo_inertia[joint], actuator.command);
  return actuator;
}

void updateEnd(Robot& robot)
{
  forwardKinematics(robot.model, robot.q, robot.end);
  forwardVelocities(robot.model, robot.v, robot.end);
  // A moving base carries all bodies along; `reference` is its origin.
  if (robot.base_motion.active)
    for (Vector6d& velocity : robot.end.body_velocity)
    {
      velocity.head<3>() += robot.base_motion.linear;
      velocity.tail<3>() += robot.base_motion.angular;
    }
}

World loadWorld(const Scenario& scenario)
{
  World world;
  world.robots.reserve(scenario.bodies.size());
  for (const BodySpec& spec : scenario.bodies)
    world.robots.push_back(loadRobot(spec, world.warnings));
  for (size_t r = 0; r < world.robots.size(); ++r)
  {
    Robot& robot = world.robots[r];
    const BodySpec& spec = scenario.bodies[r];
    const int index = world.collision.addRobot(robot.model);
    for (const auto& [link_1, link_2] : spec.disable_collisions)
      world.collision.disablePair(index, link_1, link_2);
    updateEnd(robot);
    world.collision.setPoses(index, robot.end);
    const double lowest = world.collision.lowestPoint(index);
    if (!spec.pose && robot.model.joints.front().type == JointType::FLOATING && std::isfinite(lowest))
    {
      robot.q[2] += (scenario.ground ? scenario.ground->height : 0.0) + DROP_HEIGHT - lowest;
      updateEnd(robot);
      world.collision.setPoses(index, robot.end);
    }
    computeMassMatrix(robot.model, robot.end);
    if (!robot.end.mass_matrix.allFinite() || !factorizeMassMatrix(robot.model, robot.damping, robot.end))
      fail(robot.name, "its mass matrix is not positive definite at the initial position");
    for (size_t j = 0; j < robot.model.joints.size(); ++j)
      if (robot.isActuated(static_cast<int>(j)))
        robot.servo_inertia[j] = servoInertia(robot, robot.end, static_cast<int>(j));
    setCommands(spec, robot);
    warnOfDeadDrives(robot, world.warnings);
    setWrenches(spec, robot);
  }
  if (scenario.ground)
  {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().z() = scenario.ground->height;
    world.collision.addStatic(HalfSpace{}, pose, "ground");
  }
  for (const std::string& pair : world.collision.disableOverlaps())
    world.warnings.push_back("links overlap at the start and will not collide: " + pair);
  world.pairs = PairTable(scenario.materials, surfaceSides(scenario, world.robots, world.collision));
  return world;
}

}  // namespace frictional_contact_sim
