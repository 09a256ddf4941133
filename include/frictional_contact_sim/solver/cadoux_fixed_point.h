#pragma once
/**
 * @file cadoux_fixed_point.h
 * @brief NA-pf: fixed-point iterations  s <- F(s)  on the slip speeds, F evaluated by a convex problem over the cones.
 *
 *   r_k+1 in argmin { 1/2 r^T W r + (q + E s_k)^T r : r in L }       (3.13)
 *   s_k+1 = |u_T(r_k+1)|                                             (3.16), (3.24)
 * Without friction anywhere F is constant and one convex problem solves everything (remark 4.18). The inner solver is
 * an argument; the operator form is the inner solver's (products W r only for the gradient methods).
 *
 * Source: Cadoux (2009), 4.7; Cadoux's method is ACLM in Siconos (Acary, Cadoux, Lemarechal, Malick 2011).
 * Departures: the inner tolerance follows the outer error (inexact inner solves; with a fixed low count of iterations,
 * as in the thesis, only inexact ones). The start is s = |u_T| of the guess, which for r = 0 is |q_T|; the thesis's
 * s = 0 (initial_slip ZERO) may be an unqualified fixed point (example 3.21). When the inner run shows that C(s) is
 * unqualified, s is raised once (perturbation argument of 3.3.2) instead of being accepted. A cycle of F is broken by
 * smaller steps.
 */
#include "frictional_contact_sim/solver/convex/inner_solver.h"
#include "frictional_contact_sim/solver/convex/slip_map.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
enum class InitialSlip
{
  ZERO,  ///< s = 0
  GUESS  ///< s = |u_T| of the guess
};

struct CadouxOptions
{
  double inner_accuracy = 0.1;  ///< inner tolerance relative to the outer error [-], in (0, 1)
  double relaxation = 1.0;  ///< s <- s + relaxation (F(s) - s) [-], in (0, 1]
  InitialSlip initial_slip = InitialSlip::GUESS;
  int cycle_window = 20;  ///< outer iterations without progress that halve the step (up to three times), >= 1
  int stall_window = 100;  ///< outer iterations without the residual falling by a tenth before giving up, >= 2
  InnerSolver inner = InnerSolver::SPECTRAL_GRADIENT;  ///< of the convex problems, where the constructor is given none

  /** @brief What each is, as data. */
  static const OptionTable<CadouxOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class CadouxFixedPoint : public Solver
{
public:
  explicit CadouxFixedPoint(const CadouxOptions& options = {}, std::unique_ptr<ConvexSolver> inner = nullptr);
  OperatorUse operatorUse() const override { return map_.operatorUse(); }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  CadouxOptions options_;
  SlipMap map_;
  Eigen::VectorXd s_;
};

}  // namespace frictional_contact_sim
