#pragma once
/**
 * @file options_check.h
 * @brief One-line checks for the validate() of option structs.
 */
#include <sstream>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
/** @throws std::invalid_argument "<field> is <value>, expected <expected>" when the condition does not hold. */
template <typename Value>
inline void requireOption(bool condition, const char* field, Value value, const char* expected)
{
  if (condition)
    return;
  std::ostringstream message;
  message << field << " is " << value << ", expected " << expected;
  throw std::invalid_argument(message.str());
}
}  // namespace frictional_contact_sim
