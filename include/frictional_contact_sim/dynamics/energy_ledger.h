#pragma once
/**
 * @file energy_ledger.h
 * @brief Where the energy of a simulation went, booked since the start or the last reset [J].
 *
 * The work of an impulse is impulse times mean velocity over the step, which sums exactly to the change of kinetic
 * energy where M is constant (Moreau's midpoint rule).
 */
namespace frictional_contact_sim
{
struct EnergyLedger
{
  double kinetic = 0.0;
  double potential = 0.0;  ///< of gravity
  double actuators = 0.0;  ///< work done by commands, servos (springs and dampers), external wrenches
  double friction = 0.0;  ///< dissipated by tangential impulses of contacts; in an impact the sum with `impact` counts
  /// dissipated by the normal impulses of contacts (may be negative: see recovery); what a failed step under `hold`
  /// takes by stopping everything is an impact too
  double impact = 0.0;
  double joints = 0.0;  ///< dissipated by damping, dry friction and limits of joints
  double balance_error = 0.0;  ///< change of kinetic + potential - actuators + all dissipation
};

/** @brief Which entry of the ledger the impulse of a row belongs to. */
enum class WorkAccount
{
  IMPACT,  ///< normal impulse of a contact
  FRICTION,  ///< tangential impulse of a contact
  JOINTS,  ///< dissipated in a joint
  ACTUATORS  ///< work put in
};

}  // namespace frictional_contact_sim
