#pragma once
/**
 * @file polar_oracle.h
 * @brief The oracle of a disjunction: min d_0.d over the reverse polar, as the linear program (7.15).
 *
 *   d = A_k^T u_k,  b_k.u_k + |b_kj| lambda_k = -1,  u_k, lambda_k >= 0   for every term k, j its most violated row
 *   sum over k of (sum over i != j of u_ki + lambda_k) <= N                                       (7.27)
 *
 * which is (7.14) of a split with u_kj = (1 + b.u_k) / |b_kj| + lambda_k put back as a variable; terms with several
 * violated rows are allowed. d_0 enters costs only, so each call goes on from the last basis (primal simplex method).
 *
 * Q^- is unbounded. With N finite (the thesis) it is truncated, and what is extreme by the truncation exposes no facet
 * (remark 7.22); with N = 0, no bound, the oracle returns rays instead (7.2), which the thesis leaves open.
 *
 * An empty term (7.3.3): {A_k^T u_k} is then part of Q_k^- only, so cuts are valid still, yet fewer. A vertex in the
 * space of multipliers need not be one of Q^- (7.3.4, figure 7.8): where the minimum is not unique, a second, generic
 * function is minimised over the face of minimisers, so that what is returned is extreme where that face has an
 * extreme point which the second function finds (it may be unbounded there both ways).
 *
 * Source: Cadoux (2009), theorem 7.16, (7.14), (7.15), remarks 7.17, 7.18, section 7.3.
 */
#include "frictional_contact_sim/separation/disjunction.h"
#include "frictional_contact_sim/separation/nearest_point.h"

namespace frictional_contact_sim
{
class PolarOracle
{
public:
  /**
   * @param bound N of (7.27), 0: none
   * @throws std::invalid_argument when the origin is in a term: nothing separates it
   */
  explicit PolarOracle(const Disjunction& disjunction, double bound = 0.0);

  /** @brief Minimises direction.d; EMPTY when N is too small (or, without N, when nothing separates). */
  OracleAnswer operator()(const Eigen::VectorXd& direction);
  /** @brief The face {d; direction.d least} from now on, direction as in the call before (7.1.4). */
  void restrictToFace(const Eigen::VectorXd& direction);

  /** @brief u_k of the last answer. */
  Eigen::VectorXd multipliers(size_t term) const;
  /** @brief The left-hand side of (7.27) at the last answer. */
  double multiplierSum() const;

private:
  Eigen::VectorXd costs(const Eigen::VectorXd& direction) const;
  bool minimise(const Eigen::VectorXd& direction);
  void fixFace();
  void goToExtremePoint();

  std::vector<Polyhedron> terms_;
  std::vector<int> firsts_;  ///< column of u_k; lambda_k follows
  std::vector<int> pivots_;
  LinearProgram program_;
  Eigen::VectorXd solution_;
  Eigen::VectorXd lower_, upper_, row_lower_, row_upper_;
  Eigen::VectorXd generic_;  ///< n numbers without relation
  bool feasible_ = false;
};

/** @brief Which linear normalisation a most violated cut has (remark 6.12). */
enum class Normalisation
{
  MULTIPLIERS,  ///< (7.27): remark 7.18
  LIFT_AND_PROJECT,  ///< sum of all multipliers, those of the violated rows too
  ONE_NORM,  ///< |d|_1 <= 1: the deepest cut in the maximum norm
  MAXIMUM_NORM  ///< |d|_inf <= 1: the deepest cut in the 1-norm
};

struct ViolatedCut
{
  bool found = false;  ///< false: no cut, or the simplex method lost its digits
  Eigen::VectorXd direction;  ///< d in Q^-, scaled to violation 1: d.x <= -1 on Q
  double violation = 0.0;  ///< -nu before that scaling, in units of the normalisation
  std::vector<Eigen::VectorXd> multipliers;  ///< u_k >= 0 of direction = A_k^T u_k, b_k.u_k <= -1, one vector a term
};

/**
 * @brief The cut generating linear program: the cut that the origin violates most, min nu with d.x <= nu on Q.
 * @param bound N of MULTIPLIERS, > 0; not used by the others
 */
ViolatedCut mostViolatedCut(const Disjunction& disjunction, Normalisation normalisation, double bound = 0.0);

struct IntersectionCut
{
  bool found = false;  ///< false: the origin is no vertex of the common polyhedron
  Eigen::VectorXd direction;  ///< d in Q^-
  double bound = 0.0;  ///< N = sum of the multipliers of (7.26), the least with which this cut fulfils (7.27)
  std::vector<int> basis;  ///< rows of `common`
};

/**
 * @brief (7.24)-(7.26) at a vertex of `common`, of terms with one row each: c_k = A_B^-T pi_k / delta_k for the row
 * pi_k.x <= -delta_k, d = A_B^T max_k c_k, multipliers max c - c_k >= 0. Of the active rows the first that are
 * independent (column-pivoted QR) are the basis.
 */
IntersectionCut intersectionCut(const Disjunction& disjunction);

}  // namespace frictional_contact_sim
