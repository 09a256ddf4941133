#pragma once
// Fields of requests, checked: finite, and within what a scenario file may say too. Errors name the field.
#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3.h>

#include <Eigen/Geometry>
#include <string>
#include <utility>

namespace frictional_contact_sim
{
constexpr double LARGEST_COORDINATE = 3e7;  ///< [m]: doubles still have a nanometre there
constexpr double LARGEST_SPEED = 1e6;  ///< [m/s] or [rad/s]
constexpr double LARGEST_FORCE = 1e9;  ///< [N] or [N m]

/** @throws RequestError unless |value| <= largest, which NaN is not either */
void requireWithin(const std::string& field, double value, double largest, const std::string& unit);

Eigen::Vector3d readPoint(const std::string& field, const geometry_msgs::Point& point);
Eigen::Vector3d readVector(const std::string& field, const geometry_msgs::Vector3& vector, double largest,
                           const std::string& unit);
/** The quaternion has unit length within 1e-3, and is normalised. */
Eigen::Isometry3d readPose(const std::string& field, const geometry_msgs::Pose& pose);

geometry_msgs::Pose toMessage(const Eigen::Isometry3d& pose);
geometry_msgs::Twist toMessage(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular);

}  // namespace frictional_contact_sim
