#pragma once
/**
 * @file law.h
 * @brief Complementarity laws between a relative velocity u_i [m/s] and an impulse r_i [N s], one value type for all.
 *
 *   law           rows                              set
 *   COULOMB_3D    normal, tangent 1, tangent 2      r in K_mu = { |r_T| <= mu r_N }, (u, r) in C(e, mu) (1.22)
 *   COULOMB_2D    normal, tangent                   the same in the plane
 *   UNILATERAL    1: joint limit                    0 <= u  orthogonal  r >= 0
 *   DRY_FRICTION  1: joint friction, bounded servo  |r| <= c, u = 0 or r = -c u/|u|
 *   BILATERAL     1: row of G in a local problem    u = 0, r free
 *
 * Source: Cadoux (2009), equation (1.22) for Coulomb; Tresca's one-dimensional law for DRY_FRICTION.
 * @see problem/law_functions.h for the projections and Jacobians.
 */
#include <vector>

namespace frictional_contact_sim
{
enum class LawType
{
  COULOMB_3D,
  COULOMB_2D,
  UNILATERAL,
  DRY_FRICTION,
  BILATERAL
};

struct Law
{
  LawType type = LawType::COULOMB_3D;
  double coefficient = 0.0;  ///< Coulomb: friction coefficient mu [-]; DRY_FRICTION: impulse threshold c [N s]; else 0

  /** @brief Number of rows: 3, 2 or 1. */
  int dimension() const { return type == LawType::COULOMB_3D ? 3 : type == LawType::COULOMB_2D ? 2 : 1; }
  /** @brief Its first row may part: u >= 0 costs nothing there. */
  bool isOneSided() const { return isCoulomb() || type == LawType::UNILATERAL; }
  bool isCoulomb() const { return type == LawType::COULOMB_3D || type == LawType::COULOMB_2D; }
};

/** @brief Total number of rows of a list of laws. */
inline int rowCount(const std::vector<Law>& laws)
{
  int rows = 0;
  for (const Law& law : laws)
    rows += law.dimension();
  return rows;
}

}  // namespace frictional_contact_sim
