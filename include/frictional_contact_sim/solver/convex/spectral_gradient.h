#pragma once
/**
 * @file spectral_gradient.h
 * @brief Spectral projected gradient (SPG2) with a nonmonotone line search.
 *
 *   d = P(r - t D u) - r,   r <- r + a d,   u = W r + c
 *   a = 1 when f(r + d) <= max of the last `memory` values + gamma u^T d, else the minimiser of f on the segment
 *   t = Barzilai-Borwein's: alternately  d^T D^-1 d / d^T W d  and  d^T W d / (W d)^T D (W d)
 * f is quadratic: f(r + a d) - f(r) = a u^T d + a^2/2 d^T W d needs no product beyond W d.
 * Operator: products W x only, one an iteration.
 *
 * Source: Birgin, Martinez, Raydan (2000), algorithm 2.2; alternating steps: Dai, Fletcher (2005). Departure: the exact
 * step on the segment instead of backtracking.
 */
#include "frictional_contact_sim/solver/convex/convex_solver.h"

namespace frictional_contact_sim
{
struct SpectralGradientOptions
{
  int max_iterations = 2000;  ///< >= 1
  int memory = 10;  ///< function values the new one is compared with, in [1, 32]
  double sufficient_decrease = 1e-4;  ///< gamma [-], in (0, 1)
  double step_min = 1e-10;  ///< bounds of t: [-] with Metric::BLOCK, [kg] with Metric::UNIT, > 0
  double step_max = 1e10;
  Metric metric = Metric::BLOCK;

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class SpectralGradient : public ConvexSolver
{
public:
  explicit SpectralGradient(const SpectralGradientOptions& options = {});
  OperatorUse operatorUse() const override { return OperatorUse::PRODUCTS; }

protected:
  ConvexResult doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                       Eigen::VectorXd& u) override;

private:
  double spectralStep(int iteration) const;

  SpectralGradientOptions options_;
  Eigen::VectorXd metric_, change_, change_velocity_, r_, u_;
  double values_[32] = {};
};

}  // namespace frictional_contact_sim
