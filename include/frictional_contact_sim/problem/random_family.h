#pragma once
/**
 * @file random_family.h
 * @brief The thesis's random problems `alea-m-n`: sub-systems with random mass matrices, random pairs of them in
 * contact.
 *
 *   M = diag(M_1, M_2, ...)     M_k = Q_k diag(d) Q_k^T, Q_k from Gram-Schmidt on a Gaussian matrix, condition chosen
 *   H^i = R^i [.. B_a .. B_b ..]  two Gaussian blocks (3 x m_ss), a != b drawn at random
 *   w^i = R^i g,  f = g'          Gaussian
 *   R^i                           rows: the unit normal e^i, uniform on the sphere, and two tangents
 *   mu^i                          uniform in [0.2, 0.8]
 *
 * m velocities, n contacts, m_ss velocities a sub-system. Same input, same problem on every machine, up to round-off in
 * the products (problem/random_draw).
 *
 * Source: Cadoux (2009), section 5.1.2, tables 5.1 and 5.2. The thesis leaves the law of M_k open: here the extreme
 * values of d are condition^(-1/2) and condition^(1/2), the others log-uniform between. The thesis prints neither the
 * condition of M nor its seeds; ours are fixed below, so the draws are of the same family, not the same numbers.
 */
#include <cstdint>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
struct RandomFamilyOptions
{
  int velocities = 42;  ///< m, a multiple of subsystem_velocities, at least two sub-systems
  int contacts = 5;  ///< n >= 0, in 3D
  int subsystem_velocities = 6;  ///< m_ss
  double condition = 100.0;  ///< of each M_k [-], >= 1; 100 gives cond(W) as in table 5.1
  double external_velocity = 1.0;  ///< standard deviation of w [m/s]; 0: nothing outside moves, always solvable
  double friction_min = 0.2;  ///< [-]
  double friction_max = 0.8;  ///< [-]
  std::uint64_t seed = 1;

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

IncrementalProblem randomFamilyProblem(const RandomFamilyOptions& options);

/** @brief One line of table 5.1 or 5.2. */
struct RandomFamilyEntry
{
  std::string name;  ///< alea-m-n, for the large ones followed by the size of the sub-systems, since names repeat
  RandomFamilyOptions options;
};

/** @brief The 15 problems of table 5.1 with our seeds. */
std::vector<RandomFamilyEntry> smallRandomFamily();
/** @brief The 15 problems of table 5.2 with our seeds. */
std::vector<RandomFamilyEntry> largeRandomFamily();

}  // namespace frictional_contact_sim
