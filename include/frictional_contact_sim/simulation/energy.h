#pragma once
/**
 * @file energy.h
 * @brief Work of every impulse of one step: impulse times mean velocity over the step, which sums exactly to the change
 * of kinetic energy where M is constant (Moreau's midpoint rule).
 */
#include <vector>

#include "frictional_contact_sim/dynamics/assembly.h"
#include "frictional_contact_sim/simulation/step_report.h"

namespace frictional_contact_sim
{
/**
 * @brief Books the work of commands, wrenches, contacts and joint rows of a solved step.
 * @param robots v is still the old velocity, v_middle the mean of old and new one
 * @param contact_only an impact: commands, wrenches and damping do no work
 */
void bookWork(const StepAssembly& assembly, const std::vector<Robot>& robots, const Solution& solution, double dt,
              bool contact_only, EnergyLedger& ledger);

/** @brief Kinetic and potential energy of all robots at the end of the step. */
void bookEnergies(const std::vector<Robot>& robots, const Eigen::Vector3d& gravity, EnergyLedger& ledger);

}  // namespace frictional_contact_sim
