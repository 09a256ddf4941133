#pragma once
/**
 * @file pivot_row.h
 * @brief The row of a term that the origin violates most: j of (7.15).
 */
#include <stdexcept>
#include <string>

#include "frictional_contact_sim/separation/polyhedron.h"

namespace frictional_contact_sim
{
/** @throws std::invalid_argument when the origin violates none */
inline int pivotRow(const Polyhedron& polyhedron, const std::string& name)
{
  int best = -1;
  double farthest = 0.0;
  for (int i = 0; i < polyhedron.rows(); ++i)
  {
    const double length = polyhedron.A.row(i).norm();
    const double depth = length > 0.0 ? -polyhedron.b[i] / length : 0.0;
    if (depth > farthest)
    {
      farthest = depth;
      best = i;
    }
  }
  if (best < 0)
    throw std::invalid_argument(name + ": the origin is in it, nothing separates the two");
  return best;
}

}  // namespace frictional_contact_sim
