#include "support/random_scene.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
constexpr double PI = 3.14159265358979323846;

/** Bodies one after the other along x, some above the one before. */
class SceneWriter
{
public:
  explicit SceneWriter(std::uint32_t seed) : dice_(0x9e3779b9u * (seed + 1))
  {
    scene_.seed = seed;
    scene_.mode = static_cast<SceneMode>(seed / 2 % 4);
    calm_ = scene_.mode == SceneMode::REST || scene_.mode == SceneMode::PUSH;
    falls_ = scene_.mode == SceneMode::FREE_FALL;
    moves_ = !calm_ && !(falls_ && dice_.chance(0.5));
    gravity_ = !calm_ && dice_.chance(falls_ ? 0.3 : 0.1) ? 0.0 : 9.81;
    const std::array<double, 3> steps{1e-3, 2e-3, 5e-4};
    const double friction = calm_ ? dice_.uniform(0.3, 2.0) : dice_.chance(0.15) ? 0.0 : dice_.uniform(0.0, 2.0);
    const double restitution = calm_ || dice_.chance(0.7) ? 0.0 : dice_.uniform(0.0, 1.0);
    const double duration = falls_ ? 0.1 : scene_.mode == SceneMode::DROP ? 0.3 : 1.0;
    scene_.head = "{\"time_step\": " + text(steps[dice_.integer(0, 2)]) + ", \"duration\": " + text(duration) +
                  ", \"gravity\": [0, 0, " + text(-gravity_) +
                  "],\n \"materials\": {\"default\": {\"friction\": " + text(friction) +
                  ", \"restitution\": " + text(restitution) + "}}," + (falls_ ? "" : " \"ground\": {},") +
                  "\n \"bodies\": [\n";
    const int bodies = dice_.chance(0.5) ? 1 : dice_.integer(2, 4);
    if (dice_.chance(0.25))
      addClamp();
    for (int body = static_cast<int>(scene_.bodies.size()); body < bodies; ++body)
      addBody(body);
    scene_.scenario = scene_.with(static_cast<int>(scene_.bodies.size()));
  }
  RandomScene take() { return std::move(scene_); }

private:
  void addBody(int index)
  {
    const bool limp = dice_.chance(0.4);
    const bool hold = !limp && (calm_ || dice_.chance(0.3));
    const std::string prefix = "seed_" + std::to_string(scene_.seed) + "_" + std::to_string(index) + "_";
    RandomRobot robot = randomRobot(dice_, scene_.seed >= MESH_SEEDS ? prefix : "");
    const bool fixed = dice_.chance(0.15) && robot.joints.size() > 2;
    const Eigen::Vector3d rpy = dice_.vector(dice_.chance(0.7) ? PI : 0.0);
    std::string joints;
    for (const RandomJoint& joint : robot.joints)
    {
      if (!joint.single)
        continue;
      joints += std::string(joints.empty() ? "" : ", ") + "\"" + joint.name +
                "\": {\"position\": " + text(joint.start) +
                ", \"velocity\": " + text(!moves_ || dice_.chance(0.5) ? 0.0 : dice_.uniform(-3.0, 3.0)) + "}";
    }
    const Extent extent = extentOf(robot, fixed ? BaseType::FIXED : BaseType::FLOATING, rpy);
    const double gap = falls_ ? 20.0 : dice_.logUniform(1e-3, 0.1);
    const bool above = index > 0 && !falls_ && !fixed && dice_.chance(0.4) && extent.radius <= last_radius_;
    if (!above)
      x_ += (index > 0 ? last_radius_ + gap : 0.0) + extent.radius;
    double height = calm_ ? dice_.uniform(0.0, 1e-3) : dice_.logUniform(1e-3, 0.3);
    height += above ? top_ : 0.0;
    if (fixed)
      height += 0.1;
    top_ = height - extent.low + extent.high;
    last_radius_ = above ? last_radius_ : extent.radius;
    std::string entry = "  {\"name\": \"b" + std::to_string(index) + "\", \"urdf\": \"seed_" +
                        std::to_string(scene_.seed) + "_" + std::to_string(index) + ".urdf\", \"base\": \"" +
                        (fixed ? "fixed" : "floating") +
                        "\", \"pose\": {\"xyz\": " + list({x_, 0.0, height - extent.low}) + ", \"rpy\": " + list(rpy) +
                        "}, \"joints\": {" + joints + "}";
    if (!fixed && moves_)
      entry += ", \"velocity\": {\"linear\": " + list(dice_.vector(1.5)) +
               ", \"angular\": " + list(dice_.vector(dice_.chance(0.2) ? 30.0 : 5.0)) + "}";
    entry += ", \"hold_initial_position\": " + std::string(hold ? "true" : "false");
    if (!limp)
      entry += commands(robot);
    if (scene_.mode == SceneMode::PUSH)
      entry += ", \"wrenches\": [{\"link\": \"l0\", \"force\": " + list(dice_.vector(0.5 * robot.mass * 9.81)) +
               ", \"from\": 0.3, \"until\": 0.5}]";
    scene_.bodies.push_back(entry + "}");
    scene_.urdfs.push_back(robot.xml);
    std::move(robot.meshes.begin(), robot.meshes.end(), std::back_inserter(scene_.meshes));
  }

