#pragma once
/**
 * @file link_publisher.h
 * @brief Topics of single links and joints: ~wrench/LINK, ~contacts/LINK, ~joint_wrench/JOINT.
 *
 * There may be hundreds of them: who listens is counted when he comes and goes, so that a step looks only at the topics
 * that somebody listens to.
 */
#include <ros/node_handle.h>

#include <deque>
#include <set>
#include <string>
#include <vector>

#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/simulation/link_forces.h"

namespace frictional_contact_sim
{
class LinkPublisher
{
public:
  /** @param advertised false: there are no such topics */
  LinkPublisher(ros::NodeHandle& private_node, const Simulator& simulator, const NameTable& names, LinkForces& forces,
                bool advertised);
  LinkPublisher(const LinkPublisher&) = delete;
  LinkPublisher& operator=(const LinkPublisher&) = delete;

  /** @brief What somebody listens to, of the present state. A joint wrench only where the state comes from a step. */
  void publish(const ros::Time& stamp);
  /** @brief While on, who subscribes gets what was published last. */
  void greetSubscribers(bool on);
  /** @brief Resolved names. */
  std::set<std::string> topics() const;
  /** @return number of subscribers, -1 when the topic is none of these */
  int subscribers(const std::string& topic) const;

private:
  enum class Kind
  {
    CONTACTS,
    WRENCH,
    JOINT_WRENCH
  };
  struct Topic
  {
    Kind kind;
    int body;
    int frame;
    int listeners = 0;
    ros::Publisher publisher;
    ContactArray contacts;  // kept for its storage
  };

  template <typename Message>
  void advertise(ros::NodeHandle& private_node, const std::string& name, Kind kind, int body, int frame);
  template <typename Publisher>
  void send(Topic& topic, const Publisher& publisher);
  void count(Topic& topic, int change);

  const Simulator& simulator_;
  const NameTable& names_;
  LinkForces& forces_;
  ros::Time stamp_ = ros::TIME_MIN;
  bool greeting_ = false;
  std::set<std::string> used_names_;
  std::deque<Topic> topics_;  // callbacks point into it
  std::vector<Topic*> heard_;  // those with listeners
};

}  // namespace frictional_contact_sim
