#include "frictional_contact_sim/ros/slave_api.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace frictional_contact_sim
{
namespace
{
using XmlRpc::XmlRpcValue;

XmlRpcValue list(const std::vector<XmlRpcValue>& elements)
{
  XmlRpcValue value;
  value.setSize(static_cast<int>(elements.size()));
  for (size_t i = 0; i < elements.size(); ++i)
    value[static_cast<int>(i)] = elements[i];
  return value;
}

const XmlRpcValue NONE = list({});

/** @brief [topic, [[connection, bytes, messages, drops, connected], ...]] */
XmlRpcValue subscription(const std::string& topic, const std::vector<std::pair<int, int>>& messages_and_drops)
{
  std::vector<XmlRpcValue> connections;
  for (const auto& [messages, drops] : messages_and_drops)
    connections.push_back(list({1, 100, messages, drops, 0}));
  return list({topic, list(connections)});
}

TEST(SlaveApiTest, ReadsRoscppsAndRospysAnswersAlike)
{
  const XmlRpcValue subscriptions =
      list({subscription("/a", {{7, 0}, {5, 2}}), subscription("/b", {{3, -1}}), subscription("/c", {})});
  const XmlRpcValue value = list({NONE, subscriptions, NONE});
  const XmlRpcValue wrapped = list({1, std::string("bus stats"), value});
  for (const XmlRpcValue& answer : {value, wrapped})
  {
    SubscriptionCounts counts = readSubscriptions(answer);
    EXPECT_EQ(counts.received["/a"], 12);
    EXPECT_EQ(counts.dropped["/a"], 2);
    EXPECT_EQ(counts.received["/b"], 3);
    EXPECT_EQ(counts.dropped["/b"], 0);  // rospy's -1 is "not counted"
    EXPECT_EQ(counts.received["/c"], 0);
  }
}

TEST(SlaveApiTest, HugeNumbersAddUpWithoutOverflow)
{
  const int most = std::numeric_limits<int>::max();
  const XmlRpcValue subscriptions = list({subscription("/a", {{most, most}, {most, most}, {most, most}})});
  SubscriptionCounts counts = readSubscriptions(list({NONE, subscriptions, NONE}));
  EXPECT_EQ(counts.received["/a"], 3 * static_cast<std::int64_t>(most));
  EXPECT_EQ(counts.dropped["/a"], 3 * static_cast<std::int64_t>(most));
}

/** @brief Any value at all, lists in lists among them. */
XmlRpcValue anyValue(std::mt19937& random, int depth)
{
  switch (random() % (depth > 0 ? 8 : 5))
  {
    case 0:
      return XmlRpcValue(static_cast<int>(random()));
    case 1:
      return XmlRpcValue(random() % 2 == 0 ? 1e300 : -0.5);
    case 2:
      return XmlRpcValue(random() % 2 == 0 ? std::string("/a") : std::string());
    case 3:
      return XmlRpcValue(true);
    case 4:
      return XmlRpcValue();
    case 5:
    {
      XmlRpcValue structure;
      structure["received"] = anyValue(random, depth - 1);
      return structure;
    }
    default:
    {
      std::vector<XmlRpcValue> elements(random() % 6);
      for (XmlRpcValue& element : elements)
        element = anyValue(random, depth - 1);
      return list(elements);
    }
  }
}

TEST(SlaveApiTest, WhateverIsAnsweredIsSurvivedAndNothingCountsBelowZero)
{
  std::mt19937 random(20260101);
  int counted = 0;
  for (int trial = 0; trial < 20000; ++trial)
  {
    // Right as far as some level, and anything below it: else hardly one would be looked into.
    XmlRpcValue answer = anyValue(random, 5);
    if (trial % 3 != 0)
      answer = list({NONE, anyValue(random, 4)});
    if (trial % 3 == 2)
      answer = list({NONE, list({list({std::string("/a"), list({anyValue(random, 2), anyValue(random, 2)})})})});
    const SubscriptionCounts counts = readSubscriptions(answer);
    for (const MessageCounts& numbers : {counts.received, counts.dropped})
    {
      for (const auto& [topic, count] : numbers)
      {
        ASSERT_GE(count, 0) << answer.toXml();
        counted += count > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(counted, 100);  // some were well enough formed
}

}  // namespace
}  // namespace frictional_contact_sim
