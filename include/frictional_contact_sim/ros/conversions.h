#pragma once
/**
 * @file conversions.h
 * @brief Simulator state to messages: pure functions. Messages are reused from step to step, so that their strings and
 * arrays are allocated once.
 *
 * Everything is in the world frame except Odometry's twist, which nav_msgs wants in the child frame.
 */
#include <frictional_contact_sim/ContactArray.h>
#include <frictional_contact_sim/StepReport.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/JointState.h>

#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
extern const char* const WORLD_FRAME;

/** @brief Simulated seconds to a stamp, rounded to nanoseconds. */
ros::Time toStamp(double seconds);

/** @brief What an impulse is divided by to be published as a force [s]: the last step's, before it the next one's. */
double impulseTime(const Simulator& simulator);

void fillJointState(const Simulator& simulator, const NameTable& names, const ros::Time& stamp,
                    sensor_msgs::JointState& message);
void fillContacts(const Simulator& simulator, const NameTable& names, const ros::Time& stamp, ContactArray& message);
void fillPose(const Eigen::Isometry3d& pose, geometry_msgs::Pose& message);
/** @brief Of one URDF link, which is side a of each: force and normal are on the link. */
void fillLinkContacts(const Simulator& simulator, const NameTable& names, int body, int frame, const ros::Time& stamp,
                      ContactArray& message);
/** @param wrench (force; torque) in the axes of the frame [N], [N m] */
void fillWrench(const Vector6d& wrench, const std::string& frame_id, const ros::Time& stamp,
                geometry_msgs::WrenchStamped& message);
/** @brief existence and uniqueness are NOT_CHECKED in a step that was not asked for them (~certify_every). */
void fillStepReport(const StepSummary& summary, double real_time_factor, const ros::Time& stamp, StepReport& message);
/** @brief Pose and velocity of the root link of a body. */
void fillOdometry(const Simulator& simulator, const NameTable& names, int body, const ros::Time& stamp,
                  nav_msgs::Odometry& message);
void fillTransform(const Eigen::Isometry3d& pose, geometry_msgs::Transform& message);
void fillVector(const Eigen::Vector3d& source, geometry_msgs::Vector3& target);
geometry_msgs::Point toPoint(const Eigen::Vector3d& source);
/** @brief CERTIFIED, REFUTED or UNDECIDED of StepReport; the same numbers in CertificateReport and Certify. */
std::uint8_t toMessage(Existence existence);
std::uint8_t toMessage(Uniqueness uniqueness);

}  // namespace frictional_contact_sim
