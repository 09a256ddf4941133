#pragma once
/**
 * @file step_report.h
 * @brief What one step did, for messages, CSV and JSON. SI units; energies in J, booked since the start or last reset.
 */
#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
enum class ContactMode
{
  OPEN,
  STICKING,
  SLIDING,
  IMPACT
};
const char* toString(ContactMode mode);

/** @brief A contact at the end of a step. `a` and `b` are shape handles of Simulator::shape. */
struct ContactState
{
  std::uint64_t id = 0;
  int shape_a = 0;
  int shape_b = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< world, from b to a
  Eigen::Vector3d tangent_1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d tangent_2 = Eigen::Vector3d::UnitY();
  double gap = 0.0;  ///< at the midpoint of the step [m]
  double friction = 0.0;
  double restitution = 0.0;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  ///< on a, world [N s]; the force is impulse / dt
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of a relative to b, world, end of the step [m/s]
  ContactMode mode = ContactMode::OPEN;
  double residual = 0.0;  ///< |e_i| of this contact, natural map [m/s]
  double cone_margin = 0.0;  ///< mu r_N - |r_T| [N s]
};

struct EnergyLedger
{
  double kinetic = 0.0;
  double potential = 0.0;  ///< of gravity
  double actuators = 0.0;  ///< work done by commands, servos (springs and dampers), external wrenches
  double friction = 0.0;  ///< dissipated by tangential impulses of contacts; in an impact the sum with `impact` counts
  double impact = 0.0;  ///< dissipated by the normal impulses of contacts (may be negative: see recovery)
  double joints = 0.0;  ///< dissipated by damping, dry friction and limits of joints
  double balance_error = 0.0;  ///< change of kinetic + potential - actuators + all dissipation
};

/** @brief Not called StepReport: the generated message of that name lives in the same namespace. */
struct StepSummary
{
  std::uint64_t step = 0;  ///< steps since start, never reset
  double time = 0.0;  ///< at the end of the step [s]
  double dt = 0.0;  ///< [s]
  int contacts = 0;
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
  std::string fclib_file;  ///< dump of a failed step, else empty
};

}  // namespace frictional_contact_sim
