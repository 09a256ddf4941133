#pragma once
/**
 * @file existence.h
 * @brief Does the incremental problem have a solution? A sufficient criterion, checked by linear programming.
 *
 *   maximise s   subject to   H v + w - s e in L*,  G v + b = 0,  |v|_inf <= R                              (3.37)
 *
 * e_i = 1 on normal components; L* is the product of the dual cones, mu |u_T| <= u_N. Any v with
 * margin(v) = min_i (u_N - mu |u_T|) >= 0 proves a solution for every f and M (theorems 3.1 and 3.12); the maximum
 * measures how far the problem is from violating the criterion. In 2D one linear program is exact. In 3D the first one
 * works on a cone of `facets` facets inside L*, so that its v is a certificate; then facets outside L* are refined at
 * the current point (Kelley's cutting planes), which also bounds s from above.
 *
 *   CERTIFIED    v was checked again in floating point with outward rounding-error bounds: margin >= 0; or, exact =
 *                false, it is so for a w that differs from the given one by at most ROUND_OFF_UNITS units of round-off
 * of |H||v| + |w| in each row (a criterion without room, such as v = -v_0 where all that is outside moves as one rigid
 * body, w = H v_0, cannot be told closer) REFUTED      no v has u_N >= 0 at all contacts, so no friction can help: a
 * multiplier r_N >= 0, lambda with H_N^T r_N + G^T lambda = 0 and w_N.r_N + b.lambda < 0 was checked in the same way
 * (Farkas); r = 0 where the bilateral rows contradict each other UNDECIDED    neither; the criterion is not necessary.
 * criterion_violated says that a multiplier in L proves that no v satisfies it (remark 3.23 gives that in 2D only;
 * outer facets give it in 3D as well)
 *
 * Round-off leaves z = H^T r + G^T lambda at 1e-16 instead of 0; "no v" then reads: none below |v|_inf =
 * excluded_below, which must exceed 1e6 R. With bilateral rows v satisfies G v + b = 0 to round-off; the margin is
 * reduced by what the exact correction can cost, and redundant rows are taken as consistent. DRY_FRICTION rows bound r
 * and never hinder existence (they add a bounded convex term to the energy). For a local problem W stands for H and q
 * for w: range W = range H when W = H M^-1 H^T. A W that is not symmetric to 1e-3 of its largest entry, or not positive
 * semi-definite, is no such matrix; then nothing is CERTIFIED (REFUTED needs no property of W). Up to there its
 * symmetric part is judged, exact = false, and the message says so.
 *
 * Source: Cadoux (2009), section 3.5 and (3.35)-(3.38); theorem 3.1 is Klarbring and Pang's. The thesis prints + e s in
 * (3.35)-(3.37) and means - e s, as in (3.36).
 */
#include <Eigen/Core>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
enum class Existence
{
  CERTIFIED,
  REFUTED,
  UNDECIDED
};

/// Changes of w that a certificate may need, in DBL_EPSILON (|H||v| + |w|), where its margin is zero.
constexpr double ROUND_OFF_UNITS = 64.0;

/** @brief The constant's name, for messages. */
const char* toString(Existence existence);

struct ExistenceOptions
{
  double velocity_bound = 0.0;  ///< R [unit of v]; 0: 1e3 |w|_inf over the geometric mean of the contacts' |H_i|
  int facets = 8;  ///< of the first polyhedral cones in 3D, >= 3
  int max_rounds = 40;  ///< linear programs at most, >= 1
  int max_simplex_iterations = 200000;  ///< of each
  bool maximise = false;  ///< go on after the decision until the margin is known to `gap`
  double gap = 1e-3;  ///< relative to the margin [-]

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

struct ExistenceReport
{
  Existence verdict = Existence::UNDECIDED;
  double margin = 0.0;  ///< best verified margin(v) [m/s]; negative when none was found
  double upper_bound =
      0.0;  ///< no |v|_inf <= R has a larger margin, up to the simplex tolerance [m/s]; may be infinite
  Eigen::VectorXd v;  ///< where the margin is attained: the proof of CERTIFIED
  bool exact = true;  ///< CERTIFIED for this very w; false: for one within round-off of it
  double perturbation = 0.0;  ///< largest change of w that it needs [m/s], 0 when exact
  bool criterion_violated = false;  ///< proved: no v has margin >= 0
  Eigen::VectorXd multiplier;  ///< r of that proof or of REFUTED, in L; empty without
  double excluded_below = 0.0;  ///< of that proof [unit of v]
  Eigen::VectorXd bilateral_multiplier;  ///< lambda of that proof: BILATERAL laws first, then the rows of G
  std::vector<int> blocking;  ///< laws that bind at the maximum (their multipliers are not zero)
  std::vector<int> blocking_bilaterals;  ///< rows of G that do
  double velocity_bound = 0.0;  ///< the R used
  int rounds = 0;  ///< linear programs solved
  std::string message;  ///< one line: what was shown, or why nothing was
};

ExistenceReport checkExistence(const IncrementalProblem& problem, const ExistenceOptions& options = {});
/** @brief The same for u = W r + q; v and R are then impulses. */
ExistenceReport checkExistence(const DelassusProblem& problem, const ExistenceOptions& options = {});

}  // namespace frictional_contact_sim
