#include "frictional_contact_sim/ros/link_publisher.h"

#include <ros/single_subscriber_publisher.h>

namespace frictional_contact_sim
{
namespace
{
constexpr std::uint32_t QUEUE = 2000;  // as the other topics of every step
}  // namespace

LinkPublisher::LinkPublisher(ros::NodeHandle& private_node, const Simulator& simulator, const NameTable& names,
                             LinkForces& forces, bool advertised)
  : simulator_(simulator), names_(names), forces_(forces)
{
  for (int body = 0; advertised && body < simulator.bodyCount(); ++body)
    for (int frame = 0; frame < static_cast<int>(simulator.model(body).frames.size()); ++frame)
    {
      const std::string link = topicName(names.frames[body][frame]);
      const std::string joint = topicName(names.frame_joints[body][frame]);
      advertise<ContactArray>(private_node, "contacts/" + link, Kind::CONTACTS, body, frame);
      advertise<geometry_msgs::WrenchStamped>(private_node, "wrench/" + link, Kind::WRENCH, body, frame);
      if (!joint.empty())
        advertise<geometry_msgs::WrenchStamped>(private_node, "joint_wrench/" + joint, Kind::JOINT_WRENCH, body, frame);
    }
}

template <typename Message>
void LinkPublisher::advertise(ros::NodeHandle& private_node, const std::string& name, Kind kind, int body, int frame)
{
  // Two URDF names may differ in nothing that a topic keeps.
  std::string free_name = name;
  for (int k = 2; !used_names_.insert(free_name).second; ++k)
    free_name = name + "_" + std::to_string(k);
  topics_.push_back({kind, body, frame, 0, ros::Publisher(), ContactArray()});
  Topic& topic = topics_.back();
  topic.publisher = private_node.advertise<Message>(
      free_name, QUEUE,
      [this, &topic](const ros::SingleSubscriberPublisher& subscriber)
      {
        count(topic, 1);
        if (greeting_)
          send(topic, subscriber);
      },
      [this, &topic](const ros::SingleSubscriberPublisher&) { count(topic, -1); });
}

void LinkPublisher::count(Topic& topic, int change)
{
  topic.listeners += change;
  heard_.clear();
  for (Topic& one : topics_)
    if (one.listeners > 0)
      heard_.push_back(&one);
}

/** @param publisher to all, or to a single subscriber */
template <typename Publisher>
void LinkPublisher::send(Topic& topic, const Publisher& publisher)
{
  const std::string& link = names_.frames[topic.body][topic.frame];
  geometry_msgs::WrenchStamped wrench;
  switch (topic.kind)
  {
    case Kind::CONTACTS:
      fillLinkContacts(simulator_, names_, topic.body, topic.frame, stamp_, topic.contacts);
      publisher.publish(topic.contacts);
      break;
    case Kind::WRENCH:
      fillWrench(forces_.contactWrench(topic.body, topic.frame), link, stamp_, wrench);
      publisher.publish(wrench);
      break;
    case Kind::JOINT_WRENCH:
      if (!forces_.hasStep())
        break;
      fillWrench(forces_.jointWrench(topic.body, topic.frame), link, stamp_, wrench);
      publisher.publish(wrench);
      break;
  }
}

void LinkPublisher::publish(const ros::Time& stamp)
{
  stamp_ = stamp;
  for (Topic* topic : heard_)
    send(*topic, topic->publisher);
}

void LinkPublisher::greetSubscribers(bool on)
{
  greeting_ = on;
}

std::set<std::string> LinkPublisher::topics() const
{
  std::set<std::string> names;
  for (const Topic& topic : topics_)
    names.insert(topic.publisher.getTopic());
  return names;
}

int LinkPublisher::subscribers(const std::string& topic) const
{
  for (const Topic& one : topics_)
    if (one.publisher.getTopic() == topic)
      return static_cast<int>(one.publisher.getNumSubscribers());
  return -1;
}

}  // namespace frictional_contact_sim
