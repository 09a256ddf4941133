// What a scenario says of one body, as a table of keys.
#include <filesystem>

#include "frictional_contact_sim/math/roll_pitch_yaw.h"
#include "frictional_contact_sim/model/model_error.h"
#include "frictional_contact_sim/simulation/scenario_keys.h"
#include "sensor_keys.h"

namespace frictional_contact_sim
{
namespace
{
using Mode = JointCommand::Mode;

/** One number a step, or a list over times. */
struct CommandKey
{
  const char* constant;
  const char* over_time;
  Mode mode;
};
constexpr CommandKey COMMAND_KEYS[] = {{"effort", "efforts", Mode::EFFORT},
                                       {"position", "positions", Mode::POSITION},
                                       {"velocity", "velocities", Mode::VELOCITY}};

}  // namespace

Eigen::Isometry3d readPose(const ConfigNode& node)
{
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();
  if (node.isMap())
    node.readMap({key("xyz", xyz), key("rpy", rpy)});
  else if (node.isList())
  {
    const Eigen::Matrix<double, 6, 1> six = node.vector<6>();
    xyz = six.head<3>();
    rpy = six.tail<3>();
  }
  else
    node.failExpecting("{xyz: [x, y, z], rpy: [roll, pitch, yaw]} or [x, y, z, roll, pitch, yaw]");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = xyz;
  pose.linear() = fromRollPitchYaw(rpy).toRotationMatrix();
  return pose;
}

namespace
{
/** times: [...] beside the targets: as many, increasing. */
void checkTimes(const ConfigNode& node, const char* targets, const CommandSchedule& schedule)
{
  if (schedule.times.empty())
    node.at("times").failExpecting("at least one time [s]");
  if (schedule.times.size() != schedule.targets.size())
    node.at(targets).failExpecting("as many entries as times, " + std::to_string(schedule.times.size()));
  const std::vector<ConfigNode> times = node.at("times").items("times");
  for (size_t k = 1; k < times.size(); ++k)
    if (!(schedule.times[k] > schedule.times[k - 1]))
      times[k].failExpecting("more than the time before, " + numberText(schedule.times[k - 1]));
}

void readCommand(const ConfigNode& node, const std::string& joint, BodySpec& body)
{
  JointCommand command;
  CommandSchedule schedule;
  std::string targets;
  int given = 0;
  ConfigKeys keys = {key("rate", command.rate),
                     key("feedforward", command.feedforward),
                     key("kp", command.kp, notNegative()),
                     key("kd", command.kd, notNegative()),
                     key("max_effort", command.max_effort, notNegative()),
                     key("times", [&](const ConfigNode& times) { schedule.times = times.numbers(); })};
  for (const CommandKey& kind : COMMAND_KEYS)
  {
    const auto choose = [&command, &given, mode = kind.mode]
    {
      command.mode = mode;
      ++given;
    };
    keys.push_back(key(kind.constant,
                       [&command, choose](const ConfigNode& value)
                       {
                         choose();
                         command.target = value.number();
                       }));
    keys.push_back(key(kind.over_time,
                       [&schedule, &targets, choose, name = kind.over_time](const ConfigNode& list)
                       {
                         choose();
                         targets = name;
                         schedule.targets = list.numbers();
                       }));
  }
  node.readMap(keys);
  if (given != 1)
    node.fail("expected exactly one of effort, position, velocity, efforts, positions, velocities");
  if (node.has("rate") && (command.mode != Mode::POSITION || !targets.empty()))
    node.at("rate").failExpecting("none without position");
  if (node.has("feedforward") && command.mode == Mode::EFFORT)
    node.at("feedforward").failExpecting("none beside an effort");
  if (!targets.empty() || node.has("times"))
  {
    if (targets.empty())
      node.at("times").failExpecting("none without efforts, positions or velocities");
    checkTimes(node, targets.c_str(), schedule);
    command.target = schedule.targets.front();
    body.schedules[joint] = schedule;
  }
  body.commands[joint] = command;
}

ExternalWrench readWrench(const ConfigNode& node)
{
  ExternalWrench wrench;
  node.readMap({required(key("link", [&](const ConfigNode& link) { wrench.link = link.text(); })),
                key("force", wrench.force), key("torque", wrench.torque), key("point", wrench.point),
                key("frame", wrench.world_frame, Choices<bool>{{"world", true}, {"link", false}}),
                key("from", wrench.from), key("until", wrench.until)});
  if (!(wrench.until > wrench.from))
    node.fail("expected until later than from");
  return wrench;
}

void readTable(const ConfigNode& node, BaseMotion& motion)
{
  std::vector<Eigen::Vector3d> turns;
  const auto readVectors = [](const ConfigNode& list, std::vector<Eigen::Vector3d>& vectors)
  {
    for (const ConfigNode& item : list.items("vectors"))
      vectors.push_back(item.vector<3>());
  };
  node.readMap({required(key("type", [](const ConfigNode&) {})),
                required(key("times", [&](const ConfigNode& list) { motion.times = list.numbers(); })),
                key("xyz", [&](const ConfigNode& list) { readVectors(list, motion.displacements); }),
                key("rpy", [&](const ConfigNode& list) { readVectors(list, turns); })});
  const size_t count = motion.times.size();
  if (count == 0 ||
      std::adjacent_find(motion.times.begin(), motion.times.end(), std::greater_equal<>()) != motion.times.end())
    node.at("times").failExpecting("at least one time, ascending");
  if (!node.has("xyz") && !node.has("rpy"))
    node.fail("has neither xyz nor rpy, expected one of them at the least");
  if (motion.displacements.empty() && !node.has("xyz"))
    motion.displacements.assign(count, Eigen::Vector3d::Zero());
  if (motion.displacements.size() != count)
    node.at("xyz").failExpecting(std::to_string(count) + " vectors, one a time");
  if (node.has("rpy") && turns.size() != count)
    node.at("rpy").failExpecting(std::to_string(count) + " vectors, one a time");
  for (const Eigen::Vector3d& rpy : turns)
    motion.turns.push_back(fromRollPitchYaw(rpy));
}

void readMotion(const ConfigNode& node, BodySpec& body)
{
  BaseMotion& motion = body.motion.emplace();
  motion.active = true;
  using Type = BaseMotion::Type;
  if (node.has("type"))
    motion.type = node.at("type").choice(
        Choices<Type>{{"constant", Type::CONSTANT}, {"sine", Type::SINE}, {"table", Type::TABLE}});
  if (motion.type == Type::TABLE)
    readTable(node, motion);
  else if (motion.type == Type::SINE)
  {
    node.readMap({required(key("type", [](const ConfigNode&) {})), required(key("axis", motion.axis)),
                  required(key("amplitude", motion.amplitude)),
                  required(key("frequency", motion.frequency, notNegative())), key("phase", motion.phase)});
    if (!(motion.axis.norm() > 1e-9))
      node.at("axis").failExpecting("a direction");
    motion.axis.normalize();
  }
  else
    node.readMap({key("type", [](const ConfigNode&) {}), key("linear", motion.velocity.linear),
                  key("angular", motion.velocity.angular)});
}

void readSurfaces(const ConfigNode& node, BodySpec& body)
{
  for (const auto& [link, surface] : node.entries())
  {
    SurfaceMotion& motion = body.surface_velocity[link];
    surface.readMap({key("linear", motion.linear), key("angular", motion.angular)});
  }
}

void readSprings(const ConfigNode& node, BodySpec& body)
{
  for (const auto& [joint, spring] : node.entries())
  {
    SpringSpec& read = body.springs[joint];
    spring.readMap({required(key("stiffness", read.stiffness, notNegative())), key("rest", read.rest),
                    key("damping", read.damping, notNegative())});
  }
}

void readJoints(const ConfigNode& node, BodySpec& body)
{
  for (const auto& [name, joint] : node.entries())
  {
    JointInit& init = body.joints[name];
    joint.readMap({key("position", init.position), key("velocity", init.velocity)});
  }
}
}  // namespace

ConfigKey poseKey(const std::string& name, BodySpec& body)
{
  return key(
      name, [&body](const ConfigNode& node) { body.pose = readPose(node); });
}

ConfigKey linkMaterialsKey(const std::string& name, BodySpec& body)
{
  return key(
      name,
      [&body](const ConfigNode& node)
      {
        for (const auto& [link, material] : node.entries())
          body.link_materials[link] = material.text();
      });
}

ConfigKeys bodyKeys(BodySpec& body)
{
  return {
      key("base", body.base,
          Choices<BaseType>{{"auto", BaseType::AUTO}, {"floating", BaseType::FLOATING}, {"fixed", BaseType::FIXED}}),
      poseKey("pose", body),
      key(
          "velocity",
          [&body](const ConfigNode& node) {
            node.readMap({key("linear", body.linear_velocity), key("angular", body.angular_velocity)});
          }),
      key(
          "joints", [&body](const ConfigNode& node) { readJoints(node, body); }),
      key(
          "commands",
          [&body](const ConfigNode& node)
          {
            for (const auto& [name, command] : node.entries())
              readCommand(command, name, body);
          }),
      key("hold_initial_position", body.hold_initial_position),
      key("gravity_compensation", body.gravity_compensation),
      key(
          "wrenches",
          [&body](const ConfigNode& node)
          {
            for (const ConfigNode& wrench : node.items("wrenches"))
              body.wrenches.push_back(readWrench(wrench));
          }),
      key(
          "motion", [&body](const ConfigNode& node) { readMotion(node, body); }),
      key(
          "surface_velocity", [&body](const ConfigNode& node) { readSurfaces(node, body); }),
      key(
          "springs", [&body](const ConfigNode& node) { readSprings(node, body); }),
      key(
          "material", [&body](const ConfigNode& node) { body.material = node.text(); }),
      key(
          "sensors", [&body](const ConfigNode& node) { body.sensors = readSensors(node); }),
      key("self_collision", body.self_collision),
      key(
          "min_joint_inertia", [&body](const ConfigNode& node) { body.min_joint_inertia = node.number(positive()); }),
      key(
          "disable_collisions",
          [&body](const ConfigNode& node)
          {
            for (const ConfigNode& pair : node.items("pairs of links"))
              body.disable_collisions.push_back(pair.pairOfTexts());
          })};
}

std::string resolveFile(const ConfigNode& node)
{
  try
  {
    return resolvePath(node.text(), node.folder());
  }
  catch (const ModelError& error)
  {
    node.fail(error.what());
  }
}

}  // namespace frictional_contact_sim
