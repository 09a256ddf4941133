#pragma once
/**
 * @file parameter_error.h
 * @brief What is thrown when a parameter of the node is not what it must be.
 */
#include <stdexcept>

namespace frictional_contact_sim
{
/** @brief One line: parameter, what was found, what was expected. */
class ParameterError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

}  // namespace frictional_contact_sim
