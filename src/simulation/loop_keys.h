#pragma once
// The key `loops` of a scenario.
#include "frictional_contact_sim/config/config_node.h"
#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
/** @brief Needs the scenario's bodies: a side without a body is the only one's, or that of the other side. */
void readLoops(const ConfigNode& node, Scenario& scenario);

}  // namespace frictional_contact_sim
