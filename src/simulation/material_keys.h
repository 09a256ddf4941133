#pragma once
// The table of materials: default, materials by name, pairs.
#include "frictional_contact_sim/simulation/scenario_keys.h"

namespace frictional_contact_sim
{
/** @throws ConfigError */
void readMaterials(const ConfigNode& node, MaterialTable& table);

}  // namespace frictional_contact_sim
