#pragma once
/**
 * @file slave_api.h
 * @brief What other nodes say of their connections over XML-RPC (getBusStats), and the master's answer to "are you
 * there?". No call lasts longer than half a second, and whatever is answered is read with care: a node may be stopped,
 * ended, written in another language, or wrong.
 */
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace frictional_contact_sim
{
/** @brief Messages by topic. */
using MessageCounts = std::map<std::string, std::int64_t>;

struct SubscriptionCounts
{
  MessageCounts received;
  MessageCounts dropped;  ///< as far as the node counts them: rospy does not
};

/**
 * @brief The subscriptions in an answer to getBusStats, [publications, subscriptions, services] or, as the slave API
 * has it, [1, text, that]. What is not of the right type or below zero counts as nothing.
 */
SubscriptionCounts readSubscriptions(const XmlRpc::XmlRpcValue& answer);

/** @brief One connection a node, opened when it is first asked. */
class SlaveApi
{
public:
  /** @return the node's answer; nothing when it is unknown, silent for half a second, or answers with an error */
  std::optional<XmlRpc::XmlRpcValue> ask(const std::string& node, const char* method);
  /** @brief Messages sent by this node: by subscribing node and topic, of connections that stand. */
  std::optional<std::map<std::string, MessageCounts>> sentMessages();

private:
  bool readConnections();
  std::string uri(const std::string& node) const;
  XmlRpc::XmlRpcClient* client(const std::string& node);

  std::map<std::int64_t, std::string> connections_;  // of this node: who is at the other end
  std::map<std::string, std::unique_ptr<XmlRpc::XmlRpcClient>> clients_;
};

/** @brief Whether the master answers within half a second. After ros::init. */
bool masterAnswers();

/** @brief Nodes besides this one that publish a topic (resolved name), as the master knows it now. */
std::vector<std::string> otherPublishers(const std::string& topic);

}  // namespace frictional_contact_sim
