#pragma once
/**
 * @file step_divider.h
 * @brief Every how many steps something is due. Pure.
 */
#include <cstdint>

namespace frictional_contact_sim
{
class StepDivider
{
public:
  /** @param rate per simulated second; 0 = every step. Rounded to a whole number of steps. */
  StepDivider(double rate, double time_step);
  void setTimeStep(double time_step);
  bool due(std::uint64_t step) const;

private:
  double rate_ = 0.0;
  std::uint64_t steps_ = 1;
};

}  // namespace frictional_contact_sim
