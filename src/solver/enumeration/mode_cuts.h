#pragma once
/**
 * @file mode_cuts.h
 * @brief Cuts at a node of the search from what the modes say of a law: complementarities x <= 0 or y <= 0.
 *
 *   COULOMB_2D     r_N (as t+, t-) and u_N;   t+ and u_T;   t- and -u_T        (the pairs of (4.3))
 *   COULOMB_3D     r_N and u_N
 *   UNILATERAL, Coulomb with mu = 0    r and u
 *   DRY_FRICTION   c - r and -u;   c + r and u
 *
 * Where both are positive at the node's point, the point is cut off from the hull of the two polyhedra, the node's
 * relaxation with x <= 0 and with y <= 0 (lemma 6.4, separation/polar_oracle.h). A cut is believed as far as its
 * multipliers prove it: its right-hand side is what they give for both, round-off and the error of the linear program
 * at their worst for impulses up to impulse_bound (Neumaier, Shcherbina (2004)). It holds in the node and below.
 *
 * Source: Cadoux (2009), conclusion of part II, which asks for this and does not try it.
 */
#include <vector>

#include "relaxation.h"

namespace frictional_contact_sim
{
/** @brief row.y <= right_hand_side in the columns of the relaxation. */
struct ModeCut
{
  Eigen::VectorXd row;
  double right_hand_side;
};

/**
 * @brief Cuts that the point of the relaxation, solved last for this cell, violates; from the worst complementarity
 * that gives some. Empty: none is violated, or no cut could be proved.
 */
std::vector<ModeCut> modeCuts(const Relaxation& relaxation, const ScaledIsland& island, const Cell& cell,
                              const EnumerateOptions& options);

}  // namespace frictional_contact_sim
