#pragma once
/**
 * @file wedged_pairs.h
 * @brief Overlaps that no force can push out, remembered: what is wedged (u_N < mu |u_T| in all its motions) cannot
 * separate, and a problem that asks for it has no answer.
 */
#include <vector>

namespace frictional_contact_sim
{
/** @brief Two shapes whose overlap is left as it is for some steps; the contact law itself still holds. */
struct WedgedPair
{
  int shape_a = 0;
  int shape_b = 0;
  double overlap = 0.0;  ///< no more than this is left [m] >= 0
  int steps = 0;  ///< that are to come with it, then it is asked for again
};

/** @brief In the order of (shape_a, shape_b), each pair once. */
using WedgedPairs = std::vector<WedgedPair>;

/** @brief What is left of a pair's overlap [m] >= 0; 0 where it is not known to be wedged. */
double overlapLeft(const WedgedPairs& pairs, int shape_a, int shape_b);

/** @brief Leaves the overlap of a pair for so many steps; a deeper one that is known stays. */
void leaveOverlap(const WedgedPair& pair, WedgedPairs& pairs);

/** @brief One step is over. */
void countStep(WedgedPairs& pairs);

}  // namespace frictional_contact_sim
