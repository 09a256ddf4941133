#include "frictional_contact_sim/ros/throttle.h"

#include <gtest/gtest.h>

namespace frictional_contact_sim
{
namespace
{
TEST(ThrottleTest, OneMessageASecondPassesAndSaysHowManyDidNot)
{
  Throttle throttle(1.0);
  int shown = 0;
  int told = 0;
  for (int k = 0; k < 4000; ++k)  // a thousand a second
  {
    const std::optional<int> held_back = throttle.pass(100.0 + 0.001 * k);
    shown += held_back ? 1 : 0;
    told += held_back.value_or(0);
  }
  EXPECT_NEAR(shown, 4, 1);  // round-off may move one over the edge of its second
  EXPECT_EQ(shown + told + throttle.heldBack(), 4000);  // none is forgotten
}

TEST(ThrottleTest, WithoutAPeriodEveryMessagePasses)
{
  Throttle throttle(0.0);
  EXPECT_EQ(throttle.pass(1.0), 0);
  EXPECT_EQ(throttle.pass(1.0), 0);
}

TEST(LineThrottleTest, EachLineOnceAPeriodAndOnlySomeDifferentOnes)
{
  LineThrottle lines(1.0, 3);
  int shown = 0;
  for (int k = 0; k < 2500; ++k)
    shown += lines.pass("the same", 10.0 + 0.001 * k) ? 1 : 0;
  EXPECT_EQ(shown, 3);
  for (int k = 0; k < 1000; ++k)  // a flood of different ones
    shown += lines.pass("line " + std::to_string(k), 20.0 + 0.0005 * k) ? 1 : 0;
  EXPECT_EQ(shown, 6);
  EXPECT_TRUE(lines.pass("another", 21.6));
}

}  // namespace
}  // namespace frictional_contact_sim
