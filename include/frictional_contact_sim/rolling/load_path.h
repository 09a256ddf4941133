#pragma once
/**
 * @file load_path.h
 * @brief Loads that come one after another: Cattaneo and Mindlin's contact with its memory.
 *
 *     y_T = u_T(new) - u_T(old) + change of the shift       the LCP of frictional_lcp.h with d_T0 = -u_T(old)
 *
 * Slip of a step counts from where the step before has left the surfaces; friction remembers nothing else. At constant
 * P and beta = 0 a step is exact however long, as long as Q does not turn round in it: the slip zones only grow.
 * Source: Mindlin and Deresiewicz (1953); Johnson, Contact Mechanics (1985), 7.4.
 */
#include <functional>
#include <vector>

#include "frictional_contact_sim/rolling/frictional_lcp.h"

namespace frictional_contact_sim
{
struct LoadStep
{
  LoadedContact answer;  ///< y_T is the slip of this step, shift counts from the start of the path [m]
  double dissipated = 0.0;  ///< by friction in this step, per width [J/m]
};

/**
 * @brief Each load from where the one before has left the contact, which starts untouched.
 * @param gap n, before deformation [m]
 * @param targets at least one
 * @return up to the first that is not met
 * @throws std::invalid_argument as solveForLoads
 */
std::vector<LoadStep> followLoads(const FrictionalLcp& lcp, const Eigen::VectorXd& gap,
                                  const std::vector<LoadTarget>& targets, double approach_guess,
                                  const std::function<bool()>& interrupted = {});

}  // namespace frictional_contact_sim
