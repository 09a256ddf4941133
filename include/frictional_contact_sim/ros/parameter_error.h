#pragma once
/**
 * @file parameter_error.h
 * @brief What is thrown when a parameter of the node is not what it must be.
 */
#include "frictional_contact_sim/config/config_error.h"

namespace frictional_contact_sim
{
/** @brief One line: parameter, what was found, what was expected. */
using ParameterError = ConfigError;

}  // namespace frictional_contact_sim
