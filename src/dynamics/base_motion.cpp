#include "frictional_contact_sim/dynamics/base_motion.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr double TWO_PI = 6.283185307179586;

Eigen::Isometry3d tablePose(const BaseMotion& motion, double time)
{
  const std::vector<double>& times = motion.times;
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  const auto last = static_cast<size_t>(after - times.begin());
  const size_t next = std::min(last, times.size() - 1);
  const size_t before = last == 0 ? 0 : last - 1;
  const double share = next == before ? 0.0 : (time - times[before]) / (times[next] - times[before]);
  Eigen::Isometry3d pose = motion.start;
  pose.translation() += (1.0 - share) * motion.displacements[before] + share * motion.displacements[next];
  if (!motion.turns.empty())
    pose.linear() = motion.turns[before].slerp(share, motion.turns[next]).toRotationMatrix() * motion.start.linear();
  return pose;
}
}  // namespace

Eigen::Isometry3d programPose(const BaseMotion& motion, double time)
{
  if (motion.type == BaseMotion::Type::TABLE)
    return tablePose(motion, time);
  Eigen::Isometry3d pose = motion.start;
  pose.translation() += motion.amplitude * std::sin(TWO_PI * motion.frequency * time + motion.phase) * motion.axis;
  return pose;
}

Eigen::Matrix3d instantTurn(const Eigen::Vector3d& angular)
{
  Eigen::Matrix3d turn;
  turn << 0.0, -angular.z(), angular.y(), angular.z(), 0.0, -angular.x(), -angular.y(), angular.x(), 0.0;
  return turn;
}

Eigen::Matrix3d chordTurn(const Eigen::Vector3d& angular, double dt)
{
  const Eigen::Matrix3d turn = instantTurn(angular);
  const double angle = dt * angular.norm();
  if (angle < 1e-12)
    return turn;
  const double half = std::sin(0.5 * angle);
  return std::sin(angle) / angle * turn + 2.0 * half * half / (angle * angle) * dt * (turn * turn);
}

Eigen::Vector3d rotationBetween(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to)
{
  Eigen::Quaterniond turn(Eigen::Matrix3d(to * from.transpose()));
  if (turn.w() < 0.0)
    turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  return (sine > 0.0 ? 2.0 * std::atan2(sine, turn.w()) / sine : 2.0) * turn.vec();
}

}  // namespace frictional_contact_sim
