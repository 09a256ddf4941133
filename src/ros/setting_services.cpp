#include "frictional_contact_sim/ros/setting_services.h"

#include <cmath>
#include <filesystem>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/ros/services.h"
#include "frictional_contact_sim/solver/registry.h"

namespace frictional_contact_sim
{
namespace
{
/** A file of ~dump_dir that is not there yet. */
std::string newFile(const std::string& folder, const Simulator& simulator)
{
  if (folder.empty())
    throw RequestError("file: found '', expected a name, since ~dump_dir is not set");
  const std::string stem =
      folder + "/" + simulator.scenario().name + "_step_" + std::to_string(simulator.report().step);
  std::string file = stem + ".hdf5";
  for (int number = 2; std::filesystem::exists(file); ++number)
    file = stem + "_" + std::to_string(number) + ".hdf5";
  return file;
}
}  // namespace

void setFriction(const SetFriction::Request& request, Simulator& simulator)
{
  std::optional<double> restitution;
  if (!std::isnan(request.restitution))
    restitution = request.restitution;
  simulator.setFriction(request.a, request.b, request.friction, restitution);
}

void setSolver(const SetSolver::Request& request, Simulator& simulator)
{
  StoppingOptions stopping = simulator.scenario().stopping;
  if (request.max_iterations < 0)
    throw RequestError("max_iterations: found " + std::to_string(request.max_iterations) +
                       ", expected at least 1, or 0 to leave it");
  if (request.max_iterations > 0)
    stopping.max_iterations = request.max_iterations;
  if (!std::isnan(request.tolerance) && request.tolerance != 0.0)
    stopping.tolerance = request.tolerance;
  stopping.validate();
  if (!request.name.empty())
    findSolver(request.name);  // throws before anything is set
  if (!request.name.empty() && request.name != simulator.scenario().solver)
    simulator.setSolver(request.name);
  simulator.setStopping(stopping);
}

void dumpFclib(const DumpFclib::Request& request, const Simulator& simulator, const std::string& folder,
               DumpFclib::Response& response)
{
  if (!simulator.isProblemSolved())
    throw RequestError("there is no problem yet: no step since the start or since the state was set");
  const IncrementalProblem& problem = simulator.problem();
  if (problem.rows() == 0)
    throw RequestError("the problem of the last step has no contact and no other row: there is nothing to write");
  const std::string file = request.file.empty() ? newFile(folder, simulator) : request.file;
  if (std::filesystem::exists(file))
    throw RequestError("file: found '" + file + "', expected one that does not exist");
  FclibInfo info;
  info.title = simulator.scenario().name + " step " + std::to_string(simulator.report().step);
  info.description = "w contains the shift of the normal law (gap/dt, restitution); written by ~dump_fclib";
  if (request.local)
    writeFclib(file, reduce(problem), info, &simulator.solution());
  else
    writeFclib(file, problem, info, &simulator.solution());
  response.file = file;
}

void fillInfo(const Simulator& simulator, const NameTable& names, GetInfo::Response& response)
{
  const Scenario& scenario = simulator.scenario();
  response.version = FRICTIONAL_CONTACT_SIM_VERSION;
  response.scenario = scenario.name;
  response.time_step = scenario.time_step;
  response.simulated_time = simulator.time();
  response.steps = simulator.state().step;
  response.solver = scenario.solver;
  response.tolerance = scenario.stopping.tolerance;
  response.max_iterations = scenario.stopping.max_iterations;
  for (const SolverEntry& entry : solverRegistry())
    response.solvers.push_back(entry.name);
  response.bodies = names.bodies;
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    response.masses.push_back(simulator.model(body).totalMass());
    for (const Frame& frame : simulator.model(body).frames)
      response.links.push_back(simulator.bodyName(body) + "/" + frame.name);
  }
  for (const JointHandle& joint : names.joints)
    response.joints.push_back(joint.name);
  for (const int index : names.actuated)
    response.actuated_joints.push_back(names.joints[index].name);
  response.warnings = simulator.warnings();
}

}  // namespace frictional_contact_sim
