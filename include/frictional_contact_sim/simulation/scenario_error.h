#pragma once
/**
 * @file scenario_error.h
 * @brief What is thrown when a scenario file, or a file it names, is not what it must be.
 */
#include <stdexcept>

namespace frictional_contact_sim
{
/** @brief One line: file, key, what was found and what was expected. */
class ScenarioError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

}  // namespace frictional_contact_sim
