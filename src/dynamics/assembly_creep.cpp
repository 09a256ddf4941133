// The creep law's part of a contact: rolling direction and speed, the tangent, the next Newton iterate.
#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/dynamics/assembly.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int FULL_STEPS = 6;  ///< Newton iterations before steps are halved: only curves with convex parts need more
}  // namespace

void StepAssembly::startCreep(size_t points)
{
  creep_points_.assign(points, CreepPoint{});
  creep_iterations_ = 0;
}

void StepAssembly::setCreepNormal(int point, double normal)
{
  creep_points_[point].normal = normal;
}

/** Adds the share of one side to the rolling velocity V: columns of rolling_columns_; returns that of a moving base. */
Eigen::Vector3d StepAssembly::addRollingSide(const ContactPoint& point, const ShapeInfo& shape, double weight,
                                             const Eigen::Matrix3d& spin)
{
  if (shape.robot < 0)
    return Eigen::Vector3d::Zero();
  const Robot& robot = robots_[shape.robot];
  const MultibodyData& data = robot.middle;
  const Eigen::Vector3d arm = point.position - data.reference;
  for (const int j : robot.chains[shape.body])
  {
    const auto motion = data.motion_subspace.col(j);
    const Eigen::Vector3d angular = motion.tail<3>();
    const Eigen::Vector3d linear = motion.head<3>() + angular.cross(arm);
    rolling_columns_.emplace_back(robot.v_offset + j, (weight - 0.5) * linear - weight * (spin * angular));
  }
  if (!robot.base_motion.active)
    return Eigen::Vector3d::Zero();
  return (weight - 0.5) * baseVelocity(shape, point.position) - weight * (spin * robot.base_motion.angular);
}

void StepAssembly::addCreep(const ContactPoint& point, const CreepTable& curve, const Eigen::Vector3d& velocity,
                            ContactRow& contact)
{
  const ShapeInfo& shape_a = world_.shape(point.shape_a);
  const ShapeInfo& shape_b = world_.shape(point.shape_b);
  const auto pose = [this](const ShapeInfo& shape)
  { return shape.robot < 0 ? Eigen::Isometry3d::Identity() : robots_[shape.robot].middle.body_pose[shape.body]; };
  const RollingShape& rolling_a = rolling_shapes_[point.shape_a];
  const RollingShape& rolling_b = rolling_shapes_[point.shape_b];
  bool round_a = false;
  bool round_b = false;
  const Eigen::Matrix3d spin_a = rolling_a.spin(pose(shape_a), point.position, point.normal, round_a);
  const Eigen::Matrix3d spin_b = rolling_b.spin(pose(shape_b), point.position, point.normal, round_b);
  if (!round_a && !round_b)
    return;
  const double weight_a = !round_b ? 1.0 : !round_a ? 0.0 : rolling_b.radius / (rolling_a.radius + rolling_b.radius);

  rolling_columns_.clear();
  Eigen::Vector3d base = addRollingSide(point, shape_a, weight_a, spin_a);
  base += addRollingSide(point, shape_b, 1.0 - weight_a, spin_b);
  Eigen::Vector3d rolling = base;
  for (const auto& [column, motion] : rolling_columns_)
    rolling += v_old_[column] * motion;
  rolling -= point.normal.dot(rolling) * point.normal;
  const double speed = rolling.norm();
  if (!(speed >= ROLLING_SPEED))
    return;

  contact.tangent_1 = rolling / speed;
  contact.tangent_2 = point.normal.cross(contact.tangent_1);
  for (const auto& [column, motion] : rolling_columns_)
    rolling_rows_.push(column, contact.tangent_1.dot(motion));
  rolling_rows_.endRow();
  CreepPoint& at = creep_points_[contact.point];
  if (!at.known)
  {
    at.slip = contact.tangent_1.dot(velocity);
    at.speed = speed;
  }
  contact.creep = creepTangent(curve, contact.friction, at);
  creep_contacts_.push_back({static_cast<int>(contact_rows_.size()), &curve, contact.tangent_1.dot(base)});
}

bool StepAssembly::updateCreep(const Solution& solution, double tolerance)
{
  bool again = false;
  ++creep_iterations_;
  for (size_t i = 0; i < creep_contacts_.size(); ++i)
  {
    const CreepContact& creep = creep_contacts_[i];
    const ContactRow& contact = contact_rows_[creep.contact];
    CreepPoint& at = creep_points_[contact.point];
    const double last_slip = at.slip;
    const double traction = -solution.r[contact.row + 1];
    at.known = true;
    at.normal = solution.r[contact.row];
    at.slip = solution.u[contact.row + 1] + contact.creep.compliance * traction - contact.creep.offset;
    at.speed = std::max(std::abs(rolling_rows_.dot(static_cast<int>(i), solution.v) + creep.base_speed), ROLLING_SPEED);
    // What was solved with against the law; where the cone cuts both off, they agree.
    const double limit = contact.friction * std::max(at.normal, 0.0);
    const double solved = contact.creep.compliance > 0.0
                              ? std::clamp((at.slip + contact.creep.offset) / contact.creep.compliance, -limit, limit)
                              : traction;
    again = again || std::abs(solved - creepTraction(*creep.curve, contact.friction, at)) > tolerance * limit;
    if (creep_iterations_ > FULL_STEPS)
      at.slip = 0.5 * (at.slip + last_slip);
  }
  return again;
}

}  // namespace frictional_contact_sim
