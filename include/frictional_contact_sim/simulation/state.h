#pragma once
/**
 * @file state.h
 * @brief Everything that decides the future of a simulation, as one value, and one visit of all of it.
 *
 * Hash, file and comparison are archives over visitState (state_archive.h), so what is added there is in all of them; a
 * reset or a rollout is a copy of the value.
 */
#include <cstdint>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/body.h"
#include "frictional_contact_sim/dynamics/energy_ledger.h"
#include "frictional_contact_sim/dynamics/row_source.h"
#include "frictional_contact_sim/dynamics/wedged_pairs.h"

namespace frictional_contact_sim
{
/**
 * @brief Time as start + k dt, so that no rounding adds up; both are set anew when dt changes.
 */
struct StepClock
{
  double start = 0.0;  ///< [s]
  std::uint64_t steps = 0;  ///< k

  double time(double dt) const { return start + static_cast<double>(steps) * dt; }
  void restart(double now)
  {
    start = now;
    steps = 0;
  }
};

struct SimulationState
{
  std::uint64_t step = 0;  ///< steps since the simulator was made; never reset
  double dt = 0.001;  ///< [s]
  StepClock clock;  ///< time of stamps; goes on over a reset
  StepClock scenario_clock;  ///< since the start or the last reset: what wrench windows see
  std::vector<BodyState> bodies;
  RowState rows;
  EnergyLedger energy;
  WedgedPairs wedged;
  double energy_start = 0.0;  ///< kinetic + potential when the ledger was started [J]

  double time() const { return clock.time(dt); }
};

class StateArchive;

/** @brief Shows every number and name of the state to an archive, in a fixed order. */
void visitState(StateArchive& archive, SimulationState& state);

/** @brief FNV-1a (Fowler, Noll, Vo 1991) over the bits of everything visited. */
std::uint64_t hashOf(const SimulationState& state);

/** @brief Name of the first entry whose bits differ, and its place; empty when the states are equal. */
std::string firstDifference(const SimulationState& a, const SimulationState& b);

}  // namespace frictional_contact_sim
