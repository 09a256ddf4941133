#pragma once
/**
 * @file step_publisher.h
 * @brief All topics of one step: one stamp, and no work for a topic that nobody listens to.
 */
#include <ros/node_handle.h>
#include <rosgraph_msgs/Clock.h>
#include <tf2_msgs/TFMessage.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/markers.h"
#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/ros/parameters.h"

namespace frictional_contact_sim
{
/** @brief Every how many steps a topic is due. */
class StepDivider
{
public:
  /** @param rate per simulated second; 0 = every step. Rounded to a whole number of steps. */
  StepDivider(double rate, double time_step);
  bool due(std::uint64_t step) const;

private:
  std::uint64_t steps_ = 1;
};

class StepPublisher
{
public:
  StepPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node, const Simulator& simulator,
                const NameTable& names, const NodeParameters& parameters);

  void publish(double real_time_factor);
  /** @brief Only ~step_report, of a step that was not taken: nothing else has changed. */
  void publishReport(double real_time_factor);
  /** @brief Only /clock, for those who come while the simulation pauses. */
  void publishClock(double seconds);
  /** @brief Topics that a recorder gets every message of. */
  const std::set<std::string>& losslessTopics() const;
  /** @brief Subscribers of a topic of this node by resolved name. @throws ParameterError for another topic */
  std::uint32_t subscribers(const std::string& topic) const;
  StepReport report(double real_time_factor) const;

private:
  void publishOdometry(const ros::Time& stamp);
  void publishTransforms(const ros::Time& stamp);
  void publishMarkers(const ros::Time& stamp);

  const Simulator& simulator_;
  const NameTable& names_;
  StepDivider state_divider_;
  StepDivider clock_divider_;
  StepDivider tf_divider_;
  StepDivider marker_divider_;
  bool publish_base_tf_;
  double force_scale_;
  size_t arrows_ = 0;
  std::set<std::string> lossless_;

  ros::Publisher joint_states_publisher_;
  ros::Publisher contacts_publisher_;
  ros::Publisher step_report_publisher_;
  std::vector<ros::Publisher> odometry_publishers_;  // by body
  ros::Publisher markers_publisher_;
  ros::Publisher clock_publisher_;
  ros::Publisher tf_publisher_;

  // Kept from step to step for their storage.
  sensor_msgs::JointState joint_states_;
  ContactArray contacts_;
  StepReport step_report_;
  std::vector<nav_msgs::Odometry> odometry_;
  visualization_msgs::MarkerArray markers_;
  rosgraph_msgs::Clock clock_;
  tf2_msgs::TFMessage transforms_;
};

}  // namespace frictional_contact_sim
