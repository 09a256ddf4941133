#pragma once
/**
 * @file throttle.h
 * @brief Lets a message through at most once a period and counts those held back. Pure: wall-clock time is an argument.
 */
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>

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

/** @brief The same for different lines at once: each of them once a period, and never more than a few different ones.
 */
class LineThrottle
{
public:
  /** @param period [s] @param most different lines within a period */
  LineThrottle(double period, size_t most);

  /** @return whether this line may be shown */
  bool pass(const std::string& line, double wall);

private:
  double period_;
  size_t most_;
  std::map<std::string, double> shown_;  // when
};

}  // namespace frictional_contact_sim
