#pragma once
/**
 * @file setting_services.h
 * @brief Services about how the simulation is computed, and what of it can be known.
 */
#include <frictional_contact_sim/DumpFclib.h>
#include <frictional_contact_sim/GetInfo.h>
#include <frictional_contact_sim/SetFriction.h>
#include <frictional_contact_sim/SetSolver.h>

#include "frictional_contact_sim/ros/names.h"

namespace frictional_contact_sim
{
/** @throws std::invalid_argument naming the field; nothing has changed then */
void setFriction(const SetFriction::Request& request, Simulator& simulator);

/** @brief Options of the method become its defaults when another method is named. @throws as setFriction */
void setSolver(const SetSolver::Request& request, Simulator& simulator);

/**
 * @brief Writes the problem that was solved last and its answer.
 * @param folder of files without a name, ~dump_dir
 * @throws RequestError when there is no such problem, the file exists or cannot be written
 */
void dumpFclib(const DumpFclib::Request& request, const Simulator& simulator, const std::string& folder,
               DumpFclib::Response& response);

/** @brief All but `paused`, which is the node's. */
void fillInfo(const Simulator& simulator, const NameTable& names, GetInfo::Response& response);

}  // namespace frictional_contact_sim
