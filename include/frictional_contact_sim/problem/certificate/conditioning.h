#pragma once
/**
 * @file conditioning.h
 * @brief Rank of H and condition of W = H M^-1 H^T.
 *
 *   M = C C^T,  Z = H C^-T,  W = Z Z^T:  rank H = rank Z, by QR with column pivoting (pivots above min(rows, nv) eps of
 *   the largest),  condition = (largest / smallest singular value of these)^2
 *
 * So the condition is that of W on its range: finite where bodies touch in more points than they have freedom, and the
 * condition of W where H has full row rank. From Z, since squaring would hide half of the digits; of a local problem
 * from the eigenvalues of W. BILATERAL laws and rows of G are left out. Dense: rows^2 nv multiplications.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
struct Conditioning
{
  int rows = 0;  ///< of H
  int rank = -1;  ///< of H, -1: not computed
  double condition = 0.0;  ///< of W on its range [-], >= 1; 0: not computed, or no rows
  bool computed() const { return rank >= 0; }
};

/** @param max_rows more rows or velocities than that are not computed. @throws std::invalid_argument unless M is
 * positive definite */
Conditioning conditioning(const IncrementalProblem& problem, int max_rows = 1500);
Conditioning conditioning(const DelassusProblem& problem, int max_rows = 1500);

/** @brief |W - W'| over |W|, largest entries; W compressed. */
double relativeAsymmetry(const SparseRows& W);

/**
 * @brief How far W is from H M^-1 H^T for some H and M, relative to its largest entry: the largest entry of W - W^T, or
 * infinite where the symmetric part has an eigenvalue below -rows max(1e-8, that).
 */
double delassusDefect(const SparseRows& W);

}  // namespace frictional_contact_sim
