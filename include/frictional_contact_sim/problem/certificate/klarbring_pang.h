#pragma once
/**
 * @file klarbring_pang.h
 * @brief Klarbring and Pang's condition itself, seen from the impulses.
 *
 *   value = min { w.r + b.lambda : r in L, H^T r + G^T lambda = 0, sum r_N = 1 }      (theorem 3.1: a solution exists
 *                                                                                      when value >= 0)
 *
 * r ranges over the self-stresses of the contacts. Where there are none (the set is empty, (3.34)) a solution exists
 * for every w: proved by a v with H v in int L*, G v = 0. The value is also the supremum of (3.36), that is of (3.37)
 * for R to infinity, so `lower` <= value <= `upper` come from two sides that are checked apart: a velocity with that
 * margin, an impulse r in L with that power and an error of equilibrium that is stated. L of 3D contacts is
 * approximated from outside by tangent planes where r leaves it (Kelley); in 2D one linear program is exact.
 *
 * Source: Klarbring, Pang (1998), theorem 4.1; Cadoux (2009), theorem 3.1, (3.34). BILATERAL laws count as rows of G,
 * DRY_FRICTION bounds r and takes no part.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/problem/existence.h"

namespace frictional_contact_sim
{
struct KlarbringPangReport
{
  bool unconditional = false;  ///< (3.34), proved by v: solvable for every w, f, M
  double lower = 0.0;  ///< of the value [m/s]; infinite when unconditional, -infinite when nothing is proved
  double upper = 0.0;  ///< [m/s]; infinite when unconditional or nothing was found
  Eigen::VectorXd v;  ///< margin of H v (unconditional) or of H v + w (else)
  Eigen::VectorXd r;  ///< self-stress of `upper` in L, sum r_N = 1
  Eigen::VectorXd lambda;  ///< BILATERAL laws first, then rows of G
  double equilibrium_error = 0.0;  ///< |H^T r + G^T lambda|_1, in the unit of H
  int rounds = 0;  ///< linear programs
};

KlarbringPangReport klarbringPang(const IncrementalProblem& problem, int max_rounds = 60);
/** @brief With W for H and q for w. */
KlarbringPangReport klarbringPang(const DelassusProblem& problem, int max_rounds = 60);

}  // namespace frictional_contact_sim
