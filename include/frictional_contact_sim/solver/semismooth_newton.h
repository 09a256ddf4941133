#pragma once
/**
 * @file semismooth_newton.h
 * @brief Semismooth Newton on a contact function Phi(r) = f(W r + q, r), u eliminated, with proximal regularisation.
 *
 *   outer   centre c = r,  u_alpha(r) = W r + q + alpha D (r - c),   D = diag(1/rho_i)
 *   inner   (A (W + alpha D) + B) dr = -f(u_alpha, r),   A = df/du, B = df/dr block-diagonal
 *           r <- r + t dr, t by a nonmonotone backtracking (Grippo, Lampariello, Lucidi 1986) on 1/2 |Phi/rho|^2,
 *           and the full step where no t decreases it (a watchdog: the inner budget ends a bad excursion) or where it
 *           meets the tolerance
 *   c <- r and alpha <- alpha / 10 once the inner error is a tenth of the proximal perturbation |alpha D (r - c)|, or
 *   when a step makes the error ten times smaller; alpha x 5 (at least proximal_restart) and back to c after a failure
 * alpha [-] is relative to the Delassus entries. With rigid bodies A W + B is singular as a rule (Cadoux (2009),
 * D.1.4); alpha D makes it regular, and the limit of the proximal iteration from a centre is, among the solutions, one
 * near it: near zero for a cold start, near the last step's impulses for a warm one. Contacts predicted open are
 * eliminated before the factorization: their impulse goes to zero. Dense LU with partial pivoting up to DENSE_LIMIT
 * active rows, solver/sparse_lu.h beyond, the ordering reused while the set of active rows stays.
 *
 * The contact function is an argument: Alart-Curnier (ac_newton) here, others are one ContactMap each.
 * Source: Alart, Curnier (1991); Cadoux (2009), 4.2, 4.3, appendix D; Acary, Bremond, Huber (2018), section on the
 * proximal point algorithm, for the rule on alpha. Departure: inexact inner solves, stopped when the inner error is
 * below a tenth of the proximal perturbation or the error of the problem itself falls tenfold; a small alpha's effect
 * on a step from the centre is taken out again by one step of iterated Tikhonov regularisation.
 */
#include <Eigen/Core>
#include <memory>

#include "frictional_contact_sim/math/contact_functions.h"
#include "frictional_contact_sim/solver/dense_lu.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
/** @brief A contact function with Jacobians, for 3D and 2D Coulomb laws. rho_N = 1/W_NN, rho_T = 1/lambda_max(W_TT). */
struct ContactMap
{
  ContactFunction<3> (*spatial)(const Vector<3>& u, const Vector<3>& r, double mu, double rho_normal,
                                double rho_tangential);
  ContactFunction<2> (*planar)(const Vector<2>& u, const Vector<2>& r, double mu, double rho_normal,
                               double rho_tangential);
};

struct SemismoothNewtonOptions
{
  double proximal_start = 1e-6;  ///< first alpha [-], > 0
  double proximal_min = 1e-13;  ///< smallest alpha [-], > 0
  double proximal_max = 10.0;  ///< largest alpha; failing there ends the run [-]
  double proximal_restart = 1e-3;  ///< smallest alpha after a failure [-]
  double proximal_decrease = 0.1;  ///< factor after a success [-], in (0, 1)
  double proximal_increase = 5.0;  ///< factor after a failure [-], > 1
  bool restarts = true;  ///< false = the first failure ends the run
  int inner_iterations = 20;  ///< Newton steps without the inner error falling below the perturbation, >= 1
  double watchdog_min = 0.0;  ///< smallest alpha at which a step without decrease is taken whole [-], >= 0
  int line_search_steps = 8;  ///< halvings of t, >= 0
  int line_search_memory = 4;  ///< merit values the new one is compared with, in [1, 8]
  double sufficient_decrease = 1e-4;  ///< Armijo constant [-], in (0, 0.5)

  /** @brief What each is, as data. */
  static const OptionTable<SemismoothNewtonOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class SemismoothNewton : public Solver
{
public:
  SemismoothNewton(std::string name, const ContactMap& map, const SemismoothNewtonOptions& options = {});
  ~SemismoothNewton() override;
  void setOptions(const SemismoothNewtonOptions& options);

  /// Above this many active rows the linear system is factored sparse when W is stored sparse.
  static constexpr int DENSE_LIMIT = 120;

protected:
  std::unique_ptr<Solver> sibling() const override;
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

  // For methods that go another way along the same step (solver/swept_newton.h).
  void prepare(const DelassusProblem& problem, const SolveContext& context);
  /** @brief Phi at (u, r), its Jacobians when asked for. @return |Phi/rho|^2 [m^2/s^2] */
  double evaluate(const DelassusProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r, bool jacobians);
  /** @brief step_ from the last evaluation with Jacobians, alpha_ and perturbation_ (0: at the centre, where a small
   * alpha is taken out again). @return false when there is none */
  bool direction(const DelassusProblem& problem);
  /** @brief Of the last direction [products with W]. */
  double stepWork(const DelassusProblem& problem) const
  {
    return 2.0 + SolveContext::factorization(problem, static_cast<double>(active_.size()));
  }
  double alpha_ = 0.0;
  Eigen::VectorXd u_, step_, best_r_;
  Eigen::VectorXd rho_normal_, rho_tangential_;  ///< one a law; rho_normal_ is rho_i of one-dimensional ones

private:
  enum class Inner
  {
    CONVERGED,
    FAILED,
    OUT_OF_BUDGET
  };
  template <int D, typename Sink>
  void reducedRows(const DelassusProblem& problem, int i, Sink sink);
  template <typename Sink>
  void assemble(const DelassusProblem& problem, Sink sink);
  bool isSparse(const DelassusProblem& problem) const;
  bool factorDense(const DelassusProblem& problem);
  bool factorSparse(const DelassusProblem& problem);
  void substitute(const DelassusProblem& problem);
  void refine(const DelassusProblem& problem);
  void moveCentre(const Eigen::VectorXd& r);
  double criterion(const DelassusProblem& problem, const SolveContext& context, SolverResult& result);
  double evaluateProximal(const DelassusProblem& problem, const Eigen::VectorXd& r);
  Inner solveProximal(const DelassusProblem& problem, const SolveContext& context, SolverResult& result);
  double lineSearch(const DelassusProblem& problem, const Eigen::VectorXd& r);
  void keepBest(double value, const Eigen::VectorXd& r);

  ContactMap map_;
  SemismoothNewtonOptions options_;
  struct Sparse;
  std::unique_ptr<Sparse> sparse_;

  Eigen::VectorXd weight_;  ///< 1/rho_i a row: D, and what makes the merit a velocity
  Eigen::VectorXd centre_, u_alpha_, f_, step_velocity_, full_r_, full_u_, trial_r_, trial_u_;
  std::vector<double> by_u_, by_r_;  ///< A_i and B_i, 9 numbers a law, row-major
  std::vector<int> active_;  ///< active row -> row
  std::vector<int> position_;  ///< row -> active row or -1
  Eigen::VectorXd rhs_;
  DenseLu lu_;
  double perturbation_ = 0.0;  ///< |alpha D (r - c)|^2
  double best_value_ = 0.0;
  double history_[8] = {};
  int history_count_ = 0;
};

}  // namespace frictional_contact_sim
