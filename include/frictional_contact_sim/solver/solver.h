#pragma once
/**
 * @file solver.h
 * @brief What every method offers: solve(problem, guess) -> SolverResult. Nothing else is public.
 *
 * Islands (problem/islands.h) are solved apart, each with its part of the guess, whatever the method; with one island
 * nothing is copied. An island is measured with its own scale (residual_metric.h). `iterations` is then the largest of
 * them, `tried` their union, `solver` that of the largest island that needed iterations, the status the most severe one
 * (its message names the island's first law). One that fails leaves the others their answers. The residual is the whole
 * problem's.
 */
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/solve_context.h"

namespace frictional_contact_sim
{
enum class SolverStatus
{
  NOT_RUN,
  CONVERGED,
  MAX_ITERATIONS,
  TIME_LIMIT,
  STAGNATED,
  NUMERICAL_FAILURE,
  STOPPED_BY_USER
};

/** @brief The constant's name, for messages. */
const char* toString(SolverStatus status);

/**
 * @brief Stopping rule common to all methods. Budgets count iterations and work: max_iterations alone bounds nothing
 * where an iteration solves a convex problem or factorizes. A clock makes results depend on the load: off by default.
 */
struct StoppingOptions
{
  double tolerance = 1e-8;  ///< on the residual E of problem/residual.h [-], > 0
  int max_iterations = 1000;  ///< outer iterations of the method, >= 0
  double time_limit = 0.0;  ///< wall clock [s], 0 = none
  bool split_islands = true;  ///< solve islands apart; false only to compare
  /// How W is kept. MATRIX_FREE: global problems, methods with operatorUse() == PRODUCTS; W is then never formed.
  OperatorKind operator_kind = OperatorKind::AUTOMATIC;
  bool record_history = false;  ///< fill SolverResult::history; changes no bit of the answer
  double work_per_iteration = 100.0;  ///< a solve ends after max_iterations times so many products with W, > 0
  const std::atomic<bool>* stop =
      nullptr;  ///< when it becomes true the solve ends, STOPPED_BY_USER; outlives the solver

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

struct SolverResult
{
  SolverStatus status = SolverStatus::NOT_RUN;
  Solution solution;
  int iterations = 0;
  double residual = 0.0;  ///< E, evaluated by Solver::solve, not by the method
  double seconds = 0.0;  ///< wall-clock time of the call
  double free_energy = 0.0;  ///< 1/2 f' M^-1 f of a global problem, for problem/energy_check.h [J]
  double work = 0.0;  ///< [products with W], of the hardest island; see WorkMeter
  std::string solver;  ///< registry name of the method whose answer this is
  std::vector<std::string> tried;  ///< names of the methods run, in order (portfolio)
  std::string message;  ///< why it stopped, one line, empty when converged
  /// |e_i| of problem/residual.h at the answer, a law each, with rho_i of the local problem [m/s]
  Eigen::VectorXd law_errors;
  /**
   * With record_history: E of the local problem at every iterate the methods judged, better or worse, in the order of
   * time; last the answer, with `residual`. Methods of a portfolio and islands, which are solved one after another,
   * count their iterations on from each other; an island's entries are relative to its own scale.
   */
  std::vector<HistoryEntry> history;
};

/// SolverResult::residual inside a solve, as long as E has not been evaluated.
constexpr double UNKNOWN_RESIDUAL = -1.0;

class DelassusReduction;
struct IslandSlot;
struct IslandWorkspace;

class Solver
{
public:
  explicit Solver(std::string name);
  virtual ~Solver();
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  /**
   * @brief Solves the local problem. Checks shapes, times the call, evaluates the residual, withdraws CONVERGED when it
   * does not hold.
   * @param guess start (u is ignored); nullptr = cold start at r = 0
   * @param result overwritten; storage is reused, so a result kept between calls makes the call free of allocation
   * @throws std::invalid_argument on wrong shapes, or when the method cannot use stopping().operator_kind
   */
  void solve(const DelassusProblem& problem, const Solution* guess, SolverResult& result);
  /** @brief The same for the global problem: reduces it to the local one, solves, recovers v and lambda. */
  void solve(const IncrementalProblem& problem, const Solution* guess, SolverResult& result);

