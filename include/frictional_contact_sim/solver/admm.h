#pragma once
/**
 * @file admm.h
 * @brief Proximal splitting on the law itself: alternating directions with De Saxce's shift, adaptive spectral rho.
 *
 *   (W + rho D^-1) r = rho D^-1 (y - x) - q - E s      D = diag(rho_i), rho [-]
 *   y <- P_L(r + x),   x <- x + r - y                  so that u~ = -rho D^-1 x is in L*, orthogonal to y
 *   s <- |u_T| = |rho D^-1 x_T|                        shift of the next iteration: E s = mu_i s_i on normal rows
 * Spectral rho (Xu, Figueiredo, Goldstein 2017), with differences since the last estimate:
 *   lambda^ = rho D^-1 (y_old - x_old - r),  lambda = -rho D^-1 x    multipliers before and after y's update [m/s]
 *   a = curvature of (dr, dlambda^),  b = curvature of (-dy, dlambda):  with sd = |dl|^2/<dz,dl>, mg = <dz,dl>/|dz|^2
 *   mg if 2 mg > sd, else sd - mg/2.   rho = sqrt(a b), or the one whose correlation <dz,dl>/(|dz||dl|) is trusted.
 *   Changes at iteration k are limited to the factor 1 + convergence/k^2.
 * Operator: W explicit, one Cholesky factorization each time rho changes. All laws.
 *
 * Source: Boyd et al. (2011); Tasora, Mangoni, Benatti, Garziera (2021) and Acary, Bremond, Huber (2018) for the shift;
 * Xu et al. (2017), "Adaptive ADMM with spectral penalty parameter selection", algorithm 1. Departures: D-weighted
 * products, so that units and mass ratios drop out; rho is kept while it would change by less than refactor_ratio.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/solver/convex/convex_problem.h"
#include "frictional_contact_sim/solver/convex/shifted_factor.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct AdmmOptions
{
  double penalty = 1.0;  ///< first rho [-], > 0
  int update_interval = 5;  ///< iterations between two spectral estimates, >= 1
  double correlation = 0.2;  ///< smallest correlation of a trusted curvature [-], in (0, 1)
  double convergence = 1e6;  ///< constant of the limit on changes of rho [-], > 0
  double refactor_ratio = 1.3;  ///< rho changes only by at least this factor, > 1

  /** @brief What each is, as data. */
  static const OptionTable<AdmmOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class Admm : public Solver
{
public:
  explicit Admm(const AdmmOptions& options = {});

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  void updateShift(const DelassusProblem& problem);
  bool refactor();
  double spectralPenalty(int iteration) const;
  void remember();

  AdmmOptions options_;
  ShiftedFactor factor_;
  ConvexProblem convex_;
  double penalty_ = 1.0;
  Eigen::VectorXd metric_, inverse_metric_;
  Eigen::VectorXd shift_;  ///< rho D^-1
  Eigen::VectorXd r_, y_, x_, u_;
  Eigen::VectorXd lambda_, lambda_hat_;  ///< multipliers [m/s]: after and before the update of y
  Eigen::VectorXd old_r_, old_y_, old_lambda_, old_lambda_hat_;
};

}  // namespace frictional_contact_sim
