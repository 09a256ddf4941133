#include "mode_bounds.h"

namespace frictional_contact_sim
{
namespace
{
constexpr Interval NOTHING = {0.0, 0.0}, POSITIVE = {0.0, UNBOUNDED}, NEGATIVE = {-UNBOUNDED, 0.0},
                   ANYTHING = {-UNBOUNDED, UNBOUNDED};

ModeBounds planarBounds(LawMode mode)
{
  switch (mode)
  {
    case LawMode::OPEN:
      return {{NOTHING, NOTHING}, {POSITIVE, ANYTHING}};
    case LawMode::STICK:
      return {{POSITIVE, POSITIVE}, {NOTHING, NOTHING}};
    case LawMode::RIGHT:
      return {{NOTHING, POSITIVE}, {NOTHING, POSITIVE}};
    case LawMode::LEFT:
      return {{POSITIVE, NOTHING}, {NOTHING, NEGATIVE}};
    default:
      return {{POSITIVE, POSITIVE}, {POSITIVE, ANYTHING}};
  }
}

ModeBounds spatialBounds(LawMode mode)
{
  switch (mode)
  {
    case LawMode::OPEN:
      return {{NOTHING, NOTHING, NOTHING}, {POSITIVE, ANYTHING, ANYTHING}};
    case LawMode::STICK:
      return {{POSITIVE, ANYTHING, ANYTHING}, {NOTHING, NOTHING, NOTHING}};
    case LawMode::SLIDE:
      return {{POSITIVE, ANYTHING, ANYTHING}, {NOTHING, POSITIVE, POSITIVE}};
    default:
      return {{POSITIVE, ANYTHING, ANYTHING}, {POSITIVE, ANYTHING, ANYTHING}};
  }
}

/// UNILATERAL, and the normal row of a contact without friction.
ModeBounds unilateralBounds(LawMode mode)
{
  const Interval column = mode == LawMode::OPEN ? NOTHING : POSITIVE, row = mode == LawMode::STICK ? NOTHING : POSITIVE;
  return {{column, NOTHING, NOTHING}, {row, ANYTHING, ANYTHING}};
}

ModeBounds dryBounds(LawMode mode, double threshold)
{
  switch (mode)
  {
    case LawMode::STICK:
      return {{{-threshold, threshold}}, {NOTHING}};
    case LawMode::RIGHT:
      return {{{-threshold, -threshold}}, {POSITIVE}};
    case LawMode::LEFT:
      return {{{threshold, threshold}}, {NEGATIVE}};
    default:
      return {{{-threshold, threshold}}, {ANYTHING}};
  }
}

}  // namespace

ModeBounds modeBounds(const Law& law, LawMode mode)
{
  if (law.type == LawType::DRY_FRICTION)
    return dryBounds(mode, law.coefficient);
  if (!isFrictional(law))
    return unilateralBounds(mode);
  return law.type == LawType::COULOMB_2D ? planarBounds(mode) : spatialBounds(mode);
}

std::vector<LawMode> modesOf(const Law& law)
{
  if (law.type == LawType::DRY_FRICTION)
    return law.coefficient > 0.0 ? std::vector<LawMode>{LawMode::STICK, LawMode::RIGHT, LawMode::LEFT}
                                 : std::vector<LawMode>{LawMode::UNDECIDED};
  if (!isFrictional(law))
    return {LawMode::STICK, LawMode::OPEN};
  if (law.type == LawType::COULOMB_2D)
    return {LawMode::STICK, LawMode::RIGHT, LawMode::LEFT, LawMode::OPEN};
  return {LawMode::STICK, LawMode::SLIDE, LawMode::OPEN};
}

}  // namespace frictional_contact_sim
