#pragma once
/**
 * @file delivery.h
 * @brief Who must get every message, and whether they have: no one else can hold a run, and these not for long.
 *
 * roscpp tells a publisher nothing about what became of its messages. Every ROS node answers the XML-RPC call
 * getBusStats, though, with the number of messages received on each connection; this node's own numbers say what was
 * sent. A free run compares them every few steps for the subscribers of ~lossless_topics and for recorders that have
 * announced themselves, and waits until they agree or the time is up. A rospy subscriber counts only what its queue
 * has kept, a stopped one answers nothing: their numbers never meet.
 */
#include <boost/signals2/connection.hpp>

#include <atomic>
#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "frictional_contact_sim/ros/slave_api.h"

namespace frictional_contact_sim
{
/** @brief Topic (std_msgs/String, latched) on which a node that must get everything says its name, as record_bag does.
 */
extern const char* const LOSSLESS_NODES_TOPIC;

class DeliveryMonitor
{
public:
  /**
   * @param topics resolved names of the topics looked at
   * @param lossless_topics those of them whose every subscriber must get every message
   * @param hold_limit how long a run waits for a subscriber [s]
   */
  DeliveryMonitor(std::set<std::string> topics, std::set<std::string> lossless_topics, double hold_limit);
  ~DeliveryMonitor();
  DeliveryMonitor(const DeliveryMonitor&) = delete;
  DeliveryMonitor& operator=(const DeliveryMonitor&) = delete;

  /** @brief From now on these are looked at. */
  void setTopics(std::set<std::string> topics) { topics_ = std::move(topics); }
  /** @brief From now on this node must get every message of what it subscribes to. */
  void addLosslessNode(const std::string& node);
  /** @brief Returns when roscpp's own thread has handed to the connections what was published up to now. */
  void flushPublishQueues();
  /**
   * @brief One look. @param waited since the run is held [s]; beyond the limit those that lag are given up for good,
   * with one warning that says how many messages they lack. @return whether someone still lags
   */
  bool lagging(double waited);
  /** @brief Before an end: until everybody has what was sent, nobody reads on, or the limit is over. */
  void flush();
  /** @brief Messages that subscribers dropped, as they said when they were asked: "node topic" to number. */
  const std::map<std::string, std::int64_t>& dropped() const;

private:
  /** @brief What one node has of the topics looked at. */
  struct Delivery
  {
    bool answered = false;
    std::int64_t received = 0;
    std::int64_t missing = 0;
  };

  /** @brief The same of all nodes. */
  struct Round
  {
    std::int64_t received = 0;
    bool missing = false;
    bool lossless_missing = false;  ///< of those that the run waits for
  };

  Delivery look(const std::string& node, const MessageCounts& sent);
  MessageCounts lossless(const std::string& node, const MessageCounts& sent) const;
  Round lookAtAll(std::set<std::string>& silent);
  void giveUp(const std::string& node, const Delivery& delivery);

  std::set<std::string> topics_;
  std::set<std::string> lossless_topics_;
  std::set<std::string> lossless_nodes_;
  std::set<std::string> given_up_;
  double hold_limit_;
  std::atomic<std::uint64_t> poll_cycles_{0};
  boost::signals2::connection poll_listener_;
  SlaveApi nodes_;
  std::map<std::string, std::int64_t> dropped_;
};

}  // namespace frictional_contact_sim
