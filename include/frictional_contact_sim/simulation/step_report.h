#pragma once
/**
 * @file step_report.h
 * @brief What one step did, for messages, CSV and JSON. SI units; energies in J, booked since the start or last reset.
 */
#include <cstdint>
#include <string>

#include "frictional_contact_sim/dynamics/contact_state.h"
#include "frictional_contact_sim/dynamics/energy_ledger.h"
#include "frictional_contact_sim/simulation/step_certificate.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
/** @brief What became of a step, a reset, a load or a set: the solve that it took, if it took one. */
struct StepOutcome
{
  SolverStatus status = SolverStatus::CONVERGED;
  double residual = 0.0;  ///< E of that solve
  std::string message;  ///< why it failed, one line; empty when converged
  std::string fclib_file;  ///< its problem, where a dump folder is set and it failed; else empty
  bool taken = true;  ///< false: the state is the one before it, to the bit (simulation/failure.h)
  bool converged() const { return status == SolverStatus::CONVERGED; }
};

/** @brief Not called StepReport: the generated message of that name lives in the same namespace. */
struct StepSummary
{
  std::uint64_t step = 0;  ///< steps since start, never reset; of a step that was not taken the one it would have been
  double time = 0.0;  ///< at the end of the step [s]
  double dt = 0.0;  ///< [s]
  int contacts = 0;
  int contact_rounds = 0;  ///< how often a look at an answer has changed the contact points of the step
  int velocities = 0;
  int bilaterals = 0;
  int islands = 0;
  std::string solver;  ///< method whose answer was taken
  std::string solvers_tried;  ///< comma separated
  SolverStatus status = SolverStatus::NOT_RUN;
  int iterations = 0;
  double residual = 0.0;
  double solve_time = 0.0;  ///< wall clock [s]
  double bilateral_violation = 0.0;
  double max_penetration = 0.0;  ///< max(0, -gap) at the midpoint [m]
  EnergyLedger energy;
  StepCertificate certificate;  ///< Scenario::certify_every
  std::string fclib_file;  ///< dump of a failed step, else empty
};

}  // namespace frictional_contact_sim
