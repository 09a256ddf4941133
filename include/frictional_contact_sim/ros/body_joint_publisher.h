#pragma once
/**
 * @file body_joint_publisher.h
 * @brief BODY/joint_states of bodies whose names have a prefix, with the names of their URDF: what a
 * robot_state_publisher in the namespace BODY, with tf_prefix BODY, listens to.
 */
#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/names.h"

namespace frictional_contact_sim
{
/** @brief The part of joint_states that is one body's, under its URDF's names. */
void fillBodyJointState(const Simulator& simulator, const NameTable& names, int body, const ros::Time& stamp,
                        sensor_msgs::JointState& message);

class BodyJointPublisher
{
public:
  /** @param greeting_stamp of the present state while who subscribes is to get it at once, else zero */
  BodyJointPublisher(ros::NodeHandle& node, const Simulator& simulator, const NameTable& names,
                     const std::set<std::string>& prefixed, const std::function<ros::Time()>& greeting_stamp);

  /** @brief What somebody listens to, of the present state. */
  void publish(const ros::Time& stamp);
  const std::vector<ros::Publisher>& publishers() const { return publishers_; }

private:
  const Simulator& simulator_;
  const NameTable& names_;
  std::vector<int> bodies_;  ///< one a publisher
  std::vector<ros::Publisher> publishers_;
  std::vector<sensor_msgs::JointState> messages_;  ///< kept for their storage
};

}  // namespace frictional_contact_sim
