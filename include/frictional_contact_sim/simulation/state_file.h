#pragma once
/**
 * @file state_file.h
 * @brief A simulation's state as a file: save now, go on later, in another process, with the same bits.
 *
 * Layout, little-endian: magic "FCSSTATE", u32 version, u64 length of the payload, u64 FNV-1a of the payload, payload:
 * the names and sizes of the bodies and joints it belongs to, what was set while it ran (visitSettings), then every
 * entry of visitState.
 */
#include <string>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief What a file has. */
struct SavedState
{
  SimulationState state;
  RunSettings settings;
};

/** @brief Writes beside `path` first and renames: a file is whole or not there. @throws StateError naming the file */
void saveState(const Simulator& simulator, const std::string& path);

/**
 * @brief The state in a file, of the simulator's bodies.
 * @throws StateError as loadState
 */
SavedState readState(const Simulator& simulator, const std::string& path);

/**
 * @brief Reads a state and goes on from it, under the settings of its run that were not the scenario's own; the others,
 * and the failure policy, stay the simulator's.
 * @throws StateError with one line that names the file, what was found and what was expected, for a file that is cut,
 * changed, of another version, or of other bodies; the simulator is then as it was
 */
const StepOutcome& loadState(Simulator& simulator, const std::string& path);

}  // namespace frictional_contact_sim
