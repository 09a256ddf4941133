#pragma once
/**
 * @file kinematic_islands.h
 * @brief Parts of a problem that have nothing to do with each other: laws and bilateral rows are joined when they touch
 * velocities that M, a law or a bilateral row connects. Each part is a problem of its own, with its own velocities.
 *
 * Velocities that no law and no bilateral row touches are in no island.
 */
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
template <typename Problem>
struct KinematicIsland
{
  std::vector<int> laws;  ///< of the whole problem, ascending
  std::vector<int> bilaterals;  ///< rows of the whole problem's G, ascending; none of a local problem
  std::vector<int> velocities;  ///< of the whole problem, ascending; of a local one its rows
  Problem problem;
};

/** @brief Ordered by their first law, those without laws last. */
std::vector<KinematicIsland<IncrementalProblem>> kinematicIslands(const IncrementalProblem& problem);
std::vector<KinematicIsland<DelassusProblem>> kinematicIslands(const DelassusProblem& problem);

}  // namespace frictional_contact_sim
