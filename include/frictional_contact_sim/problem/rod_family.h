#pragma once
/**
 * @file rod_family.h
 * @brief The thesis's rod problems `hair-m-n`: super-helices hanging from one moving support, in contact with each
 * other.
 *
 * A rod is clamped and made of pieces of constant material curvatures; q holds (twist, curvature 1, curvature 2) a
 * piece [1/m], so 3 velocities a piece, 18 a rod. With the material frame R(s) and the centre line x(s):
 *
 *   R' = R [q_k]x,  x' = R e_1                                      solved piece by piece in closed form (Rodrigues)
 *   omega(s) = int_0^s R(t) dq(t) dt,  v(p, s) = int_0^s (R(t) dq(t)) x (p - x(t)) dt     p fixed to the section at s
 *   M = int rho A J^T J + rho J_w^T I J_w ds + dt^2 K,   K = E I (stretches of piece) on curvatures, G I_p on twist
 *   f = -(M - dt^2 K) dq_old + dt (K (q - q_rest) - int rho A J^T g ds) + int rho A J^T (change of the support's v) ds
 *   H^i = R^i [J_a(p), -J_b(p)],  w = 0
 *
 * in the moving frame of the support: all external objects move as one rigid body, so a solution exists
 * (section 3.4.6). Contacts are the closest pairs of sections of different rods, the normal joins them, p is their
 * middle.
 *
 * Source: Cadoux (2009), section 5.1.3, tables 5.3 and 5.4; Bertails (2006) for super-helices. The thesis took its
 * problems from simulations that are not given: here shapes, velocities and the support's jerk are drawn at random, and
 * the rods cross each other instead of having been driven into contact. Its masses and radii are not given either
 * (ours: 0.2 m long, radius 1 mm, 1300 kg/m^3, E = 10 MPa, step 1 ms). Integrals by the midpoint rule, 16 points a
 * piece.
 */
#include <cstdint>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
struct RodFamilyOptions
{
  int rods = 2;  ///< >= 2
  int pieces = 6;  ///< of a rod, >= 1; m = 3 pieces rods
  int contacts = 3;  ///< n >= 0
  double friction = 0.2;  ///< [-]
  double curl = 10.0;  ///< standard deviation of q and of q_rest [1/m]
  double spacing = 0.005;  ///< between neighbouring roots [m]
  double agitation = 20.0;  ///< standard deviation of the velocities before the step [1/(m s)]
  std::uint64_t seed = 1;

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @throws std::invalid_argument also when the rods have fewer distinct close pairs than contacts */
IncrementalProblem rodFamilyProblem(const RodFamilyOptions& options);

/** @brief One line of table 5.3 or 5.4. */
struct RodFamilyEntry
{
  std::string name;  ///< hair-m-n; a second of the same name ends in -b
  RodFamilyOptions options;
};

/** @brief The 15 sizes of table 5.3 with our seeds. */
std::vector<RodFamilyEntry> smallRodFamily();
/** @brief The 15 sizes of table 5.4; hair-756-184 has 42 rods (the table prints 32, which is not 756/18). */
std::vector<RodFamilyEntry> largeRodFamily();

}  // namespace frictional_contact_sim
