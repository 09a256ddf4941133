#pragma once
/**
 * @file run_settings.h
 * @brief What was set while a simulation ran, in place of what its scenario says.
 */
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/material.h"
#include "frictional_contact_sim/simulation/state_archive.h"

namespace frictional_contact_sim
{
/**
 * @brief Of each setting the last value, none where it was never set. Beside the state in its file, so that another
 * process goes on with the same bits; a reset keeps them.
 */
struct RunSettings
{
  std::optional<double> time_step;  ///< [s]
  std::optional<Eigen::Vector3d> gravity;  ///< [m/s^2]
  std::optional<std::string> solver;
  std::optional<double> tolerance;  ///< [-]
  std::optional<int> max_iterations;
  std::optional<double> default_friction;  ///< [-]
  std::vector<PairRule> friction;  ///< all of them, in the order they were set
};

/** @brief Shows every setting to an archive, in a fixed order. */
void visitSettings(StateArchive& archive, RunSettings& settings);

}  // namespace frictional_contact_sim
