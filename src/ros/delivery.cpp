#include "frictional_contact_sim/ros/delivery.h"

#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/poll_manager.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

#include <chrono>
#include <thread>

namespace frictional_contact_sim
{
using XmlRpc::XmlRpcClient;
using XmlRpc::XmlRpcValue;

namespace
{
constexpr double CALL_TIMEOUT = 0.5;  // [s]
constexpr double CALL_SLICE = 0.02;  // between two looks at a shutdown [s]

/** @brief A call that neither hangs on a stopped node nor keeps a shutdown waiting. */
bool call(XmlRpcClient& client, const char* method, const XmlRpcValue& request, XmlRpcValue& response)
{
  if (!client.executeNonBlock(method, request))
    return false;
  XmlRpc::XmlRpcDispatch dispatch;
  dispatch.addSource(&client, XmlRpc::XmlRpcDispatch::WritableEvent | XmlRpc::XmlRpcDispatch::Exception);
  bool done = false;
  for (double waited = 0.0; ros::ok() && !done && waited < CALL_TIMEOUT; waited += CALL_SLICE)
  {
    dispatch.work(CALL_SLICE);
    done = client.executeCheckDone(response);
  }
  dispatch.removeSource(&client);
  return done && !client.isFault();
}

/** @brief [topic, [[connection, bytes, messages, drops, ...], ...]] of getBusStats: sum of one column. */
int sumColumn(XmlRpcValue& connections, int column)
{
  int sum = 0;
  for (int i = 0; connections.getType() == XmlRpcValue::TypeArray && i < connections.size(); ++i)
  {
    XmlRpcValue& connection = connections[i];
    if (connection.size() > column && connection[column].getType() == XmlRpcValue::TypeInt)
      sum += static_cast<int>(connection[column]);
  }
  return sum;
}

}  // namespace

DeliveryMonitor::DeliveryMonitor(std::set<std::string> topics) : topics_(std::move(topics))
{
  poll_listener_ = ros::PollManager::instance()->addPollThreadListener([this] { ++poll_cycles_; });
}

DeliveryMonitor::~DeliveryMonitor()
{
  ros::PollManager::instance()->removePollThreadListener(poll_listener_);
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

const std::map<std::string, int>& DeliveryMonitor::dropped() const
{
  return dropped_;
}

/** @brief Value of an answer: [1, "", value] by the slave API, but roscpp answers getBusStats with the value alone. */
bool DeliveryMonitor::ask(const std::string& node, const char* method, XmlRpcValue& value)
{
  XmlRpcClient* remote = client(node);
  XmlRpcValue request;
  XmlRpcValue response;
  request[0] = ros::this_node::getName();
  if (remote == nullptr || !call(*remote, method, request, response) || response.getType() != XmlRpcValue::TypeArray ||
      response.size() < 2)
  {
    clients_.erase(node);
    return false;
  }
  value = response[0].getType() == XmlRpcValue::TypeInt ? response[2] : response;
  return true;
}

/** @brief getBusInfo: [connection, node, direction, transport, topic, ...] of every connection. */
void DeliveryMonitor::readConnections()
{
  XmlRpcValue info;
  connections_.clear();
  if (!ask(ros::this_node::getName(), "getBusInfo", info))
    return;
  for (int i = 0; info.getType() == XmlRpcValue::TypeArray && i < info.size(); ++i)
    connections_[static_cast<int>(info[i][0])] = static_cast<std::string>(info[i][1]);
}

bool DeliveryMonitor::sentCounts(std::map<std::string, Counts>& sent)
{
  // getBusStats' first part, the publications: [topic, [[connection, bytes, bytes, messages, ...], ...]]
  XmlRpcValue stats;
  if (!ask(ros::this_node::getName(), "getBusStats", stats))
    return false;
  XmlRpcValue& publications = stats[0];
  for (int i = 0; publications.getType() == XmlRpcValue::TypeArray && i < publications.size(); ++i)
  {
    const std::string topic = publications[i][0];
    XmlRpcValue& connections = publications[i][1];
    for (int k = 0;
         topics_.count(topic) > 0 && connections.getType() == XmlRpcValue::TypeArray && k < connections.size(); ++k)
    {
      const int connection = connections[k][0];
      if (connections_.count(connection) == 0)
        readConnections();
      const std::string node = connections_[connection];
      if (!node.empty() && node != ros::this_node::getName())
        sent[node][topic] += static_cast<int>(connections[k][3]);
    }
  }
  return true;
}

XmlRpcClient* DeliveryMonitor::client(const std::string& node)
{
  std::unique_ptr<XmlRpcClient>& client = clients_[node];
  if (client == nullptr)
  {
    XmlRpcValue request;
    XmlRpcValue response;
    XmlRpcValue uri;
    request[0] = ros::this_node::getName();
    request[1] = node;
    std::string host;
    std::uint32_t port = 0;
    if (!ros::master::execute("lookupNode", request, response, uri, false) ||
        !ros::network::splitURI(static_cast<std::string>(uri), host, port))
      return nullptr;
    client = std::make_unique<XmlRpcClient>(host.c_str(), static_cast<int>(port), "/");
  }
  return client.get();
}

bool DeliveryMonitor::receivedCounts(const std::string& node, Counts& received)
{
  XmlRpcValue stats;
  if (!ask(node, "getBusStats", stats))
    return false;
  XmlRpcValue& subscriptions = stats[1];
  for (int i = 0; subscriptions.getType() == XmlRpcValue::TypeArray && i < subscriptions.size(); ++i)
  {
    const std::string topic = subscriptions[i][0];
    if (topics_.count(topic) > 0)
    {
      received[topic] += sumColumn(subscriptions[i][1], 2);
      const int drops = sumColumn(subscriptions[i][1], 3);
      if (drops > 0)
        dropped_[node + " " + topic] = drops;
    }
  }
  return true;
}

std::string DeliveryMonitor::laggard()
{
  flushPublishQueues();
  std::map<std::string, Counts> all_sent;
  if (!sentCounts(all_sent))
    return ros::this_node::getName();
  for (const auto& [node, sent] : all_sent)
  {
    Counts received;
    if (!receivedCounts(node, received))
      return node;  // stopped or ended: in the second case its connections disappear presently
    for (const auto& [topic, count] : sent)
      if (received[topic] < count)
        return node;
  }
  return std::string();
}

}  // namespace frictional_contact_sim
