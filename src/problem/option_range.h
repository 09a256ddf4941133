#pragma once
/**
 * @file option_range.h
 * @brief One-line check of a generator's option.
 */
#include <sstream>
#include <stdexcept>

namespace frictional_contact_sim
{
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
