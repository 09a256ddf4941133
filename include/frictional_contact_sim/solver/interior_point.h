#pragma once
/**
 * @file interior_point.h
 * @brief Primal-dual interior point with Nesterov-Todd scaling, Cadoux's slip speeds s changed after every iteration.
 *
 *   W r + q + E s = A^T z,   x = A r in Q,   z in Q,   x o z = sigma m e          (primal_dual_iteration.h)
 *   s <- |u_T|,   u = W r + q,   E s = mu_i s_i on the normal rows
 *   sigma m >= slip_centring rho e^2     e = E of the residual times its scale [m/s], rho the mean step length [kg]
 * The lower bound keeps the iterates central while s still moves; it falls with the error. Solving the cone problem to
 * the end for each s instead is CadouxFixedPoint with ConvexInteriorPoint as its inner solver.
 * Operator: W explicit, dense or block-sparse; one Cholesky factorization an iteration, positive definite also when W
 * is rank deficient. All laws. The rate near the solution is that of the fixed point on s: linear.
 *
 * Source: Nesterov, Todd (1997); Cadoux (2009), (3.13), (3.24) and 4.7.2 (conic form, there by SeDuMi); s changed every
 * iteration: Acary, Armand, Nguyen, Shpakovych (2022). A guess is used when it is not zero. A run that stalls starts
 * again, cold, with a tenth of slip_centring.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/solver/convex/convex_problem.h"
#include "frictional_contact_sim/solver/convex/primal_dual_iteration.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
class OuterLoop;

struct InteriorPointOptions
{
  double slip_centring = 0.1;  ///< lower bound of sigma m relative to rho e^2 [-], in (0, 1)
  double warm_shift = 1.0;  ///< distance of a warm start from the boundary, relative to its error [-]; 0 = always cold
  int stall_window = 40;  ///< iterations without the residual falling by a tenth before a restart, >= 2
  int restarts = 3;  ///< >= 0
  PrimalDualOptions step;

  /** @brief What each is, as data. */
  static const OptionTable<InteriorPointOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class InteriorPoint : public Solver
{
public:
  explicit InteriorPoint(const InteriorPointOptions& options = {});

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  bool run(const DelassusProblem& problem, const SolveContext& context, double shift, double slip_centring,
           OuterLoop& loop, SolverResult& result);
  void updateSlip(const DelassusProblem& problem);

  InteriorPointOptions options_;
  PrimalDualIteration iteration_;
  ConvexProblem convex_;
  bool frictional_ = false;
  Eigen::VectorXd u_, guess_;
};

}  // namespace frictional_contact_sim
