#include "frictional_contact_sim/dynamics/body.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
namespace
{
struct Reach
{
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Box& box) const { return box.half_size.norm(); }
  double operator()(const Cylinder& cylinder) const { return std::hypot(cylinder.radius, cylinder.half_length); }
  double operator()(const Capsule& capsule) const { return capsule.radius + capsule.half_length; }
  // The mesh is not loaded here; a generous value only makes the look-ahead margin larger.
  double operator()(const Mesh&) const { return 0.5; }
  double operator()(const HalfSpace&) const { return 0.0; }
};

std::vector<double> linkExtents(const MultibodyModel& model)
{
  std::vector<double> extents(model.links.size(), 0.0);
  for (const CollisionShape& shape : model.shapes)
    extents[shape.link] =
        std::max(extents[shape.link], shape.placement.translation().norm() + std::visit(Reach(), shape.geometry));
  return extents;
}

std::vector<std::vector<int>> linkChains(const MultibodyModel& model)
{
  std::vector<std::vector<int>> chains(model.links.size());
  for (size_t link = 0; link < model.joints.size(); ++link)
  {
    const Joint& joint = model.joints[link];
    if (joint.parent >= 0)
      chains[link] = chains[joint.parent];
    for (int k = 0; k < velocitySize(joint.type); ++k)
      chains[link].push_back(joint.v_index + k);
  }
  return chains;
}

[[noreturn]] void fail(const BodyModel& model, const std::string& message)
{
  throw std::invalid_argument("body '" + model.name + "': " + message);
}
}  // namespace

BodyModel::BodyModel(MultibodyModel multibody_model)
  : name(multibody_model.name)
  , tree(std::move(multibody_model))
  , damping(Eigen::VectorXd::Zero(tree.nv))
  , servo_inertia(tree.joints.size(), 0.0)
  , chains(linkChains(tree))
  , extents(linkExtents(tree))
{
  for (const Joint& joint : tree.joints)
    if (velocitySize(joint.type) == 1)
      damping[joint.v_index] = joint.damping;
}

bool BodyModel::isActuated(int joint) const
{
  return velocitySize(tree.joints[joint].type) == 1 && tree.joints[joint].mimic.joint < 0;
}

BodyState::BodyState(const BodyModel& model)
  : q(zeroPosition(model.tree))
  , v(Eigen::VectorXd::Zero(model.tree.nv))
  , base_pose(model.tree.joints.front().placement)
  , drives(model.tree.joints.size())
{
  for (size_t j = 0; j < drives.size(); ++j)
  {
    drives[j].command.kp = 0.0;
    drives[j].command.kd = 0.0;
    drives[j].effort_limit = model.tree.joints[j].limit.effort;
  }
}

Body::Body(const BodyModel& body_model, BodyState& body_state)
  : model(body_model)
  , state(body_state)
  , middle(model.tree)
  , end(model.tree)
  , q_middle(state.q)
  , v_middle(Eigen::VectorXd::Zero(model.tree.nv))
  , external(v_middle)
  , bias(v_middle)
  , implicit(v_middle)
{
}

Eigen::Isometry3d basePose(const Body& body, double dt)
{
  const BaseMotion& motion = body.model.base_motion;
  Eigen::Isometry3d pose = body.state.base_pose;
  if (!motion.active)
    return pose;
  pose.translation() = body.state.base_pose.translation() + dt * motion.linear;
  const double rate = motion.angular.norm();
  if (rate > 0.0)
    pose.linear() = Eigen::AngleAxisd(dt * rate, motion.angular / rate) * body.state.base_pose.linear();
  return pose;
}

void updateEnd(Body& body)
{
  const BaseMotion& motion = body.model.base_motion;
  body.end.base_pose = body.state.base_pose;
  forwardKinematics(body.model.tree, body.state.q, body.end);
  forwardVelocities(body.model.tree, body.state.v, body.end);
  // A moving base carries all links along; `reference` is its origin.
  if (motion.active)
    for (Vector6d& velocity : body.end.link_velocity)
    {
      velocity.head<3>() += motion.linear;
      velocity.tail<3>() += motion.angular;
    }
}

