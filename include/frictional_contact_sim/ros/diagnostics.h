#pragma once
/**
 * @file diagnostics.h
 * @brief /diagnostics: whether steps have answers, nothing penetrates, time keeps up and messages arrive.
 */
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief Of all steps since the last report. */
struct StepStatistics
{
  std::uint64_t steps = 0;
  std::uint64_t failed = 0;
  bool last_failed = false;
  double worst_residual = 0.0;
  double max_penetration = 0.0;  ///< [m]
  double seconds = 0.0;  ///< wall clock of all steps [s]
  double worst_seconds = 0.0;  ///< of one [s]
  double held_seconds = 0.0;  ///< wall clock that the run was held for subscribers [s]

  /** @param seconds wall clock of the step [s] */
  void add(const StepSummary& summary, bool converged, double seconds);
};

/** @brief What is not counted step by step. */
struct RunState
{
  bool paused = false;
  double asked_factor = 1.0;  ///< ~real_time_factor, 0 = free run
  double factor = 0.0;  ///< measured
  double tolerance = 0.0;
  std::map<std::string, std::int64_t> dropped;  ///< messages, by subscriber
};

// Levels: docs/interfaces.md. A penetration is one that a solved step of ours never leaves; a paced run may lag a
// little.
constexpr double PENETRATION_WARNING = 1e-6;  ///< [m]
constexpr double PENETRATION_ERROR = 1e-3;  ///< [m]
constexpr double FACTOR_WARNING = 0.95;  ///< of the factor asked for
constexpr double FACTOR_ERROR = 0.5;
constexpr double HELD_WARNING = 0.1;  ///< of the wall clock between two reports

void reportSolver(const StepStatistics& statistics, const RunState& run,
                  diagnostic_updater::DiagnosticStatusWrapper& status);
void reportPenetration(const StepStatistics& statistics, diagnostic_updater::DiagnosticStatusWrapper& status);
void reportTime(const StepStatistics& statistics, const RunState& run,
                diagnostic_updater::DiagnosticStatusWrapper& status);
/** @param period wall clock between two reports [s] */
void reportDelivery(const StepStatistics& statistics, const RunState& run, double period,
                    diagnostic_updater::DiagnosticStatusWrapper& status);

/** @brief Sends the four once a second of wall clock, whatever simulated time does. */
class DiagnosticsPublisher
{
public:
  DiagnosticsPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node, std::function<RunState()> run);

  void addStep(const StepSummary& summary, bool converged, double seconds);
  void addHold(double seconds);

private:
  void report();

  std::function<RunState()> run_;
  RunState state_;
  StepStatistics statistics_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace frictional_contact_sim
