#pragma once
/**
 * @file leaf.h
 * @brief What a cell whose modes are all decided holds: a point, a polytope, or (3D, sticking) a convex set.
 */
#include <optional>

#include "relaxation.h"

namespace frictional_contact_sim
{
/** @brief Solutions of one cell, in the units of the scaled island. */
struct Leaf
{
  Cell cell;
  SolutionPiece piece;  ///< modes are the cell's
  bool proved = true;
};

/**
 * @brief The solutions of a cell without sliding contacts in 3D, which was FEASIBLE in the last solve of `relaxation`.
 * @return nothing when cuts of the cones prove that there are none
 * @param closed false when the cuts did not come to an end
 */
std::optional<Leaf> makeLeaf(Relaxation& relaxation, const Cell& cell, const EnumerateOptions& options, bool& closed);

}  // namespace frictional_contact_sim
