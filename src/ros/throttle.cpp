#include "frictional_contact_sim/ros/throttle.h"

#include <utility>

namespace frictional_contact_sim
{
Throttle::Throttle(double period) : period_(period)
{
}

std::optional<int> Throttle::pass(double wall)
{
  if (wall - last_ < period_)
  {
    ++held_back_;
    return std::nullopt;
  }
  last_ = wall;
  return std::exchange(held_back_, 0);
}

int Throttle::heldBack() const
{
  return held_back_;
}

}  // namespace frictional_contact_sim
