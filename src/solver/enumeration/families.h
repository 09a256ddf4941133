#pragma once
/**
 * @file families.h
 * @brief Leaves that touch are one family; families of islands multiply.
 */
#include "search.h"

namespace frictional_contact_sim
{
/** @brief Pieces in the island's own impulses [N s], unscaled; see enumeration.h. */
struct IslandFamily
{
  std::vector<SolutionPiece> pieces;
  bool proved = true;
  int dimension() const;
  bool isolated() const { return dimension() == 0; }
};

/** @brief The connected components of an island's leaves, their modes and impulses those of all the island's laws. */
std::vector<IslandFamily> joinLeaves(const ScaledIsland& island, const std::vector<Law>& laws, Search& search,
                                     const std::vector<Leaf>& leaves);

}  // namespace frictional_contact_sim
