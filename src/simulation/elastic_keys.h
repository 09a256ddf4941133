#pragma once
// What a scenario says of a body that is elastic, or a rod.
#include "frictional_contact_sim/simulation/scenario_keys.h"

namespace frictional_contact_sim
{
/** `elastic` and those keys of bodyKeys that a body without joints and links has. */
ConfigKeys elasticBodyKeys(BodySpec& body);
/** The same of `rod`. */
ConfigKeys rodBodyKeys(BodySpec& body);

}  // namespace frictional_contact_sim
