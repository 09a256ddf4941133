#include "frictional_contact_sim/dynamics/creep_law.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/math/cross_matrix.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double FLATTEST = 1e-3;  ///< smallest slope of a tangent, relative to the mean slope of the table
constexpr double ON_ITS_SIDE = 0.5;  ///< |cosine| between a cylinder's axis and the normal below which it rolls

/** Index of the entry that ends the segment of xi, from 1. */
size_t segmentEnd(const std::vector<double>& creepage, double xi)
{
  const auto entry = std::lower_bound(creepage.begin() + 1, creepage.end() - 1, xi);
  return static_cast<size_t>(entry - creepage.begin());
}
}  // namespace

double CreepTable::value(double xi) const
{
  if (xi >= creepage.back())
    return 1.0;
  const size_t end = segmentEnd(creepage, xi);
  const double part = (xi - creepage[end - 1]) / (creepage[end] - creepage[end - 1]);
  return traction[end - 1] + part * (traction[end] - traction[end - 1]);
}

double CreepTable::slope(double xi) const
{
  const size_t end = segmentEnd(creepage, xi);
  return std::max((traction[end] - traction[end - 1]) / (creepage[end] - creepage[end - 1]),
                  FLATTEST / creepage.back());
}

double creepTraction(const CreepTable& curve, double friction, const CreepPoint& at)
{
  return std::copysign(friction * std::max(at.normal, 0.0) * curve.value(std::abs(at.slip) / at.speed), at.slip);
}

CreepTangent creepTangent(const CreepTable& curve, double friction, const CreepPoint& at)
{
  CreepTangent tangent;
  const double limit = friction * at.normal;
  if (!(limit > 0.0) || !(at.speed >= ROLLING_SPEED))
    return tangent;
  // Beyond the table the cone is what counts; its last segment is right on the way back.
  const double xi = std::min(std::abs(at.slip) / at.speed, curve.creepage.back());
  tangent.compliance = at.speed / (limit * curve.slope(xi));
  tangent.offset = std::copysign(1.0, at.slip) * (tangent.compliance * limit * curve.value(xi) - xi * at.speed);
  return tangent;
}

RollingShape::RollingShape(const CollisionShape& shape) : placement(shape.placement)
{
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
  {
    kind = Kind::SPHERE;
    radius = sphere->radius;
  }
  else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry))
  {
    kind = Kind::CYLINDER;
    radius = cylinder->radius;
    half_length = cylinder->half_length;
  }
  else if (const auto* capsule = std::get_if<Capsule>(&shape.geometry))
  {
    kind = Kind::CAPSULE;
    radius = capsule->radius;
    half_length = capsule->half_length;
  }
}

Eigen::Matrix3d RollingShape::spin(const Eigen::Isometry3d& link_pose, const Eigen::Vector3d& position,
                                   const Eigen::Vector3d& normal, bool& round) const
{
  round = kind != Kind::FLAT;
  if (!round)
    return Eigen::Matrix3d::Zero();
  const Eigen::Isometry3d pose = link_pose * placement;
  const Eigen::Vector3d axis = pose.linear().col(2);
  const Eigen::Vector3d arm = position - pose.translation();
  if (kind == Kind::SPHERE)
    return -crossMatrix(arm);
  const double along = axis.dot(arm);
  if (kind == Kind::CAPSULE && std::abs(along) > half_length)
    return -crossMatrix(arm - std::copysign(half_length, along) * axis);
  if (kind == Kind::CYLINDER && std::abs(axis.dot(normal)) >= ON_ITS_SIDE)
  {
    round = false;
    return Eigen::Matrix3d::Zero();
  }
  return axis.cross(arm) * axis.transpose();
}

}  // namespace frictional_contact_sim
