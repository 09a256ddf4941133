#pragma once
/**
 * @file mode_bounds.h
 * @brief The modes of the laws as data: bounds of a law's columns and of its rows of u (relaxation.h).
 */
#include <limits>
#include <vector>

#include "frictional_contact_sim/solver/enumeration/enumeration.h"

namespace frictional_contact_sim
{
constexpr double UNBOUNDED = std::numeric_limits<double>::max();  ///< LinearProgram::INFINITE, known when this is used

struct Interval
{
  double lower, upper;
};

/** @brief Bounds of a law's columns and of its rows of u; those beyond its dimension mean nothing. */
struct ModeBounds
{
  Interval columns[3] = {{-UNBOUNDED, UNBOUNDED}, {-UNBOUNDED, UNBOUNDED}, {-UNBOUNDED, UNBOUNDED}};
  Interval rows[3] = {{-UNBOUNDED, UNBOUNDED}, {-UNBOUNDED, UNBOUNDED}, {-UNBOUNDED, UNBOUNDED}};
};

/** @brief A Coulomb contact with friction. */
inline bool isFrictional(const Law& law)
{
  return law.isCoulomb() && law.coefficient > 0.0;
}

ModeBounds modeBounds(const Law& law, LawMode mode);

/** @brief The modes of a law, most inclusive first; UNDECIDED alone where there is nothing to decide. */
std::vector<LawMode> modesOf(const Law& law);

}  // namespace frictional_contact_sim
