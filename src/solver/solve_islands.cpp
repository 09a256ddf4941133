#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "frictional_contact_sim/problem/residual.h"
#include "island_workspace.h"

namespace frictional_contact_sim
{
namespace
{
/// An island's own |q| counts in its scale, but not less than this share of the whole's: what is asked of a quiet
/// island stays above round-off of the whole.
constexpr double QUIET_SHARE = 1e-3;

/// The more severe, the larger: what the whole reports of its islands.
int severity(SolverStatus status)
{
  switch (status)
  {
    case SolverStatus::CONVERGED:
      return 0;
    case SolverStatus::NOT_RUN:
    case SolverStatus::STAGNATED:
      return 1;
    case SolverStatus::MAX_ITERATIONS:
      return 2;
    case SolverStatus::TIME_LIMIT:
      return 3;
    case SolverStatus::NUMERICAL_FAILURE:
      return 4;
    case SolverStatus::STOPPED_BY_USER:
      return 5;
  }
  return 5;
}

void clear(SolverResult& result)
{
  result.status = SolverStatus::NOT_RUN;
  result.iterations = 0;
  result.residual = UNKNOWN_RESIDUAL;
  result.solver.clear();
  result.tried.clear();
  result.message.clear();
}

void merge(int first_law, const SolverResult& island, SolverResult& whole)
{
  whole.iterations = std::max(whole.iterations, island.iterations);
  // Islands come smallest first: the name that stays is that of the largest one that needed a method.
  if (!island.solver.empty())
    whole.solver = island.solver;
  for (const std::string& name : island.tried)
    if (std::find(whole.tried.begin(), whole.tried.end(), name) == whole.tried.end())
      whole.tried.push_back(name);
  if (severity(island.status) > severity(whole.status))
  {
    whole.status = island.status;
    whole.message = "island of law " + std::to_string(first_law) + ": " + island.message;
  }
}

SolveContext islandContext(const SolveContext& whole, const IslandSlot& slot, double scale, double deadline,
                           WorkMeter& work)
{
  return {slot.step_lengths,       scale,       whole.tolerance, whole.max_iterations,
          whole.cold_start,        whole.start, deadline,        whole.history,
          whole.notedIterations(), &work,       whole.stop};
}
}  // namespace

void reportNoMemory(const DelassusProblem& problem, SolverResult& result)
{
  result.status = SolverStatus::NUMERICAL_FAILURE;
  result.message = "not enough memory for " + std::to_string(problem.W.rows()) + " rows";
}

IslandSlot& IslandWorkspace::slot(int rows, size_t blocks)
{
  ++clock;
  for (IslandSlot& slot : slots)
    if (slot.rows == rows && slot.blocks == blocks)
    {
      slot.last_used = clock;
      return slot;
    }
  if (slots.size() < MAX_SLOTS)
    slots.emplace_back();
  else
    std::iter_swap(std::min_element(slots.begin(), slots.end(),
                                    [](const IslandSlot& a, const IslandSlot& b) { return a.last_used < b.last_used; }),
                   slots.end() - 1);
  IslandSlot& slot = slots.back();
  slot.rows = rows;
  slot.blocks = blocks;
  slot.last_used = clock;
  return slot;
}

IslandSlot& IslandWorkspace::gather(const DelassusProblem& whole, int rows, const Eigen::VectorXd& step_lengths,
                                    const Eigen::VectorXd& r)
{
  IslandSlot& slot = this->slot(rows, laws.size());
  DelassusProblem& part = slot.problem;
  part.laws.resize(laws.size());
  part.q.resize(rows);
  slot.result.solution.r.resize(rows);
  slot.step_lengths.resize(static_cast<Eigen::Index>(laws.size()));
  int row = 0;
  for (size_t k = 0; k < laws.size(); ++k)
  {
    const int first = whole.W.offset(laws[k]), dimension = whole.W.dimension(laws[k]);
    part.laws[k] = whole.laws[static_cast<size_t>(laws[k])];
    part.q.segment(row, dimension) = whole.q.segment(first, dimension);
    slot.result.solution.r.segment(row, dimension) = r.segment(first, dimension);
    slot.step_lengths[static_cast<Eigen::Index>(k)] = step_lengths[laws[k]];
    row += dimension;
  }
  return slot;
}

void IslandWorkspace::scatter(const DelassusProblem& whole, const IslandSlot& slot, Eigen::VectorXd& r) const
{
  int row = 0;
  for (const int i : laws)
  {
    const int dimension = whole.W.dimension(i);
    r.segment(whole.W.offset(i), dimension) = slot.result.solution.r.segment(row, dimension);
    row += dimension;
  }
}

double IslandWorkspace::scale(const DelassusProblem& whole, double whole_free_velocity) const
{
  double largest = QUIET_SHARE * whole_free_velocity;
  for (const int i : laws)
    for (int row = whole.W.offset(i); row < whole.W.offset(i + 1); ++row)
      largest = std::max(largest, std::abs(whole.q[row]));
  return largest;
}

bool IslandWorkspace::alreadySolved(const DelassusProblem& whole, const Eigen::VectorXd& step_lengths,
                                    const Eigen::VectorXd& r, double error, double impulse) const
{
  for (const int i : laws)
  {
    // Written so that a NaN is no answer.
    if (!(errors[i] <= error))
      return false;
    for (int row = whole.W.offset(i); row < whole.W.offset(i + 1); ++row)
      if (!(std::abs(r[row]) <= impulse * step_lengths[i]))
        return false;
  }
  return true;
}

/** The context is the island's own. */
void Solver::solveIsland(const DelassusProblem& whole, const SolveContext& context, IslandSlot& slot)
{
  if (slot.method == nullptr)
    slot.method = sibling();
  Solver& method = slot.method != nullptr ? *slot.method : *this;
  std::vector<int>& position = islands_->position;
  for (size_t i = 0; i < islands_->laws.size(); ++i)
    position[static_cast<size_t>(islands_->laws[i])] = static_cast<int>(i);
  slot.problem.W.assignBlocks(whole.W, islands_->laws, position, slot.problem.laws, stopping_.operator_kind);
  for (const int i : islands_->laws)
    position[static_cast<size_t>(i)] = -1;
  SolverResult& result = slot.result;
  try
  {
    // As if the island were alone: the start of the whole may be scaled by what others need.
    if (context.cold_start)
      result.residual = method.solveAtOnce(slot.problem, context, result).criterion;
    method.doSolve(slot.problem, context, result);
  }
  catch (const std::bad_alloc&)
  {
    reportNoMemory(slot.problem, result);
  }
  if (!result.solution.r.allFinite())
  {
    result.solution.r.setZero();
    result.status = SolverStatus::NUMERICAL_FAILURE;
    result.message = "an impulse is not finite";
  }
}

void Solver::solveIslands(const DelassusProblem& problem, const SolveContext& context, SolverResult& result)
{
  IslandWorkspace& work = *islands_;
  // What the guess is worth, law by law: an island that is already solved is not even copied, so that a scene at rest
  // with a warm start costs one product.
  problem.W.apply(result.solution.r, work.velocity);
  work.velocity += problem.q;
  measureLaws(problem.laws, context.step_lengths, context.free_velocity, work.velocity, result.solution.r,
              &work.errors);
  work.position.assign(problem.laws.size(), -1);
  int rows_left = problem.W.rows();
  result.status = SolverStatus::CONVERGED;
  for (int k = 0; k < work.islands.count(); ++k)
  {
    work.islands.laws(k, work.laws);
    const int rows = work.islands.rows(k);
    const int rows_before = rows_left;
    rows_left -= rows;
    const double scale = work.scale(problem, context.free_velocity);
    if (work.alreadySolved(problem, context.step_lengths, result.solution.r, context.tolerance * scale,
                           SolveContext::IMPULSE_CAP * scale))
      continue;
    IslandSlot& slot = work.gather(problem, rows, context.step_lengths, result.solution.r);
    clear(slot.result);
    // A time limit is shared by rows, what one island leaves goes to the later ones: a hard one does not starve them.
    const double now = context.deadline > 0.0 ? context.seconds() : 0.0;
    const double share = std::max(context.deadline - now, 0.0) * rows / rows_before;
    WorkMeter meter{0.0, work_.limit};
    solveIsland(problem, islandContext(context, slot, scale, context.deadline > 0.0 ? now + share : 0.0, meter), slot);
    result.work = std::max(result.work, meter.spent);
    work.scatter(problem, slot, result.solution.r);
    merge(work.laws.front(), slot.result, result);
  }
}

void Solver::dropSiblings()
{
  for (IslandSlot& slot : islands_->slots)
    slot.method.reset();
}

}  // namespace frictional_contact_sim
