#pragma once
/**
 * @file transform_publisher.h
 * @brief /tf and /tf_static: world to the root links, and, where nobody else does it, the links of the bodies.
 */
#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <vector>

#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/names.h"

namespace frictional_contact_sim
{
/** @brief Which of them. */
struct TransformChoice
{
  bool bases = true;  ///< world to the root links, but one that is named world
  bool links = false;  ///< parent to child of each URDF joint, as robot_state_publisher does for a robot_description
};

/** @brief Whether a frame never moves relative to its parent, of a root the world. */
bool isStatic(const BodyModel& body, int frame);

class TransformPublisher
{
public:
  TransformPublisher(const Simulator& simulator, const NameTable& names, const TransformChoice& choice);

  /** @brief What moves, at this stamp. */
  const std::vector<geometry_msgs::TransformStamped>& moving(const ros::Time& stamp);
  /** @brief Sends what moves. */
  void send(const ros::Time& stamp);
  /**
   * @brief Sends what never moves, latched, where it is not as it was sent.
   * @param others frames that sit on links
   */
  void sendStatic(const ros::Time& stamp, const std::vector<geometry_msgs::TransformStamped>& others);

private:
  void append(int body, int frame, const ros::Time& stamp, std::vector<geometry_msgs::TransformStamped>& transforms);
  bool isChosen(int body, int frame) const;

  const Simulator& simulator_;
  const NameTable& names_;
  TransformChoice choice_;
  tf2_ros::TransformBroadcaster broadcaster_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
  std::vector<geometry_msgs::TransformStamped> moving_;
  std::vector<geometry_msgs::TransformStamped> static_;  // as sent
};

}  // namespace frictional_contact_sim
