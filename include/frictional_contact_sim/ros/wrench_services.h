#pragma once
/**
 * @file wrench_services.h
 * @brief Wrenches from outside: ~apply_wrench, ~clear_wrenches and the topic ~wrench.
 */
#include <frictional_contact_sim/ApplyWrench.h>
#include <frictional_contact_sim/ClearWrenches.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>

#include "frictional_contact_sim/ros/frames.h"
#include "frictional_contact_sim/ros/throttle.h"

namespace frictional_contact_sim
{
/**
 * @brief A wrench during [start, start + duration): it acts in the steps whose middle is in there.
 *
 * The point is taken into the link at the time of the request and moves with it. In axes of the link itself the wrench
 * turns with the link; axes of any other frame are taken as they stand at the request.
 * @throws RequestError naming the field; nothing has changed then
 */
void applyWrench(const ApplyWrench::Request& request, const NameTable& names, FrameResolver& frames,
                 Simulator& simulator);

/** @brief Of services, the topic and the scenario alike. @throws RequestError for an unknown body or link */
void clearWrenches(const ClearWrenches::Request& request, const NameTable& names, Simulator& simulator);

/**
 * @brief A message of ~wrench: on the link `frame_id`, at its origin, in its axes, from the next step on, in place of
 * the last message's for this link. Zero ends it.
 * @throws RequestError naming the field
 */
void takeWrench(const geometry_msgs::WrenchStamped& message, const NameTable& names, Simulator& simulator);

/** @brief Subscribes ~wrench; what is wrong with a message goes to the log. */
class WrenchListener
{
public:
  WrenchListener(ros::NodeHandle& private_node, const NameTable& names, Simulator& simulator);

private:
  LineThrottle lines_;
  ros::Subscriber subscriber_;
};

}  // namespace frictional_contact_sim
