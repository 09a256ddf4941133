#pragma once
/**
 * @file delivery.h
 * @brief Makes sure that every subscriber has read what was published, so that a run as fast as possible loses nothing.
 *
 * roscpp tells a publisher nothing about what became of its messages, and a subscriber whose queue is full drops the
 * oldest (rosbag record: 100 a topic). Every ROS node answers the XML-RPC call getBusStats, though, with the number of
 * messages sent or received on each connection and of those dropped, this node as well. The monitor compares them.
 * Asking every WINDOW steps (well below 100) bounds what can be in flight, on both sides.
 */
#include <boost/signals2/connection.hpp>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

namespace XmlRpc
{
class XmlRpcClient;
class XmlRpcValue;
}  // namespace XmlRpc

namespace frictional_contact_sim
{
class DeliveryMonitor
{
public:
  /** @param topics resolved names of topics none of whose messages may be lost */
  explicit DeliveryMonitor(std::set<std::string> topics);
  ~DeliveryMonitor();
  DeliveryMonitor(const DeliveryMonitor&) = delete;
  DeliveryMonitor& operator=(const DeliveryMonitor&) = delete;

  /** @brief One look. @return name of a node that has not yet received everything sent to it, empty when all have */
  std::string laggard();
  /** @brief Messages that subscribers dropped since the start, as they say: "node topic" to number. */
  const std::map<std::string, int>& dropped() const;

private:
  using Counts = std::map<std::string, int>;  // messages by topic

  void flushPublishQueues();
  bool ask(const std::string& node, const char* method, XmlRpc::XmlRpcValue& value);
  void readConnections();
  bool sentCounts(std::map<std::string, Counts>& sent);
  bool receivedCounts(const std::string& node, Counts& received);
  XmlRpc::XmlRpcClient* client(const std::string& node);

  std::set<std::string> topics_;
  std::atomic<std::uint64_t> poll_cycles_{0};
  boost::signals2::connection poll_listener_;
  std::map<std::string, std::unique_ptr<XmlRpc::XmlRpcClient>> clients_;
  std::map<int, std::string> connections_;  // of this node: who is at the other end
  std::map<std::string, int> dropped_;
};

}  // namespace frictional_contact_sim
