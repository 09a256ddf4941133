#pragma once
/**
 * @file haslinger.h
 * @brief H-pf: fixed-point iterations on the friction thresholds, a problem of Tresca at each.
 *
 *   r_k+1 in argmin { 1/2 r^T W r + q^T r : r in T(s_k) },   T(s) = prod { r_N >= 0, |r_T| <= s_i }      (4.17a)
 *   s_k+1,i = mu_i r_N,i                                                                              (4.17b)
 * s [N s] has one entry for each Coulomb contact; with mu = 0 it is zero and never changes, and without friction
 * anywhere one convex problem solves everything (remark 4.15). The inner solver is an argument; the operator form is
 * the inner solver's (products W r only for the gradient methods).
 *
 * Source: Haslinger (1983); Cadoux (2009), 4.6, (4.17). Departure: the inner tolerance follows the outer error.
 */
#include <limits>

#include "frictional_contact_sim/solver/convex/convex_solver.h"
#include "frictional_contact_sim/solver/convex/inner_solver.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct HaslingerOptions
{
  double inner_accuracy = 0.1;  ///< inner tolerance relative to the outer error [-], in (0, 1)
  double relaxation = 1.0;  ///< s <- s + relaxation (mu r_N - s) [-], in (0, 1]
  /// an outer iteration that leaves more than this share of the residual ends the run [-], > 0; by default none does
  double slowest = std::numeric_limits<double>::infinity();
  int stall_window = 100;  ///< outer iterations without the residual falling by a tenth before giving up, >= 2
  InnerSolver inner = InnerSolver::SPECTRAL_GRADIENT;  ///< of the convex problems, where the constructor is given none

  /** @brief What each is, as data. */
  static const OptionTable<HaslingerOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class Haslinger : public Solver
{
public:
  explicit Haslinger(const HaslingerOptions& options = {}, std::unique_ptr<ConvexSolver> inner = nullptr);
  OperatorUse operatorUse() const override { return inner_->operatorUse(); }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  void updateThresholds(const DelassusProblem& problem, double relaxation);

  HaslingerOptions options_;
  std::unique_ptr<ConvexSolver> inner_;
  ConvexProblem convex_;
  Eigen::VectorXd thresholds_, r_, u_;
};

}  // namespace frictional_contact_sim
