#include "frictional_contact_sim/dynamics/creep_rows.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr int FULL_STEPS = 6;  ///< Newton iterations before steps are halved: only curves with convex parts need more
constexpr int MOST_ITERATIONS = 40;  ///< in a step; two are usual
}  // namespace

CreepRows::CreepRows(const std::vector<Body>& bodies, const CollisionWorld& world) : bodies_(bodies), world_(world)
{
  for (int handle = 0; handle < world.shapeCount(); ++handle)
  {
    const ShapeInfo& shape = world.shape(handle);
    shapes_.push_back(shape.body < 0 ? RollingShape()
                                     : RollingShape(bodies[shape.body].model.tree.shapes[shape.index]));
  }
}

void CreepRows::begin(const StepContext&)
{
  points_.clear();
  iterations_ = 0;
}

/** Where the curve of a contact was linearised last in this step; of a new one, nowhere yet. */
CreepPoint& CreepRows::pointOf(const ContactId& id)
{
  const auto found = std::lower_bound(points_.begin(), points_.end(), id,
                                      [](const auto& a, const ContactId& b) { return a.first < b; });
  if (found != points_.end() && found->first == id)
    return found->second;
  return points_.insert(found, {id, CreepPoint{}})->second;
}

void CreepRows::clear()
{
  bent_.clear();
  rolling_rows_.clear();
}

/** Adds the share of one side to the rolling velocity V: columns of columns_; returns that of a moving base. */
Eigen::Vector3d CreepRows::addRollingSide(const ContactPoint& point, const ShapeInfo& shape, double weight,
                                          const Eigen::Matrix3d& spin)
{
  if (shape.body < 0)
    return Eigen::Vector3d::Zero();
  const Body& body = bodies_[shape.body];
  const MultibodyData& data = body.middle;
  const Eigen::Vector3d arm = point.position - data.reference;
  for (const int j : body.model.chains[shape.link])
  {
    const auto motion = data.motion_subspace.col(j);
    const Eigen::Vector3d angular = motion.tail<3>();
    const Eigen::Vector3d linear = motion.head<3>() + angular.cross(arm);
    columns_.emplace_back(body.v_offset + j, (weight - 0.5) * linear - weight * (spin * angular));
  }
  if (!body.model.base_motion.active)
    return Eigen::Vector3d::Zero();
  return (weight - 0.5) * baseVelocity(bodies_, shape, point.position) - weight * (spin * body.base.angular);
}

void CreepRows::bend(const StepContext& context, const CreepTable& curve, const Eigen::Vector3d& velocity,
                     const ContactState* last, ContactRow& contact)
{
  const ContactPoint& point = (*context.points)[contact.point];
  const ShapeInfo& shape_a = world_.shape(point.shape_a);
  const ShapeInfo& shape_b = world_.shape(point.shape_b);
  const auto pose = [this](const ShapeInfo& shape)
  { return shape.body < 0 ? Eigen::Isometry3d::Identity() : bodies_[shape.body].middle.link_pose[shape.link]; };
  const RollingShape& rolling_a = shapes_[point.shape_a];
  const RollingShape& rolling_b = shapes_[point.shape_b];
  bool round_a = false;
  bool round_b = false;
  const Eigen::Matrix3d spin_a = rolling_a.spin(pose(shape_a), point.position, point.normal, round_a);
  const Eigen::Matrix3d spin_b = rolling_b.spin(pose(shape_b), point.position, point.normal, round_b);
  if (!round_a && !round_b)
    return;
  const double weight_a = !round_b ? 1.0 : !round_a ? 0.0 : rolling_b.radius / (rolling_a.radius + rolling_b.radius);

  columns_.clear();
  Eigen::Vector3d base = addRollingSide(point, shape_a, weight_a, spin_a);
  base += addRollingSide(point, shape_b, 1.0 - weight_a, spin_b);
  Eigen::Vector3d rolling = base;
  for (const auto& [column, motion] : columns_)
    rolling += (*context.v_old)[column] * motion;
  rolling -= point.normal.dot(rolling) * point.normal;
  const double speed = rolling.norm();
  if (!(speed >= ROLLING_SPEED))
    return;

  contact.tangent_1 = rolling / speed;
  contact.tangent_2 = point.normal.cross(contact.tangent_1);
  for (const auto& [column, motion] : columns_)
    rolling_rows_.push(column, contact.tangent_1.dot(motion));
  rolling_rows_.endRow();
  CreepPoint& at = pointOf(point.id);
  if (!at.known)
  {
    at.slip = contact.tangent_1.dot(velocity);
    at.normal = last == nullptr ? 0.0 : std::max(0.0, point.normal.dot(last->impulse));
    at.speed = speed;
  }
  contact.creep = creepTangent(curve, contact.friction, at);
  bent_.push_back({point.id, contact.row, contact.friction, contact.creep, &curve, contact.tangent_1.dot(base)});
}

/** Moves the linearisation to the solution; solve again where the tangents missed the law there. */
Again CreepRows::again(const StepContext& context, const Solution& solution, bool converged)
{
  if (!converged)
    return Again::NO;
  bool missed = false;
  ++iterations_;
  for (size_t i = 0; i < bent_.size(); ++i)
  {
    const Bent& contact = bent_[i];
    CreepPoint& at = pointOf(contact.id);
    const double last_slip = at.slip;
    const double traction = -solution.r[contact.row + 1];
    const double compliance = contact.tangent.compliance;
    at.known = true;
    at.normal = solution.r[contact.row];
    at.slip = solution.u[contact.row + 1] + compliance * traction - contact.tangent.offset;
    at.speed =
        std::max(std::abs(rolling_rows_.dot(static_cast<int>(i), solution.v) + contact.base_speed), ROLLING_SPEED);
    // What was solved with against the law; where the cone cuts both off, they agree.
    const double limit = contact.friction * std::max(at.normal, 0.0);
    const double solved =
        compliance > 0.0 ? std::clamp((at.slip + contact.tangent.offset) / compliance, -limit, limit) : traction;
    missed =
        missed || std::abs(solved - creepTraction(*contact.curve, contact.friction, at)) > context.tolerance * limit;
    if (iterations_ > FULL_STEPS)
      at.slip = 0.5 * (at.slip + last_slip);
  }
  if (!missed)
    return Again::NO;
  return iterations_ < MOST_ITERATIONS ? Again::FROM_ANSWER : Again::NEVER;
}

}  // namespace frictional_contact_sim
