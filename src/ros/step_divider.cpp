#include "frictional_contact_sim/ros/step_divider.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
StepDivider::StepDivider(double rate, double time_step) : rate_(rate)
{
  setTimeStep(time_step);
}

void StepDivider::setTimeStep(double time_step)
{
  if (rate_ > 0.0)
  {
    // No run has so many steps; and beyond 2^63 llround has no answer.
    constexpr double NEVER = 1e18;
    steps_ = static_cast<std::uint64_t>(std::max(1LL, std::llround(std::min(NEVER, 1.0 / (rate_ * time_step)))));
  }
}

bool StepDivider::due(std::uint64_t step) const
{
  return step % steps_ == 0;
}

}  // namespace frictional_contact_sim
