#pragma once
/**
 * @file command_schedule.h
 * @brief A command over time: its target goes from value to value in straight lines, before the first and after the
 * last one it stays. On the scenario's clock, which starts at 0 again at every reset.
 */
#include <cstddef>
#include <vector>

namespace frictional_contact_sim
{
struct CommandSchedule
{
  std::vector<double> times;  ///< [s], increasing
  std::vector<double> targets;  ///< one a time: of the command's mode, [N m], [rad], [rad/s] or [N], [m], [m/s]

  bool empty() const { return times.empty(); }
  double target(double time) const;
  /** @brief Slope of the target [1/s of its unit]; 0 before the first and after the last time. */
  double rate(double time) const;
  /** @throws std::invalid_argument unless lists are of one length, finite, times increasing */
  void validate() const;

private:
  /** @brief Index of the first time beyond `time`. */
  size_t next(double time) const;
};

}  // namespace frictional_contact_sim
