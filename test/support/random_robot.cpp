#include "support/random_robot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <regex>

#include "frictional_contact_sim/model/kinematics.h"
#include "support/convex_solid.h"

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
constexpr double PI = 3.14159265358979323846;
constexpr double MESH_SHARE = 0.7;  ///< of the shapes of a robot with meshes

class RobotWriter
{
public:
  RobotWriter(Dice& dice, const std::string& mesh_prefix) : dice_(dice), mesh_prefix_(mesh_prefix)
  {
    count_ = dice.chance(0.3) ? 1 : dice.chance(0.7) ? dice.integer(2, 8) : dice.integer(9, 25);
    size_ = dice.logUniform(0.03, 0.3);
    mass_ = dice.logUniform(1e-3, 1e3);
    spread_ = dice.chance(0.3) ? 30.0 : 3.0;
    for (int i = 0; i < count_; ++i)
      addLink(i);
    xml_ = "<robot name='random'>\n" + links_ + joints_ + "</robot>\n";
  }

  RandomRobot take() const { return {xml_, size_, total_, list_, meshes_}; }

private:
  void addLink(int index)
  {
    const double mass = mass_ * dice_.logUniform(1.0 / spread_, spread_);
    const double scale = size_ * dice_.logUniform(0.5, 1.5);
    total_ += mass;
    // Second moments a, b, c >= 0 give I = (b + c, a + c, a + b): the triangle inequality holds.
    const Eigen::Vector3d moments =
        mass * scale * scale *
        Eigen::Vector3d(dice_.logUniform(0.02, 0.3), dice_.logUniform(0.02, 0.3), dice_.logUniform(0.02, 0.3));
    const Eigen::Vector3d center =
        dice_.chance(0.5) ? Eigen::Vector3d(dice_.vector(0.4 * scale)) : Eigen::Vector3d::Zero();
    links_ += "<link name='l" + std::to_string(index) + "'><inertial><origin xyz='" + text(center) + "' rpy='" +
              text(dice_.vector(PI)) + "'/><mass value='" + text(mass) + "'/><inertia ixx='" +
              text(moments.y() + moments.z()) + "' iyy='" + text(moments.x() + moments.z()) + "' izz='" +
              text(moments.x() + moments.y()) + "' ixy='0' ixz='0' iyz='0'/></inertial>";
    if (index == 0 || dice_.chance(0.8))
      links_ += "<collision><origin rpy='" + text(dice_.vector(dice_.chance(0.5) ? PI : 0.0)) + "'/><geometry>" +
                shape(index, scale) + "</geometry></collision>";
    links_ += "</link>\n";
    if (index > 0)
      addJoint(index, mass, scale);
  }

  std::string shape(int index, double scale)
  {
    if (!mesh_prefix_.empty() && dice_.chance(MESH_SHARE))
      return mesh(index, scale);
    switch (dice_.integer(0, 3))
    {
      case 0:
        return "<box size='" + text(scale * dice_.logUniform(0.3, 1.5)) + " " +
               text(scale * dice_.logUniform(0.3, 1.5)) + " " + text(scale * dice_.logUniform(0.3, 1.5)) + "'/>";
      case 1:
        return "<sphere radius='" + text(scale * dice_.logUniform(0.2, 0.7)) + "'/>";
      case 2:
        return "<cylinder radius='" + text(scale * dice_.logUniform(0.2, 0.6)) + "' length='" +
               text(scale * dice_.logUniform(0.3, 1.5)) + "'/>";
      default:
        return "<capsule radius='" + text(scale * dice_.logUniform(0.2, 0.4)) + "' length='" +
               text(scale * dice_.logUniform(0.3, 1.5)) + "'/>";
    }
  }

  std::string mesh(int index, double scale)
  {
    const auto kind = static_cast<MeshKind>(dice_.integer(0, static_cast<int>(MeshKind::KINDS) - 1));
    const std::string name = "l" + std::to_string(index);
    meshes_.push_back(
        {mesh_prefix_ + name + ".stl", name, makeRandomMesh(kind, scale * dice_.logUniform(0.3, 1.0), dice_)});
    return "<mesh filename='" + meshes_.back().file + "'/>";
  }

  static std::string pick(double x)
  {
    return x < 0.35   ? "revolute"
           : x < 0.5  ? "continuous"
           : x < 0.67 ? "prismatic"
           : x < 0.75 ? "planar"
           : x < 0.8  ? "floating"
                      : "fixed";
  }

