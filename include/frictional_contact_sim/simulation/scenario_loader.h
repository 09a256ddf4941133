#pragma once
/**
 * @file scenario_loader.h
 * @brief YAML (yaml-cpp) to Scenario: the one loader for node, tools, tests and benchmarks.
 */
#include <string>

#include "frictional_contact_sim/simulation/scenario.h"
#include "frictional_contact_sim/simulation/scenario_error.h"

namespace frictional_contact_sim
{
/** @throws ScenarioError */
Scenario loadScenarioFile(const std::string& path);
/** @brief The file with another number at one place, as ConfigNode::changed has it. @throws ScenarioError */
Scenario loadScenarioFile(const std::string& path, const std::string& key, double value);
/** @param source name for messages; relative paths are relative to its folder. @throws ScenarioError */
Scenario loadScenario(const std::string& yaml, const std::string& source);

}  // namespace frictional_contact_sim
