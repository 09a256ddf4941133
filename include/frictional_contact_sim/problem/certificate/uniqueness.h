#pragma once
/**
 * @file uniqueness.h
 * @brief How many solutions the incremental problem can have, from W alone: proofs that there is at most one.
 *
 * UNIQUE_V    every two solutions have the same velocities; shown island by island by one of
 *   no friction   v minimises a strictly convex function over a convex set
 *   contraction   W regular and  sqrt(lambda_max(W_TT) lambda_max(E^T W^-1 E)) < 1,  E = diag(mu_i) on normal rows, T
 * the tangential rows of contacts with friction, rows scaled contact by contact by sqrt(rho_i). Then F of theorem 3.6
 * is a contraction: for two s the minima r of (3.13) have |W^1/2 dr| <= |W^-1/2 E ds| by monotony, and |dF| <= |W_T
 * dr|. (u, r) is unique too orientation   2D and one-dimensional laws: the law's graph is a piecewise linear image of
 * R^d with four pieces a contact (open, stick, slide right, slide left), two a one-dimensional law. Its map to q is a
 *                 homeomorphism, so that there is exactly one (u, r) for every q, if and only if the minors
 *                     det W[stick: N, T; slide: rows N, columns N +- mu T]
 *                 of all choices of pieces are positive. For mu = 0 these are the principal minors of W_NN: the P
 * property (theorem 4.3). The matrix A of (4.2) itself is never a P-matrix, its last diagonal block is zero MULTIPLE
 * two solutions with different v are known (the enumeration says so; nothing here does) UNKNOWN     neither
 *
 * Sources: Cadoux (2009), theorems 3.6, 4.3; Kuhn, Loewen (1987) and Scholtes (2012), theorem 2.3.7, for coherently
 * oriented piecewise affine maps with at most four pieces at every face of codimension two. The contraction is derived
 * here.
 */
#include <string>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
enum class Uniqueness
{
  UNIQUE_V,
  MULTIPLE,
  UNKNOWN
};
/** @brief The constant's name. */
const char* toString(Uniqueness uniqueness);

struct UniquenessOptions
{
  int max_pieces = 20000;  ///< choices of pieces of an island, >= 0; above it the minors are not looked at
  int max_rows = 600;  ///< of an island, >= 0: its matrices are dense
};

struct UniquenessReport
{
  Uniqueness verdict = Uniqueness::UNKNOWN;
  double contraction = 0.0;  ///< largest constant of the islands that needed it [-]; infinite where W is singular
  bool some_load_has_several = false;  ///< a minor is negative: the same W with another q has no or several solutions
  std::string message;  ///< one line: by what
};

/** @throws std::invalid_argument as validate(problem) */
UniquenessReport checkUniqueness(const DelassusProblem& problem, const UniquenessOptions& options = {});
/** @throws also when M is not positive definite */
UniquenessReport checkUniqueness(const IncrementalProblem& problem, const UniquenessOptions& options = {});

}  // namespace frictional_contact_sim
