#include "frictional_contact_sim/ros/throttle.h"

#include <iterator>
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

LineThrottle::LineThrottle(double period, size_t most) : period_(period), most_(most)
{
}

bool LineThrottle::pass(const std::string& line, double wall)
{
  for (auto shown = shown_.begin(); shown != shown_.end();)
    shown = wall - shown->second < period_ ? std::next(shown) : shown_.erase(shown);
  return shown_.size() < most_ && shown_.emplace(line, wall).second;
}

}  // namespace frictional_contact_sim
