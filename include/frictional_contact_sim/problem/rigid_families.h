#pragma once
/**
 * @file rigid_families.h
 * @brief Families of free rigid bodies of any size: packings, chains and stacks of boxes under gravity.
 *
 *   velocities of a body: linear and angular velocity of its centre, world axes (6); M diagonal
 *   f = -M v_old - dt M g                    one time step from random velocities v_old of deviation `agitation`
 *   H^i = R^i [I, -[x_a]; -I, [x_b]]         x_a, x_b from the centres to the contact point
 *   w = 0                                    nothing outside moves: always solvable (Cadoux (2009), section 3.4.5)
 *
 * They complete the thesis's two families with what others judge by: granular media (Cadoux, section 5.1.1) with n
 * from 1 to 50 000 and more, hyperstatic stacks (3 n / rank H = p^2/2 for p x p points an interface) and mass ratios.
 */
#include <cstdint>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
/** @brief What both families have in common. */
struct RigidFamilyOptions
{
  double friction_min = 0.3;  ///< uniform between both [-]
  double friction_max = 0.3;  ///< [-]
  double mass_ratio = 1.0;  ///< largest mass over smallest, the smallest is 1 kg [-], >= 1
  double agitation = 0.1;  ///< standard deviation of the velocities before the step [m/s, rad/s]
  double time_step = 0.01;  ///< [s]
  double tilt = 0.0;  ///< angle of gravity from the vertical, about y [rad]
  std::uint64_t seed = 1;

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/**
 * @brief n contacts of balls (diameter 1 m, moved off a cubic lattice by a twentieth) with their neighbours and the
 * floor; masses log-uniform in the ratio.
 * @param width balls along x and y; 0: as many as make a cube; 1: a vertical chain
 */
IncrementalProblem granularProblem(int contacts, int width, const RigidFamilyOptions& options);

/**
 * @brief Cubes of 1 m on each other, p x p points an interface; masses grow upwards geometrically in the ratio (heavy
 * on light).
 */
IncrementalProblem boxStackProblem(int levels, int points_per_side, const RigidFamilyOptions& options);

}  // namespace frictional_contact_sim
