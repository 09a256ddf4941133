#pragma once
/**
 * @file convex_admm.h
 * @brief Alternating direction method of multipliers for the convex problem, splitting r = y, y in the sets.
 *
 *   (W + rho D^-1) r = rho D^-1 (y - x) - c,   D = diag(rho_i)
 *   r' = a r + (1 - a) y,   y <- P(r' + x),   x <- x + r' - y                x = scaled multiplier [N s]
 * rho [-] is balanced: every balance_interval iterations rho <- rho sqrt(primal/dual) when the ratio leaves [1/5, 5],
 *   primal = |D^-1 (r - y)|, dual = rho |D^-1 (y - y_old)| [m/s], and x is rescaled.
 * Operator: W explicit, one Cholesky factorization a value of rho. Fast to 1e-4 or 1e-6, then a long tail.
 *
 * Source: Boyd, Parikh, Chu, Peleato, Eckstein (2011), 3.3, 3.4.1, 3.4.3; balancing: He, Yang, Wang (2000).
 */
#include "frictional_contact_sim/solver/convex/convex_solver.h"
#include "frictional_contact_sim/solver/convex/shifted_factor.h"

namespace frictional_contact_sim
{
struct ConvexAdmmOptions
{
  int max_iterations = 2000;  ///< >= 1
  double penalty = 1.0;  ///< first rho [-], > 0
  double relaxation = 1.6;  ///< a [-], in (0, 2)
  int balance_interval = 20;  ///< iterations between two changes of rho, >= 1

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class ConvexAdmm : public ConvexSolver
{
public:
  explicit ConvexAdmm(const ConvexAdmmOptions& options = {});

protected:
  ConvexResult doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                       Eigen::VectorXd& u) override;

private:
  ConvexAdmmOptions options_;
  ShiftedFactor factor_;
  Eigen::VectorXd metric_, r_, y_, y_old_, x_, velocity_;
};

}  // namespace frictional_contact_sim
