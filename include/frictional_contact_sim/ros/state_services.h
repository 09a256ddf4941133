#pragma once
/**
 * @file state_services.h
 * @brief Services that save, set and tell the state. A refusal (an exception) leaves the state as it was, to the bit.
 */
#include <frictional_contact_sim/GetLinkState.h>
#include <frictional_contact_sim/LoadState.h>
#include <frictional_contact_sim/SaveState.h>
#include <frictional_contact_sim/SetJointPositions.h>
#include <frictional_contact_sim/SetLinkState.h>

#include <optional>

#include "frictional_contact_sim/ros/frames.h"
#include "frictional_contact_sim/simulation/state_file.h"

namespace frictional_contact_sim
{
/** @brief The slot in memory of ~save_state and ~load_state. */
using StateSlot = std::optional<SavedState>;

void storeState(const SaveState::Request& request, const Simulator& simulator, StateSlot& slot,
                SaveState::Response& response);

/**
 * @brief Goes on from a saved state, to the bit. Time and step count become those of the saved state where they are
 * later, and else go on as they are: they never run back. What was set in the saved run (solver, friction, gravity,
 * time step) is set again; what it had from its scenario stays as it is here.
 */
void restoreState(const LoadState::Request& request, const StateSlot& slot, Simulator& simulator,
                  LoadState::Response& response);

/** @brief The base of a floating body so that a link has this pose and velocity; joints keep positions and velocities.
 */
void placeLink(const SetLinkState::Request& request, const NameTable& names, FrameResolver& frames,
               Simulator& simulator, SetLinkState::Response& response);

/** @param stamp of the present state */
void readLinkState(const GetLinkState::Request& request, const NameTable& names, FrameResolver& frames,
                   const Simulator& simulator, GetLinkState::Response& response);

/** @brief Joints that are not named stay; mimic joints follow; commands stay. */
void setJointPositions(const SetJointPositions::Request& request, const NameTable& names, Simulator& simulator,
                       SetJointPositions::Response& response);

}  // namespace frictional_contact_sim