  SolverResult solve(const DelassusProblem& problem, const Solution* guess = nullptr);
  SolverResult solve(const IncrementalProblem& problem, const Solution* guess = nullptr);

  /**
   * @brief E of another answer to the global problem that was solved last, for who changes r after the solve.
   * @param result its residual, law_errors and solution.u are set anew, nothing else
   */
  void judgeAgain(const IncrementalProblem& problem, SolverResult& result);
  /** @brief What the last global problem was measured with. */
  const ResidualMetric& metric() const { return global_.metric; }

  const std::string& name() const { return name_; }
  /** @brief What the method needs of W. */
  virtual OperatorUse operatorUse() const { return OperatorUse::BLOCK_ROWS; }
  /** @brief The stopping rule, changeable between calls. */
  void setStopping(const StoppingOptions& stopping);
  const StoppingOptions& stopping() const { return stopping_; }
  /** @brief The reduction of the last global problem, for what comes after its solve (solver/least_norm.h). */
  DelassusReduction& reduction() { return *reduction_; }

protected:
  /**
   * @brief The method: improves result.solution.r (sized, holding the guess) and sets status, iterations, message.
   * result.residual is E at that r, before (then result.solution.u = W r + q too) and after, or negative when it is not
   * known; it only saves evaluations, solve() judges for itself. E at every iterate that the method judges goes to
   * context.note().
   */
  virtual void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) = 0;
  /**
   * @brief Another object of this method with the same options, to keep the workspace of islands of another shape.
   * @return nullptr (the default): this one does them all, and resizes its workspace when shapes alternate
   */
  virtual std::unique_ptr<Solver> sibling() const { return nullptr; }
  /** @brief To be called by setOptions() of a method that overrides sibling(). */
  void dropSiblings();
  /**
   * @brief A method's own cold starts, before islands are split: sets r, and u = W r + q with it.
   * @param attempt 0, 1, ...; asked for the next one as long as none solves the problem; r and u hold the last one
   * @return false = there is no such start, r and u are untouched (the default: r = 0 is the only one)
   */
  virtual bool start(int attempt, const DelassusProblem& problem, Eigen::VectorXd& r, Eigen::VectorXd& u);
  /** @brief Sets result.solution r and u to the first cold start that solves the problem, else the last; returns its E.
   */
  double solveAtOnce(const DelassusProblem& problem, const SolveContext& context, SolverResult& result);
  /**
   * @brief Runs another method on the same problem from result.solution.r, without the checks and the final judgement
   * of solve(): for methods made of methods. result.residual as for doSolve().
   */
  static void delegate(Solver& method, const DelassusProblem& problem, const SolveContext& context,
                       SolverResult& result);

private:
  SolveContext begin(SolverResult& result);
  double solveLocal(const DelassusProblem& problem, const Solution* guess, SolveContext& context, SolverResult& result);
  void solveIslands(const DelassusProblem& problem, const SolveContext& context, SolverResult& result);
  void solveIsland(const DelassusProblem& whole, const SolveContext& context, IslandSlot& slot);
  void finish(const std::vector<Law>& laws, const SolveContext& context, double residual, SolverResult& result);
  void judge(double residual, const SolveContext& context, SolverResult& result) const;
  void checkOperator(bool global) const;

  std::string name_;
  StoppingOptions stopping_;
  WorkMeter work_;
  ResidualMetric metric_;  ///< of the local problem being solved
  GlobalResidualData global_;
  Solution warm_;
  DelassusProblem converted_;  ///< a local problem in another storage, when asked for
  std::unique_ptr<DelassusReduction> reduction_;
  std::unique_ptr<IslandWorkspace> islands_;
};

}  // namespace frictional_contact_sim
