#pragma once
/**
 * @file fixed_point_check.h
 * @brief Is v a fixed point of F, and is that fixed point a solution?
 *
 *   s_i = |u_T,i|,  u = H v + w,  C(s) = { v' : H v' + w + E s in L*, G v' + b = 0 },  E s = mu_i s_i on normal rows
 *   fixed point   v minimises J(v') = 1/2 v'^T M v' + f^T v' over C(s): (M v + f).d >= 0 for every v + d in C(s)
 *   qualified     C(s) has an interior point: then an impulse r belongs to v, and v is a solution. It has one when s_i
 * > 0 everywhere, or where some certificate has u_i in int K*_i wherever s_i = 0 (theorem 3.20); here the largest
 * margin of H v' + w + E s over v' is looked for, which finds every such point solution      r in L with r_i = 0 where
 * a contact is open and on the edge opposite to the slip where it slides, M v + f = H^T r + G^T lambda
 *
 * Example 3.21: v = 0 is a fixed point, C(s) is a half-line without interior, and no r belongs to it; cones around K
 * that are refined show that an impulse would have to be larger than any number. So `least_impulse` is a lower bound of
 * sum r_N of every impulse that makes v a solution, and infinite where there is none.
 *
 * 2D and one-dimensional laws exactly, 3D by tangent planes (Kelley). DRY_FRICTION adds c |u| to J.
 * Source: Cadoux (2009), theorems 3.6, 3.20, example 3.21, (3.11).
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
struct FixedPointCheckOptions
{
  double tolerance = 1e-7;  ///< on velocities and momenta, relative to the largest of the problem [-], in (0, 1); on
                            ///< momenta 2e-4 at least where C(s) has no interior
  int max_rounds = 60;  ///< linear programs of each question, >= 1
  double runaway = 1e4;  ///< sum r_N above so many times |M v|, |f| over |H| counts as no impulse at all, which the
                         ///< simplex tolerance cannot tell from more [-], > 1

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

struct FixedPointReport
{
  Eigen::VectorXd slip;  ///< s, one a law, 0 where the law has none [m/s]
  double penetration = 0.0;  ///< largest -u_N and |G v + b| [m/s]: v must be in C(s)
  double descent = 0.0;  ///< -(M v + f).d of the best d with |d|_inf <= 1, an upper bound [N s]
  bool is_fixed_point = false;  ///< both within the tolerance
  double qualification = 0.0;  ///< largest margin of C(s), verified, with |v'|_inf bounded [m/s]
  bool qualified = false;  ///< it is positive
  std::vector<int> unqualified;  ///< laws that keep it from being so
  double least_impulse = 0.0;  ///< [N s], lower bound, infinite: no impulse belongs to v
  bool is_solution = false;  ///< a fixed point to which impulses belong

  /** @brief One line: what v is. */
  const char* verdict() const;
};

/** @throws std::invalid_argument on wrong shapes */
FixedPointReport checkFixedPoint(const IncrementalProblem& problem, const Eigen::VectorXd& v,
                                 const FixedPointCheckOptions& options = {});

}  // namespace frictional_contact_sim
