#include "frictional_contact_sim/dynamics/command_schedule.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
size_t CommandSchedule::next(double time) const
{
  return static_cast<size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
}

double CommandSchedule::target(double time) const
{
  const size_t k = next(time);
  if (k == 0)
    return targets.front();
  if (k == times.size())
    return targets.back();
  const double share = (time - times[k - 1]) / (times[k] - times[k - 1]);
  return (1.0 - share) * targets[k - 1] + share * targets[k];
}

double CommandSchedule::rate(double time) const
{
  const size_t k = next(time);
  return k == 0 || k == times.size() ? 0.0 : (targets[k] - targets[k - 1]) / (times[k] - times[k - 1]);
}

void CommandSchedule::validate() const
{
  if (times.size() != targets.size())
    throw std::invalid_argument("has " + std::to_string(times.size()) + " times and " + std::to_string(targets.size()) +
                                " targets, expected as many of both");
  for (size_t k = 0; k < times.size(); ++k)
    if (!std::isfinite(times[k]) || !std::isfinite(targets[k]) || (k > 0 && !(times[k] > times[k - 1])))
      throw std::invalid_argument("entry " + std::to_string(k) + " is at " + std::to_string(times[k]) +
                                  " s with target " + std::to_string(targets[k]) +
                                  ", expected finite numbers at increasing times");
}

}  // namespace frictional_contact_sim
