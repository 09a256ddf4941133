#pragma once
// The creep curve of a pair: a YAML file with the map creep_curve {friction, reference_load, creepage, traction}.
#include <memory>
#include <string>

#include "frictional_contact_sim/dynamics/creep_law.h"

namespace frictional_contact_sim
{
/** @throws ScenarioError: file, key, found, expected */
std::shared_ptr<const CreepTable> readCreepCurve(const std::string& path);

}  // namespace frictional_contact_sim
