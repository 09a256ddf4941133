#pragma once
/**
 * @file scenario_error.h
 * @brief What is thrown when a scenario file, or a file it names, is not what it must be.
 */
#include "frictional_contact_sim/config/config_error.h"

namespace frictional_contact_sim
{
/** @brief One line: file, line, key, what was found and what was expected. */
using ScenarioError = ConfigError;

}  // namespace frictional_contact_sim
