#include "frictional_contact_sim/dynamics/wedged_pairs.h"

#include <algorithm>
#include <utility>

namespace frictional_contact_sim
{
namespace
{
template <class Pairs>
auto placeOf(Pairs& pairs, int shape_a, int shape_b)
{
  return std::lower_bound(
      pairs.begin(), pairs.end(), std::make_pair(shape_a, shape_b),
      [](const WedgedPair& pair, const std::pair<int, int>& shapes)
      { return std::make_pair(pair.shape_a, pair.shape_b) < shapes; });
}
}  // namespace

double overlapLeft(const WedgedPairs& pairs, int shape_a, int shape_b)
{
  if (pairs.empty())
    return 0.0;
  const auto place = placeOf(pairs, shape_a, shape_b);
  return place != pairs.end() && place->shape_a == shape_a && place->shape_b == shape_b ? place->overlap : 0.0;
}

void leaveOverlap(const WedgedPair& pair, WedgedPairs& pairs)
{
  const auto place = placeOf(pairs, pair.shape_a, pair.shape_b);
  if (place == pairs.end() || place->shape_a != pair.shape_a || place->shape_b != pair.shape_b)
  {
    pairs.insert(place, pair);
    return;
  }
  place->overlap = std::max(place->overlap, pair.overlap);
  place->steps = pair.steps;
}

void countStep(WedgedPairs& pairs)
{
  for (WedgedPair& pair : pairs)
    --pair.steps;
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), [](const WedgedPair& pair) { return pair.steps <= 0; }),
              pairs.end());
}

}  // namespace frictional_contact_sim
