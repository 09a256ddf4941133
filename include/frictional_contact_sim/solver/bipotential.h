#pragma once
/**
 * @file bipotential.h
 * @brief bipotential: minimises De Saxce's bipotential over the cones.
 *
 *   min  r . u~(r) = r . (W r + q) + sum_i mu_i r_N,i |u_T,i(r)|    over r in L, u_N(r) >= 0              (4.12)
 *
 * The minimum is zero and attained exactly at the solutions. Other laws add  r u over r, u >= 0 (unilateral),
 * r u + c |u| over |r| <= c (dry friction), u = 0 (bilateral).
 *
 * The problem is neither convex (r_N |u_T|) nor smooth (|u_T| where a contact sticks). Local method, in the variables
 * of solver/scaled_contacts.h: copies x = z and w = W z + q, the product linearised about the last iterate,
 * r_N |u_T| ~ a |w_T| + s x_N with a = x_N, s = |w_T|, and one sweep of the alternating direction method:
 *
 *   z   minimises  z . (W z + q) + sigma/2 |z - x + alpha|^2 + sigma/2 |W z + q - w + beta|^2   (one factor for all)
 *   x = P_L(z + alpha - (mu s / sigma) e_N)
 *   w = max(0, .) of the normal and soft threshold mu a / sigma of the tangential part of W z + q + beta
 *   alpha += z - x,  beta += W z + q - w
 *
 * sigma must outweigh the negative curvature of the product: with sigma = 1 sliding contacts cycle (measured), from 2
 * on they converge. Fixed points are the stationary points of (4.12) with multipliers sigma (alpha, beta), which are
 * -(u, r) at a solution. It is a first-order method: linear convergence at best, none guaranteed, and a stationary
 * point need not be a solution. Dense Cholesky: refuses more than `max_rows` rows.
 *
 * Source: De Saxce, Feng (1998); Cadoux (2009), 4.3.1, (4.12). Departure: the thesis names SQP as a candidate and gives
 * no method; the splitting is ours (Boyd et al. 2011), the linearised product is the first step of such an SQP.
 */
#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/scaled_contacts.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct BipotentialOptions
{
  double penalty = 3.0;  ///< sigma at the start, in scaled variables [-], >= smallest_penalty
  double smallest_penalty = 2.0;  ///< sigma never falls below; must outweigh the curvature of mu r_N |u_T| [-], > 0
  int balance_interval = 50;  ///< iterations between two looks at sigma, >= 1
  double balance_ratio = 10.0;  ///< sigma changes when one of the two residuals is that much larger [-], > 1
  double relaxation = 1.6;  ///< over-relaxation of z in the other two steps [-], in [1, 2)
  int max_rows = 4000;  ///< rows above which the dense factor is refused, >= 1

  /** @brief What each is, as data. */
  static const OptionTable<BipotentialOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class Bipotential : public Solver
{
public:
  explicit Bipotential(const BipotentialOptions& options = {});
  void setOptions(const BipotentialOptions& options);
  OperatorUse operatorUse() const override { return OperatorUse::DENSE; }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  bool factor();
  void sweep();
  void updateCopies();
  bool balance();

  BipotentialOptions options_;
  ScaledContacts scaled_;
  Eigen::MatrixXd matrix_, squared_, shifted_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  double sigma_ = 1.0;
  Eigen::VectorXd z_, c_, x_, w_, alpha_, beta_, rhs_, relaxed_z_, relaxed_c_, old_x_, old_w_, r_, u_;
};

}  // namespace frictional_contact_sim
