#include "frictional_contact_sim/simulation/energy.h"

#include "frictional_contact_sim/model/dynamics_algorithms.h"

namespace frictional_contact_sim
{
namespace
{
/** Sum over a row of H of value times mean velocity; auxiliary columns of bounded servos are left out. */
double meanVelocity(const SparseRows& matrix, int row, const std::vector<Robot>& robots, int velocities)
{
  double sum = 0.0;
  size_t r = 0;
  for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
  {
    const int column = static_cast<int>(entry.col());
    if (column >= velocities)
      break;
    while (column >= robots[r].v_offset + robots[r].model.nv)
      ++r;
    sum += entry.value() * robots[r].v_middle[column - robots[r].v_offset];
  }
  return sum;
}

void bookContacts(const StepAssembly& assembly, const std::vector<Robot>& robots, const Solution& solution,
                  EnergyLedger& ledger)
{
  for (const ContactRow& contact : assembly.contactRows())
    for (int d = 0; d < 3; ++d)
    {
      const double impulse = solution.r[contact.row + d];
      const double velocity = meanVelocity(assembly.problem().H, contact.row + d, robots, assembly.velocities());
      const double lost = -impulse * (velocity + contact.base_velocity[d]);
      (d == 0 ? ledger.impact : ledger.friction) += lost;
      ledger.actuators -= impulse * contact.base_velocity[d];  // what the moving base puts in
    }
}

void bookJoints(const StepAssembly& assembly, const std::vector<Robot>& robots, const Solution& solution,
                EnergyLedger& ledger)
{
  for (const JointRow& row : assembly.jointRows())
  {
    const double work =
        solution.r[row.row] * meanVelocity(assembly.problem().H, row.row, robots, assembly.velocities());
    if (row.kind == JointRow::Kind::BOUNDED_SERVO)
      ledger.actuators += work;
    else
      ledger.joints -= work;
  }
  for (size_t k = 0; k < assembly.mimicRows().size(); ++k)
    ledger.joints -= solution.lambda[static_cast<int>(k)] *
                     meanVelocity(assembly.problem().G, static_cast<int>(k), robots, assembly.velocities());
}
}  // namespace

void bookWork(const StepAssembly& assembly, const std::vector<Robot>& robots, const Solution& solution, double dt,
              bool contact_only, EnergyLedger& ledger)
{
  bookContacts(assembly, robots, solution, ledger);
  bookJoints(assembly, robots, solution, ledger);
  if (contact_only)
    return;
  for (const Robot& robot : robots)
  {
    const auto new_velocity = solution.v.segment(robot.v_offset, robot.model.nv);
    ledger.actuators += dt * robot.external.dot(robot.v_middle);
    ledger.joints += dt * (robot.damping.array() * new_velocity.array() * robot.v_middle.array()).sum();
    for (size_t j = 0; j < robot.actuators.size(); ++j)
    {
      const Actuator& actuator = robot.actuators[j];
      if (actuator.bounded || !robot.isActuated(static_cast<int>(j)))
        continue;
      const int index = robot.velocityIndex(static_cast<int>(j));
      ledger.actuators +=
          (actuator.impulse.offset - actuator.impulse.stiffness * new_velocity[index]) * robot.v_middle[index];
    }
  }
}

void bookEnergies(const std::vector<Robot>& robots, const Eigen::Vector3d& gravity, EnergyLedger& ledger)
{
  ledger.kinetic = 0.0;
  ledger.potential = 0.0;
  for (const Robot& robot : robots)
  {
    if (robot.model.nv == 0)
      continue;
    ledger.kinetic += kineticEnergy(robot.model, robot.end);
    ledger.potential += potentialEnergy(robot.model, robot.end, gravity);
  }
}

}  // namespace frictional_contact_sim
