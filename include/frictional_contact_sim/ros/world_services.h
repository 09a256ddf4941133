#pragma once
/**
 * @file world_services.h
 * @brief ~attach, ~detach, ~spawn, ~delete as functions of a request and the simulator. All throw RequestError, or what
 * the simulator throws, before anything has changed.
 */
#include <frictional_contact_sim/Attach.h>
#include <frictional_contact_sim/Detach.h>
#include <frictional_contact_sim/Spawn.h>

#include "frictional_contact_sim/ros/frames.h"
#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/ros/parameters.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief The link that two fields of a request name; "world" and no link, or no link of that name: the world. */
LinkRef readLink(const std::string& side, const std::string& body, const std::string& link, const Simulator& simulator,
                 const NameTable& names);

void attach(const Attach::Request& request, Simulator& simulator, const NameTable& names, Attach::Response& response);
void detach(const Detach::Request& request, Simulator& simulator, const NameTable& names);

/** @brief What is to be spawned. @param find description parameters */
BodySpec readSpawn(const Spawn::Request& request, FrameResolver& frames, const FindDescription& find);
/** @brief Adds it. @throws RequestError when its impact has no answer and the failure policy leaves it out */
void spawn(const BodySpec& spec, Simulator& simulator);

}  // namespace frictional_contact_sim
