#pragma once
/**
 * @file yaml_config.h
 * @brief YAML documents as ConfigNodes.
 */
#include <string>

#include "frictional_contact_sim/config/config_node.h"

namespace frictional_contact_sim
{
/**
 * @param source name for messages; relative paths are relative to its folder
 * @throws ConfigError "SOURCE:LINE: not valid YAML: ..."; also for a key that stands twice in a map or is no text, and
 * for documents that grow without bound by their aliases
 */
ConfigNode parseYaml(const std::string& text, const std::string& source);

/** @param what "a scenario file", for messages. @throws ConfigError also when there is no file, or a folder */
ConfigNode loadYaml(const std::string& path, const std::string& what);

}  // namespace frictional_contact_sim
