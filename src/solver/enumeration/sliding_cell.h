#pragma once
/**
 * @file sliding_cell.h
 * @brief Solutions of a cell with sliding contacts in 3D: none, exactly one, or not known before the wedge is halved.
 *
 * Unknowns x: the free columns z of the other laws and, of each sliding contact, r_N, s, phi:
 *   u = 0 on the rows where the others stick,   u_N = 0,   u_T = s d(phi),   r = r_N (1, -mu d(phi))
 * Newton gives a zero x*. With J = F'(x*) and |F'(x) - J| <= D in a box, || |J^-1| D ||_inf < 1 makes F injective
 * there: x* is the only zero. The box holds all zeros with phi in the wedge: for fixed phi (z, r_N) solve a linear
 * system A(phi), |A(phi) - A(phi*)| <= A_1, kappa = || |A^-1| A_1 ||_inf < 1 bounds them by kappa/(1 - kappa) |z*|.
 */
#include "leaf.h"

namespace frictional_contact_sim
{
enum class WedgeContent
{
  NONE,
  ONE,
  UNKNOWN
};

/**
 * @param relaxation the cell was FEASIBLE in its last solve
 * @param leaf set for ONE; for UNKNOWN too where Newton found a solution in the cell (then not proved), else empty
 */
WedgeContent resolveWedges(const ScaledIsland& island, const Relaxation& relaxation, const Cell& cell,
                           std::optional<Leaf>& leaf);

}  // namespace frictional_contact_sim
