#include "frictional_contact_sim/solver/enumeration/enumerate.h"

#include <algorithm>

#include "island_solutions.h"

namespace frictional_contact_sim
{
namespace
{
/// A node's linear program, in products with W: a few pivots on a tableau of the size of W, two or three programs.
constexpr double NODE_WORK = 10.0;
}  // namespace

Enumerate::Enumerate(const EnumerateOptions& options) : Solver("enumerate"), options_(options)
{
  options_.validate();
}

void Enumerate::doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  result.residual = UNKNOWN_RESIDUAL;
  if (problem.W.rows() > options_.max_rows)
  {
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.message = "the island has " + std::to_string(problem.W.rows()) + " rows, max_rows is " +
                     std::to_string(options_.max_rows);
    return;
  }
  EnumerateOptions options = options_;
  options.max_nodes = std::min(options.max_nodes, std::max(context.max_iterations, 1));
  const auto interrupted = [&]
  {
    return context.max_iterations == 0 || context.spend(NODE_WORK) ||
           (options.time_limit > 0.0 && context.seconds() > options.time_limit);
  };
  const IslandSolutions found =
      enumerateIsland(problem.W.toDense(), problem.q, problem.laws, options, true, interrupted);
  result.iterations = static_cast<int>(found.nodes);
  if (!found.families.empty())
  {
    result.solution.r = middle(found.families.front().pieces.front());
    result.status = SolverStatus::CONVERGED;
    problem.W.apply(result.solution.r, result.solution.u);
    result.solution.u += problem.q;
    result.residual = context.residual(problem, result.solution.u, result.solution.r);
    context.note(result.iterations, result.residual);
    return;
  }
  if (found.complete)
  {
    result.status = SolverStatus::STAGNATED;
    result.message = "no solution exists: proved at every one of " + std::to_string(found.nodes) + " nodes";
    return;
  }
  const bool limited = found.nodes >= options.max_nodes;
  result.status = context.timeIsUp() ? SolverStatus::TIME_LIMIT
                  : limited          ? SolverStatus::MAX_ITERATIONS
                                     : SolverStatus::STAGNATED;
  result.message = limited ? "nodes exhausted, none of those seen has a solution"
                           : "the search ended with nodes that it could not resolve";
}

}  // namespace frictional_contact_sim
