#include "frictional_contact_sim/ros/diagnostics.h"

#include <algorithm>

namespace frictional_contact_sim
{
namespace
{
using Status = diagnostic_updater::DiagnosticStatusWrapper;
using Level = diagnostic_msgs::DiagnosticStatus;

constexpr double PERIOD = 1.0;  // wall clock [s]

unsigned char level(double value, double warning, double error)
{
  return value > error ? Level::ERROR : value > warning ? Level::WARN : Level::OK;
}
}  // namespace

void StepStatistics::add(const StepSummary& summary, bool converged, double step_seconds)
{
  ++steps;
  failed += converged ? 0 : 1;
  last_failed = !converged;
  worst_residual = std::max(worst_residual, summary.residual);
  max_penetration = std::max(max_penetration, summary.max_penetration);
  seconds += step_seconds;
  worst_seconds = std::max(worst_seconds, step_seconds);
}

void reportSolver(const StepStatistics& statistics, const RunState& run, Status& status)
{
  if (statistics.last_failed)
    status.summary(Level::ERROR, "the last step has no answer");
  else if (statistics.failed > 0)
    status.summary(Level::WARN, "steps without an answer");
  else
    status.summary(Level::OK, run.paused ? "paused" : "every step solved");
  status.add("steps", statistics.steps);
  status.add("failed steps", statistics.failed);
  status.addf("worst residual", "%.3g", statistics.worst_residual);
  status.addf("tolerance", "%.3g", run.tolerance);
}

void reportPenetration(const StepStatistics& statistics, Status& status)
{
  const unsigned char found = level(statistics.max_penetration, PENETRATION_WARNING, PENETRATION_ERROR);
  status.summary(found, found == Level::OK ? "nothing penetrates" : "bodies penetrate");
  status.addf("largest penetration [m]", "%.3g", statistics.max_penetration);
}

void reportTime(const StepStatistics& statistics, const RunState& run, Status& status)
{
  const bool paced = run.asked_factor > 0.0 && !run.paused && statistics.steps > 0;
  const double share = paced ? run.factor / run.asked_factor : 1.0;
  const unsigned char found = level(-share, -FACTOR_WARNING, -FACTOR_ERROR);
  status.summary(found, run.paused             ? "paused"
                        : found != Level::OK   ? "slower than asked for"
                        : run.asked_factor > 0 ? "keeps up"
                                               : "free run");
  status.addf("real-time factor", "%.3g", run.factor);
  status.addf("real-time factor asked for", "%.3g", run.asked_factor);
  const double steps = static_cast<double>(std::max<std::uint64_t>(1, statistics.steps));
  status.addf("mean step time [ms]", "%.3g", 1e3 * statistics.seconds / steps);
  status.addf("worst step time [ms]", "%.3g", 1e3 * statistics.worst_seconds);
}

void reportDelivery(const StepStatistics& statistics, const RunState& run, double period, Status& status)
{
  const bool held = statistics.held_seconds > HELD_WARNING * period;
  if (!run.dropped.empty())
    status.summary(Level::WARN, "subscribers drop messages");
  else
    status.summary(held ? Level::WARN : Level::OK, held ? "the run is held for subscribers" : "no one lags");
  status.addf("held for subscribers [s]", "%.3g", statistics.held_seconds);
  for (const auto& [subscriber, count] : run.dropped)
    status.add("dropped by " + subscriber, count);
}

DiagnosticsPublisher::DiagnosticsPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node,
                                           std::function<RunState()> run)
  : run_(std::move(run)), updater_(node, private_node)
{
  updater_.setHardwareID("none");
  updater_.add(
      "solver", [this](Status& status) { reportSolver(statistics_, state_, status); });
  updater_.add(
      "penetration", [this](Status& status) { reportPenetration(statistics_, status); });
  updater_.add(
      "time", [this](Status& status) { reportTime(statistics_, state_, status); });
  updater_.add("delivery", [this](Status& status) { reportDelivery(statistics_, state_, PERIOD, status); });
  // The updater's own period is of simulated time, which may stand still or run away.
  timer_ = node.createWallTimer(ros::WallDuration(PERIOD), [this](const ros::WallTimerEvent&) { report(); });
}

void DiagnosticsPublisher::addStep(const StepSummary& summary, bool converged, double seconds)
{
  statistics_.add(summary, converged, seconds);
}

void DiagnosticsPublisher::addHold(double seconds)
{
  statistics_.held_seconds += seconds;
}

void DiagnosticsPublisher::report()
{
  state_ = run_();
  updater_.force_update();
  statistics_ = StepStatistics();
}

}  // namespace frictional_contact_sim
