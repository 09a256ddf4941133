#include "frictional_contact_sim/ros/pacer.h"

#include <gtest/gtest.h>

#include "frictional_contact_sim/ros/step_publisher.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double ROUND_OFF = 1e-12;  // of sums of times of some seconds

TEST(PacerTest, WaitsUntilSimulatedTimeIsDue)
{
  Pacer pacer(2.0);
  pacer.restart(10.0, 100.0);
  EXPECT_NEAR(pacer.wait(10.5, 100.1), 0.15, ROUND_OFF);  // half a simulated second is a quarter on the wall
  EXPECT_EQ(pacer.wait(10.1, 100.06), 0.0);
}

TEST(PacerTest, NeverWaitsAtFreeRun)
{
  Pacer pacer(0.0);
  pacer.restart(0.0, 0.0);
  EXPECT_EQ(pacer.wait(1000.0, 0.0), 0.0);
}

TEST(PacerTest, CatchesUpSmallDelaysAndForgetsLargeOnes)
{
  Pacer pacer(1.0);
  pacer.restart(0.0, 0.0);
  EXPECT_EQ(pacer.wait(0.01, 0.05), 0.0);  // late by 0.04
  EXPECT_NEAR(pacer.wait(0.10, 0.06), 0.04, ROUND_OFF);  // still on the old schedule
  EXPECT_EQ(pacer.wait(0.11, 5.0), 0.0);  // a long stop
  EXPECT_NEAR(pacer.wait(0.12, 5.001), 0.009, ROUND_OFF);  // begins anew from there
}

TEST(PacerTest, MeasuresTheRealTimeFactor)
{
  Pacer pacer(0.0);
  pacer.restart(0.0, 0.0);
  for (int k = 1; k <= 1000; ++k)
  {
    pacer.measure(0.001 * k, 0.0005 * k);
  }
  EXPECT_NEAR(pacer.realTimeFactor(), 2.0, 1e-9);
}

TEST(StepDividerTest, PublishesAtTheRateAsked)
{
  const StepDivider every(0.0, 0.001);
  const StepDivider tenth(100.0, 0.001);
  const StepDivider too_fast(1e6, 0.001);
  int count = 0;
  for (std::uint64_t step = 1; step <= 1000; ++step)
  {
    EXPECT_TRUE(every.due(step));
    EXPECT_TRUE(too_fast.due(step));
    count += tenth.due(step) ? 1 : 0;
  }
  EXPECT_EQ(count, 100);
}

TEST(StepDividerTest, ARateNextToNothingIsNeverDue)
{
  for (const double rate : {1e-12, 1e-18, 1e-300, 5e-324})  // the last times a time step is zero
  {
    const StepDivider never(rate, 0.001);
    for (std::uint64_t step = 1; step <= 1000; ++step)
    {
      ASSERT_FALSE(never.due(step)) << rate;
    }
  }
}

}  // namespace
}  // namespace frictional_contact_sim
