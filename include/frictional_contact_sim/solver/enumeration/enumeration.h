#pragma once
/**
 * @file enumeration.h
 * @brief All solutions of a small problem, or the proof that there is none.
 *
 * Each law is in one of few modes, and in each of them its rows are linear:
 *
 *   law                    modes
 *   COULOMB_2D             open r = 0, u_N >= 0 | stick u = 0, r in K | right u_N = 0, u_T >= 0, r_T = -mu r_N
 *                          | left u_N = 0, u_T <= 0, r_T = mu r_N
 *   Coulomb with mu = 0    open r = 0, u_N >= 0 | stick u_N = 0, r_N >= 0        (r_T = 0)
 *   UNILATERAL             open r = 0, u >= 0   | stick u = 0, r >= 0
 *   DRY_FRICTION           stick u = 0, |r| <= c | right u >= 0, r = -c | left u <= 0, r = c
 *   COULOMB_3D             open | stick | slide u_N = 0, u_T = s d, s >= 0, r = r_N (1, -mu d), d a unit vector
 *
 * Depth first over the modes, u = W r + q and what the modes decided so far ask for as a linear program at each node
 * (undecided: r in the cone, u_N >= 0). A node is left where that program is infeasible, which is believed only when
 * its multipliers (Farkas) prove it again outside the simplex method, round-off bounded. A node is left too where a
 * quantity that its mode bounds on one side (u_T of `right`) is zero throughout: the same points are in the node with
 * that law sticking (or sliding), which the search sees elsewhere; without this a body at rest would be found 4^n
 * times. Polyhedral leaves are kept whole: vertices and rays by the double description method, the dimension from them.
 * Leaves that touch are one family, joined by a linear program on their intersection.
 *
 * 3D: cones are replaced by facets from outside (cut off where a sticking answer leaves its cone) and the direction of
 * slip by wedges of an angle, in which r is in the convex hull of an arc. When all modes are decided the equations of
 * the sliding contacts are solved by Newton; when their preconditioned Jacobian differs from the identity by less than
 * one over the whole wedge, the map is injective there, so that the wedge has that one solution or none; otherwise the
 * widest wedge is halved. Wedges smaller than min_angle that neither excludes are `unresolved`.
 *
 * complete = true   every node was closed: by a proof of infeasibility, by containment, as a polyhedral leaf (exact up
 *                   to round-off) or, with sliding in 3D, by the proof of injectivity. solutions = 0 with complete =
 *                   true says that no solution has impulses below impulse_bound times the problem's scale.
 * complete = false  a limit was reached or a node could be neither closed nor resolved; what is listed is still true.
 *
 * Cuts (off by default): where a complementarity of a law is violated at a node's point, the hull of both its sides is
 * cut off from the point, and the linear program solved again, up to cuts_per_node times
 * (src/solver/enumeration/mode_cuts.h); docs/facet_cuts.md says what they gain.
 *
 * Islands are enumerated apart and multiplied. Multipliers of redundant BILATERAL rows (lambda) do not count as
 * solutions of their own. Worst case exponential in the number of laws: deciding solvability is NP-complete (Cadoux
 * (2009), 1.4.6).
 *
 * Source: Cadoux (2009), (1.22), section 1.4, conclusion of part I; Motzkin, Raiffa, Thompson, Thrall (1953) for the
 * double description; Kearfott (1996) for existence and uniqueness by preconditioned Jacobians.
 */
#include <functional>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/certificate/uniqueness.h"
#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/solver/option_table.h"

