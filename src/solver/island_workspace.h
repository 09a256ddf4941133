#pragma once
/**
 * @file island_workspace.h
 * @brief What Solver keeps to solve islands one after another: the islands, and for each shape of island a problem, a
 * result and, where the method offers one, a sibling of it, so that repeated calls with the same shapes allocate
 * nothing.
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "frictional_contact_sim/problem/islands.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
/** @brief Storage for the islands of one shape, used by one after the other. */
struct IslandSlot
{
  int rows = 0;
  size_t blocks = 0;
  long last_used = 0;
  DelassusProblem problem;
  ResidualMetric metric;
  SolverResult result;
  std::unique_ptr<Solver> method;  ///< a sibling of the solver; nullptr: the solver itself
};

/** @brief A method that forms a dense matrix of a large problem may run out of memory: a status, not a crash. */
void reportNoMemory(const DelassusProblem& problem, SolverResult& result);

struct IslandWorkspace
{
  /// Shapes remembered; beyond, the one that was not used for longest gives way.
  static constexpr size_t MAX_SLOTS = 16;

  /** @brief The slot of this shape, or one to be used for it. */
  IslandSlot& slot(int rows, size_t blocks);
  /** @brief Copies the island's laws, q, metric and r to its slot; those given are of the whole. */
  IslandSlot& gather(const DelassusProblem& whole, int rows, const ResidualMetric& metric, const Eigen::VectorXd& r);
  /** @brief Whether the guess is good enough for the island: E of its laws alone. */
  bool alreadySolved(double tolerance) const;
  /** @brief Writes the slot's impulses to r. */
  void scatter(const DelassusProblem& whole, const IslandSlot& slot, Eigen::VectorXd& r) const;

  Islands islands;
  std::vector<int> laws;  ///< of the present island
  std::vector<int> position;  ///< of every law of the whole in the present island, or -1
  std::vector<IslandSlot> slots;
  long clock = 0;
  Eigen::VectorXd velocity;  ///< u of the guess
  Eigen::VectorXd residuals;  ///< E of the laws at the guess
};

}  // namespace frictional_contact_sim