  /**
   * Two jaws and a block that touches both: opposing normals, any pressure between them is a self-stress. The jaws are
   * rigid or closed by an effort; the clamp floats or is fixed (two walls).
   */
  void addClamp()
  {
    const double w = dice_.logUniform(0.03, 0.3);
    const double mass = dice_.logUniform(1e-2, 1e2);
    const Eigen::Vector3d size(w, w * dice_.uniform(0.5, 1.5), w * dice_.uniform(0.3, 1.0));
    const bool rigid = dice_.chance(0.6);
    const bool fixed = dice_.chance(0.4);
    std::string xml = "<robot name='clamp'>\n" + boxLink("l0", {1.4 * w, 0.2 * w, size.z()}, mass);
    for (int side = 0; side < 2; ++side)
    {
      const double sign = side == 0 ? -1.0 : 1.0;
      const std::string name = std::to_string(side + 1);
      xml += boxLink("l" + name, {0.2 * w, size.y() + 0.02 * w, size.z()}, mass * dice_.logUniform(0.1, 10.0)) +
             "<joint name='j" + name + "' type='" + (rigid ? "fixed" : "prismatic") +
             "'><parent link='l0'/><child link='l" + name + "'/><origin xyz='" +
             text(Eigen::Vector3d(sign * 0.6 * w, -0.5 * size.y() - 0.12 * w, 0.0)) + "'/><axis xyz='" + text(-sign) +
             " 0 0'/><limit lower='-0.1' upper='0.1' effort='1e6' velocity='100'/></joint>\n";
    }
    const double height = (falls_  ? 0.0
                           : calm_ ? dice_.uniform(0.0, 1e-3)
                                   : dice_.logUniform(1e-3, 0.1)) +
                          0.5 * size.z();
    const double force = mass * 9.81 * dice_.uniform(0.5, 5.0);
    const auto entry = [&](int index, bool is_fixed, double y, const std::string& more)
    {
      return "  {\"name\": \"b" + std::to_string(index) + "\", \"urdf\": \"seed_" + std::to_string(scene_.seed) + "_" +
             std::to_string(index) + ".urdf\", \"base\": \"" + (is_fixed ? "fixed" : "floating") +
             "\", \"pose\": {\"xyz\": " + list({0.0, y, height}) + "}" + more + "}";
    };
    const std::string close = "{\"effort\": " + text(force) + "}";
    scene_.bodies.push_back(entry(0, fixed, 0.5 * size.y() + 0.12 * w,
                                  rigid ? "" : ", \"commands\": {\"j1\": " + close + ", \"j2\": " + close + "}"));
    scene_.urdfs.push_back(xml + "</robot>\n");
    scene_.bodies.push_back(entry(1, false, 0.0,
                                  scene_.mode != SceneMode::PUSH
                                      ? ""
                                      : ", \"wrenches\": [{\"link\": \"l0\", \"force\": " +
                                            list({dice_.uniform(-5.0, 5.0) * mass * 9.81, 0.0, 0.0}) +
                                            ", \"from\": 0.3, \"until\": 0.5}]"));
    scene_.urdfs.push_back("<robot name='block'>\n" + boxLink("l0", size, mass * dice_.logUniform(0.1, 10.0)) +
                           "</robot>\n");
    last_radius_ = 2.0 * w;
    top_ = 2.0 * w;
  }

