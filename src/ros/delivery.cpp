#include "frictional_contact_sim/ros/delivery.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/poll_manager.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace frictional_contact_sim
{
const char* const LOSSLESS_NODES_TOPIC = "/lossless_nodes";

namespace
{
constexpr double PATIENCE = 1.0;  // at the end, with subscribers that may lose messages and do not read on [s]

double seconds()
{
  return ros::WallTime::now().toSec();
}

}  // namespace

DeliveryMonitor::DeliveryMonitor(std::set<std::string> topics, std::set<std::string> lossless_topics, double hold_limit)
  : topics_(std::move(topics)), lossless_topics_(std::move(lossless_topics)), hold_limit_(hold_limit)
{
  poll_listener_ = ros::PollManager::instance()->addPollThreadListener([this] { ++poll_cycles_; });
}

DeliveryMonitor::~DeliveryMonitor()
{
  ros::PollManager::instance()->removePollThreadListener(poll_listener_);
}

void DeliveryMonitor::addLosslessNode(const std::string& node)
{
  lossless_nodes_.insert(node);
  given_up_.erase(node);  // it has been started anew
}

/**
 * publish() only puts a message into a queue; roscpp's poll thread hands it to the connections, where it is counted as
 * sent, and then runs the listeners. The second cycle that ends from now on has begun after the last publish().
 */
void DeliveryMonitor::flushPublishQueues()
{
  const std::uint64_t target = poll_cycles_ + 2;
  while (ros::ok() && poll_cycles_ < target)
  {
    ros::PollManager::instance()->getPollSet().signal();
    std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
}

const std::map<std::string, std::int64_t>& DeliveryMonitor::dropped() const
{
  return dropped_;
}

/** @brief The part of what was sent to a node that may hold the run. */
MessageCounts DeliveryMonitor::lossless(const std::string& node, const MessageCounts& sent) const
{
  MessageCounts counts;
  if (given_up_.count(node) == 0)
    for (const auto& [topic, count] : sent)
      if (topics_.count(topic) > 0 && (lossless_nodes_.count(node) > 0 || lossless_topics_.count(topic) > 0))
        counts[topic] = count;
  return counts;
}

DeliveryMonitor::Delivery DeliveryMonitor::look(const std::string& node, const MessageCounts& sent)
{
  Delivery delivery;
  SubscriptionCounts counts;
  if (const std::optional<XmlRpc::XmlRpcValue> answer = nodes_.ask(node, "getBusStats"))
  {
    delivery.answered = true;
    counts = readSubscriptions(*answer);
  }
  for (const auto& [topic, count] : sent)
  {
    delivery.received += counts.received[topic];
    delivery.missing += std::max<std::int64_t>(0, count - counts.received[topic]);
    if (counts.dropped[topic] > 0)
      dropped_[node + " " + topic] = counts.dropped[topic];
  }
  return delivery;
}

void DeliveryMonitor::giveUp(const std::string& node, const Delivery& delivery)
{
  given_up_.insert(node);
  if (delivery.answered)
    ROS_WARN_STREAM(node << " lacks " << delivery.missing << " messages that were sent to it " << hold_limit_
                         << " s ago (~hold_limit): they are lost, and the run waits for it no more");
  else
    ROS_WARN_STREAM(node << " does not say what it has received (getBusStats), for " << hold_limit_
                         << " s (~hold_limit): the run waits for it no more");
}

bool DeliveryMonitor::lagging(double waited)
{
  if (lossless_topics_.empty() && lossless_nodes_.empty())
    return false;
  const std::optional<std::map<std::string, MessageCounts>> sent_by_node = nodes_.sentMessages();
  if (!sent_by_node)
    return waited < hold_limit_;
  for (const auto& [node, all] : *sent_by_node)
  {
    const MessageCounts sent = lossless(node, all);
    if (sent.empty())
      continue;
    const Delivery delivery = look(node, sent);
    if (delivery.missing == 0)
      continue;
    if (waited < hold_limit_)
      return true;
    giveUp(node, delivery);
  }
  return false;
}

/** @brief One look at all subscribers but the silent ones; who does not answer and may lose messages is silent then. */
DeliveryMonitor::Round DeliveryMonitor::lookAtAll(std::set<std::string>& silent)
{
  Round round;
  const auto sent_by_node = nodes_.sentMessages();
  if (!sent_by_node)  // not known is not arrived
  {
    round.missing = round.lossless_missing = true;
    return round;
  }
  for (const auto& [node, all] : *sent_by_node)
  {
    MessageCounts sent;
    for (const auto& [topic, count] : all)
      if (topics_.count(topic) > 0)
        sent[topic] = count;
    if (sent.empty() || silent.count(node) > 0)
      continue;
    const Delivery delivery = look(node, sent);
    const bool waited_for = !lossless(node, all).empty();
    round.received += delivery.received;
    round.lossless_missing = round.lossless_missing || (waited_for && delivery.missing > 0);
    if (delivery.answered || waited_for)
      round.missing = round.missing || delivery.missing > 0;
    else
      silent.insert(node);
  }
  return round;
}

void DeliveryMonitor::flush()
{
  flushPublishQueues();
  std::set<std::string> silent;
  const double start = seconds();
  double last_progress = start;
  Round last;
  do
  {
    const Round round = lookAtAll(silent);
    if (!round.missing)
      return;
    if (round.received != last.received)
      last_progress = seconds();
    last = round;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while (ros::ok() && seconds() - start < hold_limit_ &&
           (last.lossless_missing || seconds() - last_progress < PATIENCE));
}

}  // namespace frictional_contact_sim