void moveToMidpoint(Body& body, double dt)
{
  integrate(body.model.tree, body.state.q, body.state.v, 0.5 * dt, body.q_middle);
  body.middle.base_pose = basePose(body, 0.5 * dt);
  forwardKinematics(body.model.tree, body.q_middle, body.middle);
  computeMassMatrix(body.model.tree, body.middle);
}

void applyWrenches(Body& body, double now)
{
  body.external.setZero();
  for (const ExternalWrench& wrench : body.state.wrenches)
  {
    if (now < wrench.from || now >= wrench.until)
      continue;
    const Frame& frame = body.model.tree.frames[wrench.frame];
    const Eigen::Isometry3d pose = body.middle.link_pose[frame.link] * frame.placement;
    const Eigen::Matrix3d axes = wrench.world_frame ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : pose.linear();
    addWrench(body.model.tree, body.middle, frame.link, pose * wrench.point, axes * wrench.force, axes * wrench.torque,
              body.external);
  }
}

void removeExpiredWrenches(Body& body, double now)
{
  std::vector<ExternalWrench>& wrenches = body.state.wrenches;
  wrenches.erase(std::remove_if(wrenches.begin(), wrenches.end(),
                                [now](const ExternalWrench& wrench) { return now >= wrench.until; }),
                 wrenches.end());
}

double servoInertia(const BodyModel& model, const MultibodyData& data, int joint)
{
  const MultibodyModel& tree = model.tree;
  const Joint& moved = tree.joints[joint];
  const double own = data.mass_matrix(moved.v_index, moved.v_index);
  if (tree.joints.front().type != JointType::FLOATING)
    return own;
  double subtree_mass = 0.0;
  double reach = 0.0;
  const Eigen::Vector3d origin = data.link_pose[joint].translation();
  for (size_t link = joint; link < tree.links.size(); ++link)
  {
    const std::vector<int>& chain = model.chains[link];
    if (!std::binary_search(chain.begin(), chain.end(), moved.v_index))
      continue;
    subtree_mass += tree.links[link].inertia.mass;
    const Eigen::Isometry3d& pose = data.link_pose[link];
    const Eigen::Vector3d center = pose * tree.links[link].inertia.center;
    reach = std::max({reach, (pose.translation() - origin).norm(), 2.0 * (center - origin).norm()});
  }
  const double rest = tree.totalMass() - subtree_mass;
  return moved.type == JointType::PRISMATIC ? own + rest : own + rest * reach * reach;
}

JointDrive makeDrive(const BodyModel& model, int joint, const JointCommand& command)
{
  const Joint& moved = model.tree.joints[joint];
  if (!model.isActuated(joint))
    fail(model, "joint '" + moved.name + "' takes no command: it " +
                    (moved.mimic.joint >= 0 ? "mimics another" : "has not exactly one coordinate"));
  const auto check = [&](const char* what, double value, bool ok)
  {
    if (!ok)
      fail(model, "command of joint '" + moved.name + "': " + what + " is " + std::to_string(value) +
                      ", expected a finite number" + (what[0] == 't' ? "" : " >= 0"));
  };
  check("target", command.target, std::isfinite(command.target));
  check("kp", command.kp, std::isnan(command.kp) || (std::isfinite(command.kp) && command.kp >= 0.0));
  check("kd", command.kd, std::isnan(command.kd) || (std::isfinite(command.kd) && command.kd >= 0.0));
  check("max_effort", command.max_effort, command.max_effort >= 0.0);
  JointDrive drive;
  drive.command = command;
  drive.effort_limit = std::min(moved.limit.effort, command.max_effort);
  if (command.mode == JointCommand::Mode::EFFORT)
  {
    drive.command.kp = 0.0;
    drive.command.kd = 0.0;
    drive.command.target = std::clamp(command.target, -drive.effort_limit, drive.effort_limit);
  }
  else
    fillDefaultGains(model.servo_inertia[joint], drive.command);
  return drive;
}

}  // namespace frictional_contact_sim
