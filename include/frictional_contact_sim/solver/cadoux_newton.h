#pragma once
/**
 * @file cadoux_newton.h
 * @brief NA-Newton: Newton's method on F(s) = s, the step from the linearised KKT system of the convex problem.
 *
 *   F + dF = s + ds,     du~ = W dr + E ds,     F_i dF_i = u_T,i . du~_T,i                              (4.27)
 *   (I - P') dr + rho P' du~ = 0,   P' = dP_L(r - rho u~)                                               (4.25)
 * v is eliminated (du~ = H dv + E ds, M dv = H^T dr); with S = Diag(u_T^T/F) and ds = F - s + S W dr it remains
 *   (I - P' + rho P' (W + E S W)) dr = -rho P' E (F - s)                                                (4.28)
 * which is singular when r(s) is not unique, and is solved by least squares of least norm. Then Armijo's rule on
 * 1/2 |F(s) - s|^2, at most line_search_steps halvings (each one convex problem). Piecewise affine in 2D: there the
 * last step is exact (4.7.7). Sizes: rows x rows, dense, W explicit. The inner solver is an argument. Frictionless
 * contacts are not in s.
 *
 * Source: Cadoux (2009), 4.7.5, table 5.6. Departures: rho_i = 1/lambda_max(W_ii) in (4.25), where the thesis has 1;
 * s >= 0 is kept; where the search fails the fixed-point step s <- F(s) is taken.
 */
#include "frictional_contact_sim/solver/convex/slip_map.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct CadouxNewtonOptions
{
  double inner_accuracy = 0.01;  ///< inner tolerance relative to the outer error [-], in (0, 1)
  int line_search_steps = 12;  ///< halvings of the step, >= 0
  double sufficient_decrease = 1e-4;  ///< Armijo constant [-], in (0, 0.5)
  double rank_threshold = 1e-10;  ///< pivots below this share of the largest count as zero [-], in (0, 1)
  int max_rows = 900;  ///< above it the method fails at once: the least-squares solve costs rows^3, >= 1
  int stall_window = 60;  ///< outer iterations without the residual falling by a tenth before giving up, >= 2

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @brief ds of (4.28) at the map's present point; s is the point it was evaluated at. */
Eigen::VectorXd cadouxNewtonStep(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s,
                                 double rank_threshold);

class CadouxNewton : public Solver
{
public:
  explicit CadouxNewton(const CadouxNewtonOptions& options = {}, std::unique_ptr<ConvexSolver> inner = nullptr);
  OperatorUse operatorUse() const override { return OperatorUse::DENSE; }

protected:
  void doSolve(const DelassusProblem& problem, SolverResult& result) override;

private:
  CadouxNewtonOptions options_;
  SlipMap map_;
};

}  // namespace frictional_contact_sim
