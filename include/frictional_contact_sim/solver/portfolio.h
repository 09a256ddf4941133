#pragma once
/**
 * @file portfolio.h
 * @brief Methods in turn, the best iterate kept: the default of the package.
 *
 *   0  the guess is already good, or, from a cold start, every law solved apart is: no iteration at all
 *   1  few rows: proximal Newton from the guess (quick, and it keeps the symmetry of a symmetric problem), then without
 *      it (a servo that turns round makes it a bad one), then the interior point, which takes 20 to 60 iterations where
 *      Newton goes in circles: feet on many redundant points, then the same two ways Newton on
 *      Fischer and Burmeister's function and on De Saxce's;
 *      some more rows: the same for a few steps, given up at the first that fails;
 *      many rows: Haslinger's fixed point as long as every iteration takes four fifths of the residual, as it does
 *      where nearly everything sticks (a tower at rest), then Gauss-Seidel sweeps with a stall detector, then proximal
 *      Newton from where they ended; from swept_first_rows on Newton steps each followed by sweeps
 *      (solver/swept_newton.h) between the two, above newton_last_rows in place of Newton
 *   2  what is left, while the budget lasts: Gauss-Seidel from the best iterate, Newton from there, then the smoothed
 *      Fischer-Burmeister Newton, De Saxce's and the smoothed one with its damped steps, each of which factors J' J, in
 *      longer rounds; above newton_last_rows instead of these Haslinger's fixed point, which
 *      needs products with W only; on more than few rows Newton with sweeps, before it above newton_last_rows, else at
 *      the end of a round; above swept_last_rows nothing is factored
 *   3  few rows, and everything has failed: the complete search (solver/enumeration/enumerate.h), which finds what
 *      nothing else does (a subset-sum machine) or proves that no solution exists; the message says so
 * Never returns an iterate worse than one it has had, the guess included. `tried` lists the methods run, `solver` names
 * the one whose iterate is returned.
 *
 * Source: Acary, Bremond, Huber (2018), conclusions: no method wins everywhere; hybrid starts and the proximal point
 * algorithm around Newton reach the tightest tolerances.
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
class GaussSeidel;
class AcNewton;
class Haslinger;
class InteriorPoint;
class SweptNewton;
class Enumerate;

struct PortfolioOptions
{
  int newton_first_rows = 150;  ///< up to this many rows Newton goes first, >= 0
  int newton_first_steps = 30;  ///< its budget in that place, >= 1
  int interior_rows = 0;  ///< from so many rows on the interior point is next where that has failed, >= 0
  int interior_steps = 200;  ///< its budget, >= 1
  int newton_try_rows = 290;  ///< up to this many rows it goes first too, but for newton_try_steps at most
  int newton_try_steps = 8;  ///< and only as long as no step fails, >= 1
  int haslinger_steps = 10;  ///< outer iterations of Haslinger's fixed point on more rows, as long as it is quick, >= 1
  int newton_last_rows = 6000;  ///< above, Newton alone takes too many factorizations
  int swept_first_rows = 2500;  ///< from here on Newton with sweeps goes before Newton alone, >= 0
  int swept_last_rows = 60000;  ///< above, nothing is factored: memory and time grow faster than the problem
  /// budget of Newton with sweeps, doubled every round, >= 1; a step is one iteration, whatever its sweeps
  int swept_steps = 30;
  int first_sweeps = 60;  ///< Gauss-Seidel sweeps before Newton on larger problems, >= 0
  int newton_steps = 200;  ///< Newton's budget after sweeps, doubled every round, >= 1
  int later_sweeps = 300;  ///< sweeps of the later rounds, doubled every round, >= 1
  int max_rounds = 4;  ///< rounds of step 2, >= 0
  int enumerate_rows = 12;  ///< up to this many rows the complete search ends it, >= 0
  int enumerate_nodes = 1000;  ///< its budget, >= 1

  /** @brief What each is, as data. */
  static const OptionTable<PortfolioOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class Portfolio : public Solver
{
public:
  explicit Portfolio(const PortfolioOptions& options = {});
  ~Portfolio() override;
  void setOptions(const PortfolioOptions& options);

protected:
  std::unique_ptr<Solver> sibling() const override;
  /**
   * @brief First every law solved as if it were alone, which may be the answer. Then that, or, where nothing would
   * slide, the normal impulses alone, scaled by the t <= 1 that minimises 1/2 r' W r + q' r: without friction that
   * nothing asks for the answer of a body at rest on several contacts stays the symmetric one of least norm, which a
   * sweep of Gauss-Seidel would lose.
   */
  bool start(int attempt, const DelassusProblem& problem, Eigen::VectorXd& r, Eigen::VectorXd& u) override;
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  static void solveApart(const DelassusProblem& problem, Eigen::VectorXd& r);
  double criterion(const DelassusProblem& problem, const SolveContext& context, const Eigen::VectorXd& r);
  bool tryNewton(AcNewton& newton, const DelassusProblem& problem, const SolveContext& context, int steps,
                 SolverResult& result);
  bool tryInteriorPoint(const DelassusProblem& problem, const SolveContext& context, SolverResult& result);
  bool tryWithoutGuess(Solver& newton, const DelassusProblem& problem, const SolveContext& context, int steps,
                       SolverResult& result);
  bool tryOtherNewton(Solver& newton, const DelassusProblem& problem, const SolveContext& context,
                      SolverResult& result);
  bool tryHaslinger(const DelassusProblem& problem, const SolveContext& context, SolverResult& result);
  bool tryEnumerate(const DelassusProblem& problem, const SolveContext& context, SolverResult& result);
  bool run(Solver& method, const DelassusProblem& problem, const SolveContext& context, int budget,
           SolverResult& result, double margin = 1.0);

  PortfolioOptions options_;
  std::unique_ptr<GaussSeidel> gauss_seidel_;
  std::unique_ptr<AcNewton> newton_, first_newton_;
  std::unique_ptr<AcNewton> newton_trial_;  ///< gives up at the first failure
  std::unique_ptr<InteriorPoint> interior_point_;
  std::unique_ptr<Haslinger> haslinger_;  ///< gives up when it is slow
  std::unique_ptr<SweptNewton> swept_newton_;
  std::unique_ptr<Enumerate> enumerate_;  ///< ends the portfolio on few rows
  std::vector<std::unique_ptr<Solver>> other_newtons_;  ///< on few rows, where the first has failed
  std::vector<std::unique_ptr<Solver>> last_resort_;  ///< after Newton
  std::vector<std::unique_ptr<Solver>> without_factors_;  ///< where factorizations are too large
  Eigen::VectorXd velocity_, guess_r_, best_r_, first_r_, apart_r_;
  Eigen::VectorXd stressed_r_;  ///< of the interior point, not taken; empty: none
  double best_value_ = 0.0;
  int used_ = 0;
};

}  // namespace frictional_contact_sim
