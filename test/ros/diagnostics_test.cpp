#include "frictional_contact_sim/ros/diagnostics.h"

#include <gtest/gtest.h>

namespace frictional_contact_sim
{
namespace
{
using Status = diagnostic_updater::DiagnosticStatusWrapper;
using Level = diagnostic_msgs::DiagnosticStatus;

StepStatistics steps(int count, double penetration)
{
  StepStatistics statistics;
  StepSummary summary;
  summary.residual = 3e-9;
  summary.max_penetration = penetration;
  for (int k = 0; k < count; ++k)
    statistics.add(summary, true, 0.002);
  return statistics;
}

std::string valueOf(const Status& status, const std::string& key)
{
  for (const diagnostic_msgs::KeyValue& value : status.values)
    if (value.key == key)
      return value.value;
  return "none";
}

TEST(DiagnosticsTest, FailedStepsAreAWarningAndAnErrorWhileTheyLast)
{
  StepStatistics statistics = steps(3, 0.0);
  Status status;
  reportSolver(statistics, RunState(), status);
  EXPECT_EQ(Level::OK, status.level);
  EXPECT_EQ("3e-09", valueOf(status, "worst residual"));
  statistics.add(StepSummary(), false, 0.1);
  reportSolver(statistics, RunState(), status);
  EXPECT_EQ(Level::ERROR, status.level);
  statistics.add(StepSummary(), true, 0.1);
  Status later;
  reportSolver(statistics, RunState(), later);
  EXPECT_EQ(Level::WARN, later.level);
  EXPECT_EQ("1", valueOf(later, "failed steps"));
}

TEST(DiagnosticsTest, PenetrationHasTwoLimits)
{
  for (const auto& [penetration, level] :
       {std::pair(1e-12, Level::OK), std::pair(1e-5, Level::WARN), std::pair(2e-3, Level::ERROR)})
  {
    Status status;
    reportPenetration(steps(2, penetration), status);
    EXPECT_EQ(level, status.level) << penetration;
  }
}

TEST(DiagnosticsTest, APacedRunThatLagsIsNamedAFreeOneIsNot)
{
  RunState run;
  run.asked_factor = 2.0;
  for (const auto& [factor, level] :
       {std::pair(1.99, Level::OK), std::pair(1.5, Level::WARN), std::pair(0.9, Level::ERROR)})
  {
    run.factor = factor;
    Status status;
    reportTime(steps(5, 0.0), run, status);
    EXPECT_EQ(level, status.level) << factor;
    EXPECT_EQ("2", valueOf(status, "mean step time [ms]"));
  }
  Status status;
  run.paused = true;
  reportTime(steps(5, 0.0), run, status);
  EXPECT_EQ(Level::OK, status.level);
  run.paused = false;
  run.asked_factor = 0.0;
  reportTime(steps(5, 0.0), run, status);
  EXPECT_EQ(Level::OK, status.level);
}

TEST(DiagnosticsTest, SubscribersThatLagOrLoseAreNamed)
{
  StepStatistics statistics = steps(5, 0.0);
  RunState run;
  Status status;
  reportDelivery(statistics, run, 1.0, status);
  EXPECT_EQ(Level::OK, status.level);
  statistics.held_seconds = 0.5;
  reportDelivery(statistics, run, 1.0, status);
  EXPECT_EQ(Level::WARN, status.level);
  run.dropped["/slow /joint_states"] = 7;
  reportDelivery(StepStatistics(), run, 1.0, status);
  EXPECT_EQ(Level::WARN, status.level);
  EXPECT_EQ("7", valueOf(status, "dropped by /slow /joint_states"));
}

}  // namespace
}  // namespace frictional_contact_sim
