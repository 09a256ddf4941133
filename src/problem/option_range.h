#pragma once
/**
 * @file option_range.h
 * @brief One-line check of a generator's option, and bounds.
 */
#include <sstream>
#include <stdexcept>

namespace frictional_contact_sim
{
// Upper bounds of options that several families have.
constexpr int MAX_COUNT = 10000000;
constexpr double MAX_SPEED = 1e9;  ///< [m/s, rad/s]; of a time step [s]
constexpr double MAX_FRICTION = 1e6;

/** @throws std::invalid_argument "<family>: <option> is <value>, expected a number from <least> to <most>", also for
 * NaN. */
template <typename Value>
inline void requireRange(const char* family, const char* option, Value value, Value least, Value most)
{
  if (value >= least && value <= most)
    return;
  std::ostringstream message;
  message << family << ": " << option << " is " << value << ", expected a number from " << least << " to " << most;
  throw std::invalid_argument(message.str());
}
}  // namespace frictional_contact_sim
