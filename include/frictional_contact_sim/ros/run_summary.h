#pragma once
/**
 * @file run_summary.h
 * @brief What a run of the node was, as the one line that it ends with.
 */
#include <cstdint>
#include <string>

#include "frictional_contact_sim/simulation/step_report.h"

namespace frictional_contact_sim
{
class RunSummary
{
public:
  void add(const StepSummary& report, const StepOutcome& outcome);
  /** @param real_time_factor mean over the run, 0 = not measured */
  std::string line(double real_time_factor) const;

private:
  std::int64_t steps_ = 0;  ///< taken
  std::int64_t failed_ = 0;  ///< without an answer, taken (held, accepted) or not
  double simulated_ = 0.0;  ///< [s]
  double worst_residual_ = 0.0;  ///< of the steps that have an answer
  double deepest_ = 0.0;  ///< penetration [m]
};

}  // namespace frictional_contact_sim
