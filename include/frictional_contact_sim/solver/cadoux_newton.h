#pragma once
/**
 * @file cadoux_newton.h
 * @brief NA-Newton: Newton's method on F(s) = s, the step from the linearised KKT system of the convex problem.
 *
 *   F + dF = s + ds,     du~ = W dr + E ds,     F_i dF_i = u_T,i . du~_T,i                              (4.27)
 *   (I - P') dr + rho P' du~ = 0,   P' = dP_L(r - rho u~)                                               (4.25)
 * v is eliminated (du~ = H dv + E ds, M dv = H^T dr); with S = Diag(u_T^T/F) and ds = F - s + S W dr it remains
 *   (I - P' + rho P' (W + alpha/rho + E S W)) dr = -rho P' E (F - s)                                    (4.28)
 * Singular without alpha when r(s) is not unique; only W dr enters ds, which is. Contacts with P' = 0 (take-off) have
 * dr = 0 and leave the system. Then Armijo's rule on 1/2 |F(s) - s|^2, at most line_search_steps halvings (each one
 * convex problem). Piecewise affine in 2D (4.7.7): F is affine on the piece of the present point, and land() solves the
 * whole problem on it, without alpha and with what the inner solver has left undone,
 *   (I - P' + rho P' G W) dr = -(r - P(r - rho u~)) - rho P' mu e (F - s)       least-norm least squares
 * so that the method ends with the first step from the right piece, whatever the tolerance; the answer is judged as
 * any. Dense LU of the active rows; W explicit, dense or block-sparse. The inner solver is an argument. Frictionless
 * contacts are not in s.
 *
 * Source: Cadoux (2009), 4.7.5, table 5.6. Departures: rho_i = 1/lambda_max(W_ii) in (4.25), where the thesis has 1;
 * the proximal term alpha/rho where the thesis takes the least-squares solution of least norm: a tenth of its cost, and
 * with hyperstatic bodies shorter, better steps; s >= 0 is kept; where the search fails s <- F(s) is taken.
 */
#include <vector>

#include "frictional_contact_sim/solver/convex/inner_solver.h"
#include "frictional_contact_sim/solver/convex/slip_map.h"
#include "frictional_contact_sim/solver/dense_lu.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct CadouxNewtonOptions
{
  double inner_accuracy = 0.01;  ///< inner tolerance relative to the outer error [-], in (0, 1)
  int line_search_steps = 12;  ///< halvings of the step, >= 0
  double sufficient_decrease = 1e-4;  ///< Armijo constant [-], in (0, 0.5)
  double proximal = 1e-2;  ///< alpha [-], in (0, 1)
  int max_rows = 4000;  ///< above it the method fails at once: the dense factor costs rows^3, >= 1
  int stall_window = 60;  ///< outer iterations without the residual falling by a tenth before giving up, >= 2
  InnerSolver inner = InnerSolver::SPECTRAL_GRADIENT;  ///< of the convex problems, where the constructor is given none

  /** @brief What each is, as data. */
  static const OptionTable<CadouxNewtonOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @brief ds of (4.28). Keeps its storage between calls. */
class CadouxNewtonStep
{
public:
  /** @brief Step from the map's present point; s is where it was evaluated. @return false when the system is singular
   */
  bool compute(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s, double alpha,
               Eigen::VectorXd& ds);
  int size() const { return active_; }  ///< of the last system
  /**
   * @brief In 2D the solution on the present piece. Dense orthogonal factor, rows^3.
   * @param r the map's impulses, moved there @return false when the problem is not planar, or too large for it
   */
  bool land(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s, Eigen::VectorXd& r);

private:
  void activate(const DelassusProblem& problem, const SlipMap& map);
  void setGaps(const DelassusProblem& problem, const SlipMap& map, const Eigen::VectorXd& s);
  void fill(const DelassusProblem& problem, const SlipMap& map, Eigen::Map<Eigen::MatrixXd>& system);
  template <int D>
  void fillRows(const DelassusProblem& problem, const SlipMap& map, int i, Eigen::Map<Eigen::MatrixXd>& system);

  double alpha_ = 0.0;
  int active_ = 0;  ///< rows with P' != 0
  Eigen::VectorXd x_;  ///< r - rho u~
  Eigen::VectorXd gap_;  ///< F - s, one a law, 0 where the law has no s
  Eigen::VectorXd speed_;  ///< F, likewise
  std::vector<SquareMatrix<3>> jacobian_;  ///< P', one a law
  std::vector<int> position_;  ///< row -> active row or -1
  Eigen::VectorXd right_, dr_, du_;
  DenseLu lu_;
  Eigen::MatrixXd system_;  ///< of land()
};

class CadouxNewton : public Solver
{
public:
  explicit CadouxNewton(const CadouxNewtonOptions& options = {}, std::unique_ptr<ConvexSolver> inner = nullptr);

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  CadouxNewtonOptions options_;
  SlipMap map_;
  CadouxNewtonStep newton_;
  Eigen::VectorXd s_, trial_, step_, fixed_point_;
  Eigen::VectorXd landed_, landed_u_;
};

}  // namespace frictional_contact_sim
