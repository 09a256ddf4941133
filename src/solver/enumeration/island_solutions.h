#pragma once
/**
 * @file island_solutions.h
 * @brief The enumeration of one island, from its local problem to its families.
 */
#include "families.h"

namespace frictional_contact_sim
{
struct IslandSolutions
{
  std::vector<IslandFamily> families;
  bool complete = false;
  bool consistent = true;  ///< false: BILATERAL rows contradict each other
  long nodes = 0, leaves = 0, unresolved = 0, cuts = 0;
};

/** @param first end with the first solution */
IslandSolutions enumerateIsland(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<Law>& laws,
                                const EnumerateOptions& options, bool first, const std::function<bool()>& interrupted);

/** @brief The mean of the vertices: in the relative interior where they are complete. */
Eigen::VectorXd middle(const SolutionPiece& piece);

}  // namespace frictional_contact_sim
