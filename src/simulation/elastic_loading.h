#pragma once
// An elastic body of a scenario, in the three parts of body_loading.h.
#include "body_loading.h"

namespace frictional_contact_sim
{
/** @throws ModelError, one line */
BodyModel loadElastic(const BodySpec& spec);
/** Frame, velocity, wrenches, motion. @throws std::invalid_argument */
void setElasticState(const BodySpec& spec, const Draft& body);
/** Its nodes as shapes. */
void placeElastic(const BodySpec& spec, const Draft& body, WorldModel& world);

}  // namespace frictional_contact_sim
