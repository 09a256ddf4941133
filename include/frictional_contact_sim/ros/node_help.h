#pragma once
/**
 * @file node_help.h
 * @brief simulator_node --help: every parameter with its unit and default (parameters_test holds it against what is
 * read).
 */
#include <string>
#include <vector>

namespace frictional_contact_sim
{
struct ParameterHelp
{
  std::string name;  ///< without ~
  std::string default_value;  ///< empty: not set
  std::string meaning;  ///< with its unit in brackets
};

const std::vector<ParameterHelp>& parameterHelp();
/** @brief The whole text. */
std::string nodeHelp();

}  // namespace frictional_contact_sim
