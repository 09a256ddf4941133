#pragma once
/**
 * @file throttle.h
 * @brief Lets a message through at most once a period and counts those held back. Pure: wall-clock time is an argument.
 */
#include <limits>
#include <optional>

namespace frictional_contact_sim
{
class Throttle
{
public:
  /** @param period [s]; 0 = every message passes */
  explicit Throttle(double period);

  /** @return how many were held back since the last one that passed; nothing when this one is held back too */
  std::optional<int> pass(double wall);
  int heldBack() const;

private:
  double period_;
  double last_ = -std::numeric_limits<double>::infinity();
  int held_back_ = 0;
};

}  // namespace frictional_contact_sim
