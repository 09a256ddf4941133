#pragma once
/**
 * @file convex_interior_point.h
 * @brief Interior point for the convex problem: iterations of primal_dual_iteration.h until the optimality error of
 * (r, W r + c) is below the tolerance. Reaches round-off also when W is rank deficient.
 *
 * A guess is used when it is not zero: it is pushed inside by warm_shift times its own optimality error. When that run
 * gets stuck near the boundary a cold one follows.
 * Operator: W explicit (dense or block-sparse). Where the feasible set of (3.11) has no interior r grows without bound
 * and the method says STAGNATED or FAILED (Cadoux (2009), example 3.21).
 *
 * Source: see primal_dual_iteration.h.
 */
#include "frictional_contact_sim/solver/convex/convex_solver.h"
#include "frictional_contact_sim/solver/convex/primal_dual_iteration.h"

namespace frictional_contact_sim
{
struct ConvexInteriorPointOptions
{
  int max_iterations = 60;  ///< >= 1
  double warm_shift = 1.0;  ///< distance of a warm start from the boundary, relative to its error [-]; 0 = always cold
  PrimalDualOptions step;

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class ConvexInteriorPoint : public ConvexSolver
{
public:
  explicit ConvexInteriorPoint(const ConvexInteriorPointOptions& options = {});

protected:
  ConvexResult doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                       Eigen::VectorXd& u) override;

private:
  void run(const ConvexProblem& problem, const ConvexBudget& budget, double shift, Eigen::VectorXd& r,
           Eigen::VectorXd& u, ConvexResult& result);

  ConvexInteriorPointOptions options_;
  PrimalDualIteration iteration_;
};

}  // namespace frictional_contact_sim
