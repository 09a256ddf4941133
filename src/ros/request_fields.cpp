#include "request_fields.h"

#include <cmath>

#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/ros/services.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double UNIT_LENGTH_ERROR = 1e-3;  // of a quaternion: what a few printed digits leave

Eigen::Vector3d readComponents(const std::string& field, const Eigen::Vector3d& vector, double largest,
                               const std::string& unit)
{
  for (int i = 0; i < 3; ++i)
    requireWithin(field + "." + "xyz"[i], vector[i], largest, unit);
  return vector;
}

template <typename Message>
void fill(const Eigen::Vector3d& source, Message& target)
{
  target.x = source.x();
  target.y = source.y();
  target.z = source.z();
}
}  // namespace

void requireWithin(const std::string& field, double value, double largest, const std::string& unit)
{
  if (!(std::abs(value) <= largest))
    throw RequestError(field + ": found " + numberText(value) + ", expected a finite number within " +
                       numberText(largest) + " " + unit);
}

Eigen::Vector3d readPoint(const std::string& field, const geometry_msgs::Point& point)
{
  return readComponents(field, {point.x, point.y, point.z}, LARGEST_COORDINATE, "m");
}

Eigen::Vector3d readVector(const std::string& field, const geometry_msgs::Vector3& vector, double largest,
                           const std::string& unit)
{
  return readComponents(field, {vector.x, vector.y, vector.z}, largest, unit);
}

Eigen::Isometry3d readPose(const std::string& field, const geometry_msgs::Pose& pose)
{
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = readPoint(field + ".position", pose.position);
  const geometry_msgs::Quaternion& q = pose.orientation;
  const Eigen::Quaterniond quaternion(q.w, q.x, q.y, q.z);
  if (!(std::abs(quaternion.norm() - 1.0) <= UNIT_LENGTH_ERROR))
    throw RequestError(field + ".orientation: found a quaternion of length " + numberText(quaternion.norm()) +
                       ", expected 1");
  result.linear() = quaternion.normalized().toRotationMatrix();
  return result;
}

geometry_msgs::Pose toMessage(const Eigen::Isometry3d& pose)
{
  geometry_msgs::Pose message;
  fill(pose.translation(), message.position);
  const Eigen::Quaterniond quaternion(pose.linear());
  message.orientation.x = quaternion.x();
  message.orientation.y = quaternion.y();
  message.orientation.z = quaternion.z();
  message.orientation.w = quaternion.w();
  return message;
}

geometry_msgs::Twist toMessage(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular)
{
  geometry_msgs::Twist message;
  fill(linear, message.linear);
  fill(angular, message.angular);
  return message;
}

}  // namespace frictional_contact_sim
