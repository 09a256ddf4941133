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

#include "frictional_contact_sim/solver/islands.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
/** @brief Storage for the islands of one shape, used by one after the other. */
struct IslandSlot
{
  int rows = 0;
  std::size_t blocks = 0;
  long last_used = 0;
  DelassusProblem problem;
  Eigen::VectorXd step_lengths;
  Eigen::VectorXd velocity;
  SolverResult result;
  std::unique_ptr<Solver> method;  ///< a sibling of the solver; nullptr: the solver itself
};

struct IslandWorkspace
{
  /// Shapes remembered; beyond, the one that was not used for longest gives way.
  static constexpr std::size_t MAX_SLOTS = 16;

  /** @brief The slot of this shape, or one to be used for it. */
  IslandSlot& slot(int rows, std::size_t blocks);
  /** @brief Copies the island's laws, q, r, u and step lengths to its slot. */
  IslandSlot& gather(const DelassusProblem& whole, const Eigen::VectorXd& r);
  /** @brief Writes the slot's impulses to r. */
  void scatter(const DelassusProblem& whole, const IslandSlot& slot, Eigen::VectorXd& r) const;

  Islands islands;
  std::vector<int> laws;  ///< of the present island
  std::vector<int> position;  ///< of every law of the whole in the present island, or -1
  std::vector<IslandSlot> slots;
  long clock = 0;
  Eigen::VectorXd velocity;  ///< u of the guess
  Eigen::VectorXd step_lengths;  ///< of the whole
};

}  // namespace frictional_contact_sim
