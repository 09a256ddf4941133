#include "frictional_contact_sim/ros/run_summary.h"

#include <algorithm>
#include <sstream>

namespace frictional_contact_sim
{
void RunSummary::add(const StepSummary& report, const StepOutcome& outcome)
{
  if (outcome.converged())
    worst_residual_ = std::max(worst_residual_, outcome.residual);
  else
    ++failed_;
  if (!outcome.taken)
    return;
  ++steps_;
  simulated_ += report.dt;
  deepest_ = std::max(deepest_, report.max_penetration);
}

std::string RunSummary::line(double real_time_factor) const
{
  std::ostringstream text;
  text << "end: " << steps_ << " steps, " << simulated_ << " s simulated";
  if (real_time_factor > 0.0)
    text << ", real-time factor " << real_time_factor;
  text << ", worst residual " << worst_residual_ << ", failed steps " << failed_ << ", deepest penetration " << deepest_
       << " m";
  return text.str();
}

}  // namespace frictional_contact_sim
