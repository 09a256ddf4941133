#pragma once
/**
 * @file regime.h
 * @brief What a step is: motion in time, or a sequence of equilibria.
 */
namespace frictional_contact_sim
{
/**
 * @brief Cadoux (2009), section 1.5.2: statics and quasi-statics are the same problem with displacements and gaps in
 * place of velocities.
 */
enum class Regime
{
  DYNAMIC,
  QUASI_STATIC,  ///< every step starts from rest: q_k+1 = q_k + dt v, no inertia where K holds a body
  STATIC  ///< one such step with the whole load
};

}  // namespace frictional_contact_sim