namespace frictional_contact_sim
{
enum class LawMode
{
  UNDECIDED,
  OPEN,
  STICK,
  RIGHT,
  LEFT,
  SLIDE
};
const char* toString(LawMode mode);

/** @brief Which cuts are made of a violated complementarity. */
enum class EnumerationCuts
{
  NONE,
  MOST_VIOLATED,  ///< one, the sum of multipliers normalised
  DEEPEST,  ///< one, the farthest from the point
  FACETS  ///< those of the deepest one's decomposition
};

struct EnumerateOptions
{
  int max_nodes = 5000000;  ///< of an island's search tree, >= 1
  double time_limit = 0.0;  ///< wall clock [s], 0 = none
  int max_rows = 120;  ///< of an island; above, nothing is tried, >= 1
  int max_vertices = 1000;  ///< kept of a polytope; with more only its dimension is reported, >= 2
  int max_families = 1000;  ///< listed of the product of islands (the counts are right in any case), >= 1
  double impulse_bound = 1e6;  ///< of the proofs, on r sqrt(W_ii) over the largest |q| of the same scaling [-], >= 1
  double min_angle = 1e-4;  ///< half width of the smallest wedge of slip directions in 3D [rad]
  EnumerationCuts cuts = EnumerationCuts::NONE;
  int cuts_per_node = 5;  ///< rounds of cuts, each with a linear program, >= 1
  int cut_depth = 0;  ///< cuts at nodes with at most so many laws decided, >= 0; they hold below too

  /** @brief What each is, as data. */
  static const OptionTable<EnumerateOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @brief Solutions in one combination of modes: a point, or a polytope with its vertices and rays. */
struct SolutionPiece
{
  std::vector<LawMode> modes;  ///< one a law; BILATERAL laws STICK
  int dimension = 0;  ///< of the set of impulses
  bool bounded = true;
  bool unique_velocity = true;
  bool vertices_complete = true;  ///< false: more than max_vertices, or (3D) a cone that is no polytope
  std::vector<Eigen::VectorXd> vertices;  ///< r, at least one point of the piece [N s]
  std::vector<Eigen::VectorXd> rays;  ///< directions in which r may grow without bound
};

/** @brief A connected set of solutions. */
struct SolutionFamily
{
  int dimension = 0;  ///< of its largest piece; 0: an isolated solution
  bool bounded = true;
  bool unique_velocity = true;  ///< the same u (and v) throughout; then H^T r is the same too
  bool proved = true;  ///< false: Newton found it where a wedge could not be resolved (3D)
  Solution representative;  ///< the mean of the vertices of its first piece
  std::vector<SolutionPiece> pieces;
};

struct EnumerationReport
{
  bool complete = false;
  int solutions = 0;  ///< isolated ones
  int continua = 0;  ///< connected families of positive dimension
  std::vector<SolutionFamily> families;  ///< isolated ones first
  Uniqueness uniqueness = Uniqueness::UNKNOWN;
  bool unique_velocity = false;  ///< all solutions found have one velocity (and one H^T r)
  std::vector<int> unique_impulses;  ///< laws whose impulse is the same in all solutions found
  /**
   * Coulomb contacts where W_NN - mu |W_NT| < 0: friction of a pushing contact drives it into the ground. With none
   * everywhere no contact alone makes a paradox.
   */
  std::vector<int> jamming;
  std::string diagnosis;  ///< NONE, PENETRATION, PAINLEVE_INCONSISTENT, PAINLEVE_INDETERMINATE, see docs/enumeration.md
  long nodes = 0;
  long leaves = 0;  ///< pieces found
  long cuts = 0;  ///< added
  long unresolved = 0;  ///< nodes neither closed nor resolved
  double seconds = 0.0;  ///< wall clock [s]
  std::string message;  ///< one line
};

/** @param interrupted asked at every node; true ends the search */
EnumerationReport enumerate(const DelassusProblem& problem, const EnumerateOptions& options = {},
                            const std::function<bool()>& interrupted = {});
/** @brief The same for a global problem; families have v and lambda too. */
EnumerationReport enumerate(const IncrementalProblem& problem, const EnumerateOptions& options = {},
                            const std::function<bool()>& interrupted = {});

}  // namespace frictional_contact_sim
