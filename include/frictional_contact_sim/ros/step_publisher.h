#pragma once
/**
 * @file step_publisher.h
 * @brief All topics of one step: one stamp, and no work for a topic that nobody listens to.
 */
#include <frictional_contact_sim/Bodies.h>
#include <ros/node_handle.h>
#include <rosgraph_msgs/Clock.h>
#include <tf2_msgs/TFMessage.h>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/body_joint_publisher.h"
#include "frictional_contact_sim/ros/body_markers.h"
#include "frictional_contact_sim/ros/certificates.h"
#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/link_publisher.h"
#include "frictional_contact_sim/ros/markers.h"
#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/ros/parameters.h"
#include "frictional_contact_sim/ros/sensor_publisher.h"
#include "frictional_contact_sim/ros/step_divider.h"
#include "frictional_contact_sim/ros/transform_publisher.h"

namespace frictional_contact_sim
{
class StepPublisher
{
public:
  StepPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node, const Simulator& simulator,
                const NameTable& names, const NameRules& rules, const NodeParameters& parameters);
  StepPublisher(const StepPublisher&) = delete;
  StepPublisher& operator=(const StepPublisher&) = delete;
  /** @brief The bodies are others, and this takes the place of `before`: stamps go on, old pictures are deleted. */
  void takeOver(StepPublisher& before);

  /** @brief What is due of the step just taken. */
  void publish(double real_time_factor);
  /** @brief What was not due of the last step, when nothing moves on: the picture is of the present state. */
  void publishRest();
  /**
   * @brief The state without a step, after a reset or a set: everything but the clock and the report. It gets a
   * stamp of its own, at least a nanosecond after the last one, since tf takes no second transform with the same.
   */
  void publishState();
  /** @brief Rates are per simulated second: they follow the time step [s]. */
  void setTimeStep(double time_step);
  /** @brief Time was set back: stamps follow it. */
  void restartStamps();
  /** @brief While on, who subscribes gets the present state at once; else the next step is soon. */
  void greetSubscribers(bool on);
  /** @brief Only ~step_report and the verdict, of a step that was not taken: nothing else has changed. */
  void publishReport(double real_time_factor);
  void publishCertificate();
  void publishMarkers();
  /** @brief Only /clock, with the stamp of the present state, for those who come while the simulation pauses. */
  void publishClock();
  /** @brief Topics of every step: what a recorder gets every message of. */
  const std::set<std::string>& dataTopics() const;
  /** @brief Those named in ~lossless_topics. @throws ParameterError for one that is not a data topic */
  std::set<std::string> losslessTopics(const std::vector<std::string>& resolved_names) const;
  /** @brief Subscribers of a topic of this node by resolved name. @throws ParameterError for another topic */
  std::uint32_t subscribers(const std::string& topic) const;
  StepReport report(double real_time_factor) const;

private:
  template <typename Message>
  ros::Publisher advertise(ros::NodeHandle& node, const std::string& topic, std::uint32_t queue,
                           const Message& (StepPublisher::*fill)());
  void advertiseOdometry(ros::NodeHandle& private_node, int body, const std::string& prefix);
  const sensor_msgs::JointState& jointStates();
  const ContactArray& contacts();
  Bodies bodies() const;
  const nav_msgs::Odometry& odometry(int body);
  const tf2_msgs::TFMessage& transforms();
  void publishStaticTransforms();
  const visualization_msgs::MarkerArray& allMarkers();
  MarkerCounts fillMarkers(const MarkerCounts& previous);
  void publishJointsAndContacts();
  void publishOdometry();
  void publishTransforms();

  const Simulator& simulator_;
  const NameTable& names_;
  StepDivider state_divider_;
  StepDivider clock_divider_;
  StepDivider tf_divider_;
  StepDivider marker_divider_;
  bool publish_clock_;
  MarkerScale marker_scale_;
  MarkerCounts marker_counts_;
  BodyMarkers body_markers_;
  std::set<std::string> data_topics_;
  ros::Time stamp_ = ros::TIME_MIN;  ///< of the present state; zero would mean "no clock yet"
  ros::Time transforms_stamp_;  ///< of the state that was shown last
  ros::Time markers_stamp_;
  bool greeting_ = false;
  LinkForces forces_;

  ros::Publisher joint_states_publisher_;
  ros::Publisher contacts_publisher_;
  ros::Publisher step_report_publisher_;
  ros::Publisher certificate_publisher_;
  std::vector<ros::Publisher> odometry_publishers_;  // by body
  ros::Publisher markers_publisher_;
  ros::Publisher bodies_publisher_;
  ros::Publisher clock_publisher_;
  ros::Publisher tf_publisher_;
  std::optional<TransformPublisher> tf_;
  std::optional<SensorPublisher> sensors_;
  std::optional<LinkPublisher> links_;  ///< last: roscpp finds a topic by a search from the first one

  // Kept from step to step for their storage.
  sensor_msgs::JointState joint_states_;
  ContactArray contacts_;
  StepReport step_report_;
  CertificateReport certificate_;
  std::vector<nav_msgs::Odometry> odometry_;
  visualization_msgs::MarkerArray markers_;
  rosgraph_msgs::Clock clock_;
  tf2_msgs::TFMessage transforms_;
  BodyJointPublisher body_joints_;
};

}  // namespace frictional_contact_sim
