#pragma once
/**
 * @file convex_solver.h
 * @brief The interface of the inner convex solvers: an argument of haslinger, cadoux_fixed_point and their relatives.
 */
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/solver/convex/convex_problem.h"

namespace frictional_contact_sim
{
enum class ConvexStatus
{
  CONVERGED,
  MAX_ITERATIONS,
  STAGNATED,  ///< the iterates no longer change or the step fell to zero
  FAILED,  ///< numbers overflowed or a factorization broke down: often an unbounded problem
  INTERRUPTED
};

/** @brief What ends a run besides the method's own max_iterations. */
struct ConvexBudget
{
  double tolerance = 1e-12;  ///< on the optimality error [m/s], > 0
  std::function<bool()> interrupted;  ///< asked once an iteration when set, for wall-clock limits
};

struct ConvexResult
{
  ConvexStatus status = ConvexStatus::MAX_ITERATIONS;
  int iterations = 0;
  double error = 0.0;  ///< optimality error of the answer [m/s]
};

class ConvexSolver
{
public:
  explicit ConvexSolver(std::string name);
  virtual ~ConvexSolver();
  ConvexSolver(const ConvexSolver&) = delete;
  ConvexSolver& operator=(const ConvexSolver&) = delete;

  const std::string& name() const { return name_; }
  /** @brief What the method needs of W. */
  virtual OperatorUse operatorUse() const { return OperatorUse::BLOCK_ROWS; }

  /**
   * @brief Solves the convex problem.
   * @param r in: start (projected on the sets first); out: the best iterate, in the sets
   * @param u out: W r + c
   */
  ConvexResult solve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r, Eigen::VectorXd& u);

protected:
  /** @brief The method: improves r (feasible on entry, u = W r + c there) and leaves u = W r + c. */
  virtual ConvexResult doSolve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                               Eigen::VectorXd& u) = 0;
  static bool interrupted(const ConvexBudget& budget) { return budget.interrupted && budget.interrupted(); }

private:
  std::string name_;
};

struct ConvexSolverEntry
{
  const char* name;
  std::unique_ptr<ConvexSolver> (*create)();
  const char* reference;
};

/** @brief All inner solvers with default options. */
const std::vector<ConvexSolverEntry>& convexSolverRegistry();
/** @throws std::invalid_argument on an unknown name; the message lists the valid ones. */
std::unique_ptr<ConvexSolver> createConvexSolver(const std::string& name);

}  // namespace frictional_contact_sim
