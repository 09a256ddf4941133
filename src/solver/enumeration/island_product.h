#pragma once
/**
 * @file island_product.h
 * @brief Solutions of the whole: one family of each island, in all combinations.
 */
#include "island_solutions.h"

namespace frictional_contact_sim
{
/** @brief An island's laws and rows in the whole, and what was found. */
struct IslandPart
{
  std::vector<int> laws, rows;
  IslandSolutions solutions;
  std::vector<bool> unique_velocity;  ///< of each family
  bool one_velocity = true;  ///< of all of them
};

/**
 * @brief Families of the islands before, times those of the next one.
 * @param laws of the whole
 * @param rows of the whole
 */
std::vector<SolutionFamily> product(const std::vector<SolutionFamily>& before, const IslandPart& part, size_t laws,
                                    Eigen::Index rows, const EnumerateOptions& options);

}  // namespace frictional_contact_sim
