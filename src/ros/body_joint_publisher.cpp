#include "frictional_contact_sim/ros/body_joint_publisher.h"

#include <ros/single_subscriber_publisher.h>

#include <algorithm>

namespace frictional_contact_sim
{
namespace
{
constexpr std::uint32_t QUEUE = 2000;  // as joint_states
}  // namespace

void fillBodyJointState(const Simulator& simulator, const NameTable& names, int body, const ros::Time& stamp,
                        sensor_msgs::JointState& message)
{
  message.header.stamp = stamp;
  message.name.clear();
  message.position.clear();
  message.velocity.clear();
  message.effort.clear();
  for (const JointHandle& joint : names.joints)
  {
    if (joint.body != body)
      continue;
    message.name.push_back(simulator.model(body).joints[static_cast<size_t>(joint.joint)].name);
    message.position.push_back(simulator.position(body)[joint.q_index]);
    message.velocity.push_back(simulator.velocity(body)[joint.v_index]);
    message.effort.push_back(simulator.effort(body, joint.joint));
  }
}

BodyJointPublisher::BodyJointPublisher(ros::NodeHandle& node, const Simulator& simulator, const NameTable& names,
                                       const std::set<std::string>& prefixed,
                                       const std::function<ros::Time()>& greeting_stamp)
  : simulator_(simulator), names_(names)
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const bool has_joints = std::any_of(names.joints.begin(), names.joints.end(),
                                        [body](const JointHandle& joint) { return joint.body == body; });
    if (!has_joints || prefixed.count(simulator.bodyName(body)) == 0)
      continue;
    bodies_.push_back(body);
    publishers_.push_back(node.advertise<sensor_msgs::JointState>(
        simulator.bodyName(body) + "/joint_states", QUEUE,
        [this, body, greeting_stamp](const ros::SingleSubscriberPublisher& subscriber)
        {
          if (greeting_stamp().isZero())
            return;
          sensor_msgs::JointState message;
          fillBodyJointState(simulator_, names_, body, greeting_stamp(), message);
          subscriber.publish(message);
        }));
  }
  messages_.resize(bodies_.size());
}

void BodyJointPublisher::publish(const ros::Time& stamp)
{
  for (size_t i = 0; i < publishers_.size(); ++i)
  {
    if (publishers_[i].getNumSubscribers() == 0)
      continue;
    fillBodyJointState(simulator_, names_, bodies_[i], stamp, messages_[i]);
    publishers_[i].publish(messages_[i]);
  }
}

}  // namespace frictional_contact_sim
