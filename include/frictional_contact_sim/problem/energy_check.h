#pragma once
/**
 * @file energy_check.h
 * @brief Whether an answer of the incremental problem creates energy: no law lets an impulse do work on its own u_i.
 *
 *     sum r_i . u_i  <=  10 tolerance * E_0  +  floor,       u = H v + w (with the law's shift),  E_0 = 1/2 f' M^-1 f
 *
 * since r.u = 1/2 v'Mv + 1/2 (v - v_free)'M(v - v_free) - 1/2 v_free'M v_free + r.w + lambda.b with v_free = -M^-1 f:
 * of exact answers r_N u_N = 0 and r_T.u_T <= 0. Errors within the residual's tolerance t leave about t S sum |r_i|;
 * the residual alone lets through what a self-stress makes of them. See docs/residuals.md.
 *
 * Where 10 t E_0 is exceeded, the energy of the answer, 1/2 v'Mv, counts as well. A
 * body at rest without gravity that a prescribed base hits has E_0 = 0 and an answer with energy; created energy is
 * part of 1/2 v'Mv itself, so that a share of 10 t of it remains the most that passes.
 *
 * floor = 64 eps sum_i |r_i| . (|H_i| |v| + |w_i|): the round-off of u_i, a sum of a few dozen products, times r_i. It
 * is evaluated only where the bound is exceeded.
 */
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
struct EnergyCheck
{
  double work = 0.0;  ///< sum r_i . u_i [J]
  double bound = 0.0;  ///< [J]
  /** @brief Written so that a NaN does not hold. */
  bool holds() const { return work <= bound; }
};

/**
 * @param solution v, u = H v + w and r
 * @param free_energy E_0 = 1/2 f' M^-1 f [J]: SolverResult and DelassusReduction have it at no cost
 * @param tolerance of the residual [-]
 */
EnergyCheck checkEnergy(const IncrementalProblem& problem, const Solution& solution, double free_energy,
                        double tolerance);

}  // namespace frictional_contact_sim
