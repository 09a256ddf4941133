#include "frictional_contact_sim/dynamics/robot.h"

#include <algorithm>
#include <cmath>
#include <variant>

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

std::vector<double> bodyExtents(const MultibodyModel& model)
{
  std::vector<double> extents(model.bodies.size(), 0.0);
  for (const CollisionShape& shape : model.shapes)
    extents[shape.body] =
        std::max(extents[shape.body], shape.placement.translation().norm() + std::visit(Reach(), shape.geometry));
  return extents;
}

std::vector<std::vector<int>> bodyChains(const MultibodyModel& model)
{
  std::vector<std::vector<int>> chains(model.bodies.size());
  for (size_t body = 0; body < model.joints.size(); ++body)
  {
    const Joint& joint = model.joints[body];
    if (joint.parent >= 0)
      chains[body] = chains[joint.parent];
    for (int k = 0; k < velocitySize(joint.type); ++k)
      chains[body].push_back(joint.v_index + k);
  }
  return chains;
}
}  // namespace

Robot::Robot(MultibodyModel multibody_model)
  : name(multibody_model.name)
  , model(std::move(multibody_model))
  , middle(model)
  , end(model)
  , q(zeroPosition(model))
  , v(Eigen::VectorXd::Zero(model.nv))
  , q_middle(q)
  , v_middle(v)
  , external(v)
  , bias(v)
  , implicit(v)
  , damping(v)
  , actuators(model.joints.size())
  , servo_inertia(model.joints.size(), 0.0)
  , chains(bodyChains(model))
  , extents(bodyExtents(model))
  , base_pose(model.joints.front().placement)
{
  for (size_t j = 0; j < model.joints.size(); ++j)
  {
    const Joint& joint = model.joints[j];
    actuators[j].effort_limit = joint.limit.effort;
    if (velocitySize(joint.type) == 1)
      damping[joint.v_index] = joint.damping;
  }
}

bool Robot::isActuated(int joint) const
{
  return velocitySize(model.joints[joint].type) == 1 && model.joints[joint].mimic.joint < 0;
}

void placeBase(Robot& robot, double dt)
{
  if (!robot.base_motion.active)
    return;
  Eigen::Isometry3d& placement = robot.model.joints.front().placement;
  placement.translation() = robot.base_pose.translation() + dt * robot.base_motion.linear;
  const double rate = robot.base_motion.angular.norm();
  if (rate > 0.0)
    placement.linear() = Eigen::AngleAxisd(dt * rate, robot.base_motion.angular / rate) * robot.base_pose.linear();
}

double servoInertia(const Robot& robot, const MultibodyData& data, int joint)
{
  const Joint& moved = robot.model.joints[joint];
  const double own = data.mass_matrix(moved.v_index, moved.v_index);
  if (robot.model.joints.front().type != JointType::FLOATING)
    return own;
  double subtree_mass = 0.0;
  double reach = 0.0;
  const Eigen::Vector3d origin = data.body_pose[joint].translation();
  for (size_t body = joint; body < robot.model.bodies.size(); ++body)
  {
    const std::vector<int>& chain = robot.chains[body];
    if (!std::binary_search(chain.begin(), chain.end(), moved.v_index))
      continue;
    subtree_mass += robot.model.bodies[body].inertia.mass;
    const Eigen::Isometry3d& pose = data.body_pose[body];
    const Eigen::Vector3d center = pose * robot.model.bodies[body].inertia.center;
    reach = std::max({reach, (pose.translation() - origin).norm(), 2.0 * (center - origin).norm()});
  }
  const double rest = robot.model.totalMass() - subtree_mass;
  return moved.type == JointType::PRISMATIC ? own + rest : own + rest * reach * reach;
}

}  // namespace frictional_contact_sim
