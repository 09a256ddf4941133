#pragma once
// Sensors of a body in a scenario file. Private to simulation/.
#include <vector>

#include "frictional_contact_sim/config/config_node.h"
#include "frictional_contact_sim/simulation/sensor.h"

namespace frictional_contact_sim
{
/** @brief A list of {type, link or joint, ...}. @throws ConfigError in one line */
std::vector<SensorSpec> readSensors(const ConfigNode& node);

}  // namespace frictional_contact_sim
