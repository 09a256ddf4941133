// After the solve: outcome, report, dump.
#include <algorithm>
#include <map>
#include <mutex>

#include "frictional_contact_sim/problem/fclib.h"
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
/** `prefix`, with a number where another simulator of this process dumps there already. */
std::string uniquePrefix(const std::string& prefix)
{
  static std::mutex mutex;
  static std::map<std::string, int> users;
  const std::lock_guard<std::mutex> lock(mutex);
  const int user = ++users[prefix];
  return user == 1 ? prefix : prefix + "_run_" + std::to_string(user);
}
}  // namespace

void Simulator::Impl::finishStep()
{
  state.step += outcome.taken;
  if (outcome.taken)
    rememberGood();
  storeReport();
  storeOutcome();
  certifyStep();
}

void Simulator::Impl::storeOutcome()
{
  outcome.status = result.status;
  outcome.residual = result.residual;
  outcome.message = result.message;
  if (result.status == SolverStatus::CONVERGED)
  {
    outcome.message.clear();
    outcome.fclib_file.clear();
  }
}

void Simulator::Impl::storeReport()
{
  const IncrementalProblem& problem = assembly.problem();
  report.step = state.step + (outcome.taken ? 0 : 1);
  report.time = state.time();
  report.dt = context.dt;
  report.contacts = static_cast<int>(state.rows.contacts.size());
  report.contact_rounds = contact_set.rounds();
  report.velocities = assembly.velocities();
  report.bilaterals = problem.bilaterals();
  report.islands = countIslands();
  report.solver = result.solver;
  report.solvers_tried.clear();
  for (const std::string& name : result.tried)
  {
    if (!report.solvers_tried.empty())
      report.solvers_tried += ',';
    report.solvers_tried += name;
  }
  report.status = result.status;
  report.iterations = result.iterations;
  report.residual = result.residual;
  report.solve_time = result.seconds;
  report.bilateral_violation = assembly.bilateralViolation();
  report.max_penetration = 0.0;
  for (const ContactState& contact : state.rows.contacts)
    report.max_penetration = std::max(report.max_penetration, -contact.gap);
  EnergyLedger& energy = state.energy;
  if (outcome.taken)
  {
    bookEnergies();
    energy.balance_error = energy.kinetic + energy.potential - state.energy_start - energy.actuators + energy.friction +
                           energy.impact + energy.joints;
  }
  report.energy = energy;
  report.fclib_file = result.status == SolverStatus::CONVERGED ? "" : outcome.fclib_file;
}

/** Connected components of bodies through contacts with a nonempty row, and welds. */
int Simulator::Impl::countIslands()
{
  island_of.reset(static_cast<int>(bodies.size()));
  for (const ContactState& contact : state.rows.contacts)
  {
    const int a = collision.shape(contact.shape_a).body;
    const int b = collision.shape(contact.shape_b).body;
    if (a >= 0 && b >= 0 && bodies[a].model.nv > 0 && bodies[b].model.nv > 0)
      island_of.unite(a, b);
  }
  for (const std::vector<Closure>* closures : {&state.rows.loops, &state.rows.welds})
    for (const Closure& closure : *closures)
      if (closure.body_b >= 0 && bodies[closure.body_a].model.nv > 0 && bodies[closure.body_b].model.nv > 0)
        island_of.unite(closure.body_a, closure.body_b);
  int islands = 0;
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b)
    islands += bodies[b].model.nv > 0 && island_of.root(b) == b;
  return islands;
}

void Simulator::Impl::dumpProblem(const std::string& when)
{
  if (dump_folder.empty() || dumps_left == 0)
    return;
  --dumps_left;
  if (dump_name.empty())
    dump_name = uniquePrefix(dump_folder + "/" + scenario.name);
  outcome.fclib_file = dump_name + "_" + when + ".hdf5";
  try
  {
    FclibInfo info;
    info.title = scenario.name + " " + when;
    info.description =
        "w contains the shift of the normal law (gap/dt, restitution); bounded servos and dry joint "
        "friction are encoded as problem/fclib.h says";
    writeFclib(outcome.fclib_file, assembly.problem(), info);
  }
  catch (const std::exception& error)
  {
    outcome.fclib_file = std::string("not written: ") + error.what();
  }
}

}  // namespace frictional_contact_sim
