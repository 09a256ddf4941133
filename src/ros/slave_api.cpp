#include "frictional_contact_sim/ros/slave_api.h"

#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpc.h>

#include <algorithm>

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
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(CALL_TIMEOUT);
  bool done = false;
  bool is_open = true;
  while (!ros::isShuttingDown() && !done && is_open && ros::WallTime::now() < end)
  {
    const ros::WallTime start = ros::WallTime::now();
    dispatch.work(CALL_SLICE);
    done = client.executeCheckDone(response);
    is_open = (ros::WallTime::now() - start).toSec() > 0.5 * CALL_SLICE;  // without a connection it returns at once
  }
  dispatch.removeSource(&client);
  return done && !client.isFault() && response.valid();
}

/** @brief Element of a list, else an invalid value. */
XmlRpcValue element(const XmlRpcValue& list, int index)
{
  const bool there = list.getType() == XmlRpcValue::TypeArray && index < list.size();
  return there ? list[index] : XmlRpcValue();
}

int length(const XmlRpcValue& list)
{
  return list.getType() == XmlRpcValue::TypeArray ? list.size() : 0;
}

std::string text(XmlRpcValue value)
{
  return value.getType() == XmlRpcValue::TypeString ? static_cast<std::string>(value) : std::string();
}

std::int64_t count(XmlRpcValue value)
{
  return value.getType() == XmlRpcValue::TypeInt ? std::max(0, static_cast<int>(value)) : 0;
}

/** @brief roscpp answers getBusStats with the value alone, rospy with the slave API's [1, text, value]. */
XmlRpcValue unwrap(const XmlRpcValue& answer)
{
  return element(answer, 0).getType() == XmlRpcValue::TypeInt ? element(answer, 2) : answer;
}

}  // namespace

SubscriptionCounts readSubscriptions(const XmlRpcValue& answer)
{
  const XmlRpcValue subscriptions = element(unwrap(answer), 1);
  SubscriptionCounts counts;
  for (int i = 0; i < length(subscriptions); ++i)
  {
    // [topic, [[connection, bytes, messages, drops, ...], ...]]
    const std::string topic = text(element(subscriptions[i], 0));
    const XmlRpcValue connections = element(subscriptions[i], 1);
    for (int k = 0; k < length(connections); ++k)
    {
      counts.received[topic] += count(element(connections[k], 2));
      counts.dropped[topic] += count(element(connections[k], 3));
    }
  }
  return counts;
}

/** @brief [[connection, node, direction, transport, topic, ...], ...]: which node is at the other end. */
bool SlaveApi::readConnections()
{
  const std::optional<XmlRpcValue> answer = ask(ros::this_node::getName(), "getBusInfo");
  if (!answer)
    return false;
  connections_.clear();
  const XmlRpcValue info = unwrap(*answer);
  for (int i = 0; i < length(info); ++i)
    connections_[count(element(info[i], 0))] = text(element(info[i], 1));
  return true;
}

std::optional<std::map<std::string, MessageCounts>> SlaveApi::sentMessages()
{
  const std::optional<XmlRpcValue> stats = ask(ros::this_node::getName(), "getBusStats");
  if (!stats)
    return std::nullopt;
  const XmlRpcValue publications = element(unwrap(*stats), 0);
  std::map<std::string, MessageCounts> sent;
  for (int i = 0; i < length(publications); ++i)
  {
    // [topic, [[connection, bytes, bytes, messages, ...], ...]]
    const std::string topic = text(element(publications[i], 0));
    const XmlRpcValue connections = element(publications[i], 1);
    for (int k = 0; k < length(connections); ++k)
    {
      const std::int64_t connection = count(element(connections[k], 0));
      if (connections_.count(connection) == 0 && !readConnections())
        return std::nullopt;
      // One that has been closed between the two calls is not there.
      const auto found = connections_.find(connection);
      const std::string node = found == connections_.end() ? "" : found->second;
      if (!node.empty() && node != ros::this_node::getName())
        sent[node][topic] += count(element(connections[k], 3));
    }
  }
  return sent;
}

std::optional<XmlRpcValue> SlaveApi::ask(const std::string& node, const char* method)
{
  XmlRpcClient* remote = client(node);
  XmlRpcValue request;
  XmlRpcValue response;
  request[0] = ros::this_node::getName();
  if (remote != nullptr && call(*remote, method, request, response))
    return response;
  clients_.erase(node);
  return std::nullopt;
}

/** @brief Of a node's XML-RPC server, empty when it has none. */
std::string SlaveApi::uri(const std::string& node) const
{
  if (node == ros::this_node::getName())
    return ros::XMLRPCManager::instance()->getServerURI();
  XmlRpcClient master(ros::master::getHost().c_str(), static_cast<int>(ros::master::getPort()), "/");
  XmlRpcValue request;
  XmlRpcValue response;
  request[0] = ros::this_node::getName();
  request[1] = node;
  return call(master, "lookupNode", request, response) ? text(element(response, 2)) : std::string();  // [1, text, URI]
}

XmlRpcClient* SlaveApi::client(const std::string& node)
{
  std::unique_ptr<XmlRpcClient>& client = clients_[node];
  if (client == nullptr)
  {
    std::string host;
    std::uint32_t port = 0;
    if (!ros::network::splitURI(uri(node), host, port))
      return nullptr;
    client = std::make_unique<XmlRpcClient>(host.c_str(), static_cast<int>(port), "/");
  }
  return client.get();
}

namespace
{
/** @brief A question to the master that needs no argument but the caller's name. */
bool askMaster(const char* method, XmlRpcValue& response)
{
  XmlRpcClient master(ros::master::getHost().c_str(), static_cast<int>(ros::master::getPort()), "/");
  XmlRpcValue request;
  request[0] = ros::this_node::getName();
  return call(master, method, request, response);
}

}  // namespace

bool masterAnswers()
{
  XmlRpcValue response;
  return askMaster("getPid", response);
}

std::vector<std::string> otherPublishers(const std::string& topic)
{
  std::vector<std::string> nodes;
  XmlRpcValue response;
  if (!askMaster("getSystemState", response))
    return nodes;
  // [publishers, subscribers, services], each [[topic, [node, ...]], ...]
  const XmlRpcValue publishers = element(unwrap(response), 0);
  for (int i = 0; i < length(publishers); ++i)
  {
    const XmlRpcValue names = element(publishers[i], 1);
    for (int k = 0; text(element(publishers[i], 0)) == topic && k < length(names); ++k)
      if (text(element(names, k)) != ros::this_node::getName())
        nodes.push_back(text(element(names, k)));
  }
  return nodes;
}

}  // namespace frictional_contact_sim
