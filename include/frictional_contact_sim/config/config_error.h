#pragma once
/**
 * @file config_error.h
 * @brief What is thrown when a file, a parameter or an argument is not what it must be.
 */
#include <stdexcept>

namespace frictional_contact_sim
{
/** @brief One line: file and line or parameter, key, what was found and what was expected. */
class ConfigError : public std::invalid_argument
{
public:
  using std::invalid_argument::invalid_argument;
};

}  // namespace frictional_contact_sim