  void addJoint(int index, double mass, double scale)
  {
    RandomJoint joint;
    joint.name = "j" + std::to_string(index);
    joint.parent = dice_.chance(0.6) ? index - 1 : dice_.integer(0, index - 1);
    joint.type = pick(dice_.uniform(0.0, 1.0));
    const bool slides = joint.type == "prismatic";
    const bool single = slides || joint.type == "revolute" || joint.type == "continuous";
    Eigen::Vector3d axis = dice_.vector(1.0);
    if (axis.norm() < 0.1 || dice_.chance(0.5))
      axis = Eigen::Vector3d::Unit(dice_.integer(0, 2));
    joints_ += "<joint name='" + joint.name + "' type='" + joint.type + "'><parent link='l" +
               std::to_string(joint.parent) + "'/><child link='l" + std::to_string(index) + "'/><origin xyz='" +
               text(dice_.vector(scale)) + "' rpy='" + text(dice_.vector(dice_.chance(0.5) ? PI : 0.0)) + "'/>";
    if (joint.type != "fixed" && joint.type != "floating")
      joints_ += "<axis xyz='" + text(Eigen::Vector3d(axis.normalized())) + "'/>";
    const int leader = single ? findLeader() : -1;
    joint.single = single && leader < 0;
    if (leader >= 0)
      joints_ += "<mimic joint='" + list_[leader].name + "' multiplier='" +
                 text(dice_.uniform(0.3, 1.5) * (dice_.chance(0.5) ? 1.0 : -1.0)) + "' offset='" +
                 text(dice_.chance(0.5) ? 0.0 : dice_.uniform(-0.3, 0.3)) + "'/>";
    if (joint.type == "revolute" || slides)
      addLimit(joint, slides ? scale : 1.0, mass, leader >= 0);
    if (single && dice_.chance(0.5))
    {
      const double arm = slides ? 1.0 : scale;
      joints_ += "<dynamics damping='" +
                 text(dice_.chance(0.5) ? mass * arm * arm * dice_.logUniform(0.01, 10.0) : 0.0) + "' friction='" +
                 text(dice_.chance(0.5) ? mass * 9.81 * arm * dice_.logUniform(1e-3, 1.0) : 0.0) + "'/>";
    }
    joints_ += "</joint>\n";
    list_.push_back(joint);
    followers_.push_back(leader);
    depth_.push_back(leader >= 0 ? depth_[leader] + 1 : 0);
  }

  /** A joint of one coordinate to follow, itself a follower now and then; -1: none. */
  int findLeader()
  {
    if (list_.empty() || !dice_.chance(0.2))
      return -1;
    const int leader = dice_.integer(0, static_cast<int>(list_.size()) - 1);
    const std::string& type = list_[leader].type;
    const bool single = type == "revolute" || type == "continuous" || type == "prismatic";
    return single && depth_[leader] < 3 ? leader : -1;
  }

  void addLimit(RandomJoint& joint, double unit, double mass, bool follows)
  {
    joint.limited = true;
    if (!follows)  // where a follower ends is its leader's business
    {
      joint.lower = unit * dice_.uniform(-1.5, 0.3);
      joint.upper = joint.lower + unit * dice_.logUniform(0.02, 2.5);
    }
    joint.start = dice_.chance(0.2)   ? joint.lower
                  : dice_.chance(0.1) ? joint.upper
                                      : dice_.uniform(joint.lower, joint.upper);
    const double effort = dice_.chance(0.3) ? mass * 9.81 * unit * dice_.logUniform(0.1, 10.0) : 1e4 * total_;
    joints_ += "<limit lower='" + text(joint.lower) + "' upper='" + text(joint.upper) + "' effort='" + text(effort) +
               "' velocity='1000'/>";
  }

  Dice& dice_;
  std::string mesh_prefix_;  ///< of file names; empty: no meshes
  int count_;
  double size_, mass_, spread_, total_ = 0.0;
  std::string xml_, links_, joints_;
  std::vector<RandomJoint> list_;
  std::vector<int> followers_, depth_;
  std::vector<NamedMesh> meshes_;
};

/** Vertices of the mesh of a shape; none where it is no mesh. */
std::vector<Eigen::Vector3d> verticesOf(const RandomRobot& robot, const std::string& frame)
{
  for (const NamedMesh& named : robot.meshes)
    if (named.frame == frame)
      return named.mesh.vertices;
  return {};
}
}  // namespace

RandomRobot randomRobot(Dice& dice, const std::string& mesh_prefix)
{
  return RobotWriter(dice, mesh_prefix).take();
}

Extent extentOf(const RandomRobot& robot, BaseType base, const Eigen::Vector3d& rpy)
{
  const std::vector<RandomJoint>& joints = robot.joints;
  // Spheres stand in for meshes, which are no files yet.
  const std::string xml = std::regex_replace(robot.xml, std::regex("<mesh [^>]*>"), "<sphere radius='1'/>");
  const MultibodyModel model = loadUrdf(xml, "random", base).model;
  Eigen::VectorXd q = zeroPosition(model);
  for (size_t i = 0; i < joints.size(); ++i)
    if (joints[i].single)
      q[model.joints[model.findJoint(joints[i].name)].q_index] = joints[i].start;
  for (const Joint& joint : model.joints)  // leaders come earlier in the text and so in the tree's names
    if (joint.mimic.joint >= 0)
      for (int round = 0; round < 4; ++round)
        for (const Joint& follower : model.joints)
          if (follower.mimic.joint >= 0)
            q[follower.q_index] =
                follower.mimic.multiplier * q[model.joints[follower.mimic.joint].q_index] + follower.mimic.offset;
  MultibodyData data(model);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  if (model.joints.front().type == JointType::FLOATING)
    q.segment<4>(3) = Eigen::Quaterniond(pose.linear()).coeffs();
  else
    data.base_pose = pose;
  forwardKinematics(model, q, data);
  Extent extent;
  for (const CollisionShape& shape : model.shapes)
  {
    const std::vector<Eigen::Vector3d> vertices = verticesOf(robot, model.frames[shape.frame].name);
    const ConvexSolid solid = vertices.empty() ? ConvexSolid(shape.geometry) : ConvexSolid(vertices);
    const Eigen::Isometry3d at = data.link_pose[shape.link] * shape.placement;
    const Eigen::Vector3d up = at.linear().row(2).transpose();
    extent.low = std::min(extent.low, at.translation().z() - solid.reachAgainst(up));
    extent.high = std::max(extent.high, at.translation().z() + solid.reachAgainst(-up));
    extent.radius = std::max(extent.radius, (at * solid.center).head<2>().norm() + solid.radius);
  }
  return extent;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