  static std::string boxLink(const std::string& name, const Eigen::Vector3d& size, double mass)
  {
    const Eigen::Vector3d square = mass / 12.0 * size.cwiseAbs2();
    return "<link name='" + name + "'><inertial><origin xyz='0 0 0' rpy='0 0 0'/><mass value='" + text(mass) +
           "'/><inertia ixx='" + text(square.y() + square.z()) + "' iyy='" + text(square.x() + square.z()) + "' izz='" +
           text(square.x() + square.y()) + "' ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><box size='" +
           text(size) + "'/></geometry></collision></link>\n";
  }

  /** For some joints: effort, position or velocity, some with an effort limit. Calm robots hold. */
  std::string commands(const RandomRobot& robot)
  {
    std::string entries;
    for (const RandomJoint& joint : robot.joints)
    {
      if (!joint.single || calm_ || dice_.chance(0.5))
        continue;
      const double load = robot.mass * 9.81 * (joint.type == "prismatic" ? 1.0 : robot.size);
      const double limit = load * dice_.logUniform(0.01, 10.0);
      std::string command;
      switch (dice_.integer(0, 2))
      {
        case 0:
          command = "\"effort\": " + text(load * dice_.uniform(-1.0, 1.0));
          break;
        case 1:
          command = "\"position\": " +
                    text(joint.start + dice_.uniform(-0.5, 0.5) * (joint.type == "prismatic" ? robot.size : 1.0));
          break;
        default:
          command = "\"velocity\": " + text(dice_.uniform(-3.0, 3.0));
      }
      if (command[1] != 'e' && dice_.chance(0.5))
        command += ", \"max_effort\": " + text(limit);
      entries += std::string(entries.empty() ? "" : ", ") + "\"" + joint.name + "\": {" + command + "}";
    }
    return entries.empty() ? "" : ", \"commands\": {" + entries + "}";
  }

  Dice dice_;
  RandomScene scene_;
  bool calm_ = false, falls_ = false, moves_ = true;
  double gravity_ = 9.81, x_ = 0.0, last_radius_ = 0.0, top_ = 0.0;
};
}  // namespace

const char* toString(SceneMode mode)
{
  switch (mode)
  {
    case SceneMode::FREE_FALL:
      return "free_fall";
    case SceneMode::DROP:
      return "drop";
    case SceneMode::REST:
      return "rest";
    case SceneMode::PUSH:
      return "push";
  }
  return "unknown";
}

std::string RandomScene::name() const
{
  return "seed_" + std::to_string(seed) + "_" + toString(mode);
}

std::string RandomScene::with(int count, const std::string& more) const
{
  std::string result = head;
  for (int body = 0; body < count; ++body)
    result += (body > 0 ? ",\n" : "") + bodies[body];
  return result + (more.empty() ? "" : ",\n" + more) + "\n ]}\n";
}

RandomScene randomScene(std::uint32_t seed)
{
  return SceneWriter(seed).take();
}

std::string writeScene(const RandomScene& scene, const std::string& folder, const std::string& scenario,
                       const std::string& name)
{
  for (size_t body = 0; body < scene.urdfs.size(); ++body)
    std::ofstream(folder + "/seed_" + std::to_string(scene.seed) + "_" + std::to_string(body) + ".urdf")
        << scene.urdfs[body];
  for (const NamedMesh& mesh : scene.meshes)
    writeStl(mesh.mesh, folder + "/" + mesh.file);
  const std::string path = folder + "/" + name + ".yaml";
  std::ofstream file(path);
  file << scenario;
  file.close();
  if (!file)
    throw std::runtime_error(path + ": cannot be written");
  return path;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
