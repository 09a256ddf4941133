#pragma once
/**
 * @file scenario_files.h
 * @brief Scenarios by name: those of the package need no path.
 */
#include <string>
#include <vector>

namespace frictional_contact_sim
{
/** @brief Names in config/scenarios of the package, sorted; empty where the package is not found. */
std::vector<std::string> packageScenarios();

/**
 * @brief The path of a file as it is; else, for a name without / and .yaml, the scenario of that name in the package.
 * @throws ConfigError when it is neither, with the nearest name; a folder is said to be one
 */
std::string findScenario(const std::string& name);

}  // namespace frictional_contact_sim
