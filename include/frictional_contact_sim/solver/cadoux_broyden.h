#pragma once
/**
 * @file cadoux_broyden.h
 * @brief NA-Broyden: Broyden's first ("good") quasi-Newton method on G(s) = F(s) - s = 0.
 *
 *   s_k+1 = s_k - B_k G(s_k),   B_0 = -I   (the first step is the fixed point's)
 *   B_k+1 = B_k + (ds - B_k dG) ds^T B_k / (ds^T B_k dG)              inverse update by Sherman and Morrison
 * B is kept as -I plus a sum of rank-one terms, at most `memory`, then reset. No line search, as in the thesis.
 * The inner solver is an argument; the operator form is the inner solver's. Frictionless contacts are not in s.
 *
 * Source: Broyden (1965); Cadoux (2009), 4.7, table 5.5. Departures: s >= 0 is kept; when |G| exceeds divergence times
 * the best value B is reset and the fixed-point step taken from the best s.
 */
#include <vector>

#include "frictional_contact_sim/solver/convex/inner_solver.h"
#include "frictional_contact_sim/solver/convex/slip_map.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct CadouxBroydenOptions
{
  double inner_accuracy = 0.01;  ///< inner tolerance relative to the outer error [-], in (0, 1)
  int memory = 50;  ///< rank-one terms kept, >= 1
  double divergence = 10.0;  ///< growth of |G| over its best value that resets B [-], > 1
  int stall_window = 100;  ///< outer iterations without the residual falling by a tenth before giving up, >= 2
  InnerSolver inner = InnerSolver::SPECTRAL_GRADIENT;  ///< of the convex problems, where the constructor is given none

  /** @brief What each is, as data. */
  static const OptionTable<CadouxBroydenOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class CadouxBroyden : public Solver
{
public:
  explicit CadouxBroyden(const CadouxBroydenOptions& options = {}, std::unique_ptr<ConvexSolver> inner = nullptr);
  OperatorUse operatorUse() const override { return map_.operatorUse(); }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  Eigen::VectorXd apply(const Eigen::VectorXd& x) const;
  Eigen::VectorXd applyTransposed(const Eigen::VectorXd& x) const;
  void update(const Eigen::VectorXd& ds, const Eigen::VectorXd& dG);

  CadouxBroydenOptions options_;
  SlipMap map_;
  std::vector<Eigen::VectorXd> left_, right_;  ///< B = -I + sum left right^T
};

}  // namespace frictional_contact_sim
