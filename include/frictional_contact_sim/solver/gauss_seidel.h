#pragma once
/**
 * @file gauss_seidel.h
 * @brief Nonsmooth Gauss-Seidel: contact by contact, each one solved exactly with the others' impulses frozen.
 *
 *   for i = 1..n:   r_i <- solution of  u_i = W_ii r_i + (q_i + sum_{j != i} W_ij r_j),  (u_i, r_i) in law_i
 *
 * With `conjugate`, sweeps are combined as gradients in the Fletcher-Reeves method: with d = the change of a sweep in
 * the metric of 1/rho_i and beta = |d_k|^2 / |d_k-1|^2,  p <- d + beta p,  r <- r + beta p before the next sweep, and p
 * <- d when beta > 1.
 *
 * Source: Cadoux (2009), 4.8.2; Jourdan, Alart, Jean (1998). The one-contact solver is solver/one_contact.h. Conjugate
 * sweeps: Silcowitz-Hansen, Niebe, Erleben (2010), "A nonsmooth nonlinear conjugate gradient method for interactive
 * contact force problems", with blocks solved exactly instead of rows projected.
 * Departures: a stall detector (the residual over the last window), and the residual is only evaluated when the change
 * of a sweep makes convergence likely, or every check_interval sweeps.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct GaussSeidelOptions
{
  int check_interval = 10;  ///< sweeps between two forced evaluations of the residual, >= 1
  int stall_window = 0;  ///< sweeps after which the residual must have fallen by stall_factor, 0 = no detector
  double stall_factor = 0.5;  ///< required ratio of residuals over a window [-], in (0, 1)
  bool conjugate = false;  ///< combine sweeps as conjugate gradients do
  double relaxation = 1.0;  ///< r_i <- r_i + relaxation (new - old) [-], in (0, 2)

  /** @brief What each is, as data. */
  static const OptionTable<GaussSeidelOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class GaussSeidel : public Solver
{
public:
  explicit GaussSeidel(const GaussSeidelOptions& options = {});
  void setOptions(const GaussSeidelOptions& options);

protected:
  std::unique_ptr<Solver> sibling() const override;
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  double sweep(const DelassusProblem& problem, Eigen::VectorXd& r) const;
  void extrapolate(const DelassusProblem& problem, const SolveContext& context, Eigen::VectorXd& r);

  GaussSeidelOptions options_;
  Eigen::VectorXd velocity_;
  Eigen::VectorXd previous_, direction_;  ///< conjugate sweeps: r before the last sweep, p
  double previous_square_ = 0.0;  ///< |d|^2 of the last but one sweep, 0 = there was none
};

}  // namespace frictional_contact_sim
