#include "frictional_contact_sim/ros/pacer.h"

#include <algorithm>

namespace frictional_contact_sim
{
namespace
{
constexpr double MAX_DELAY = 0.1;  // [s]
constexpr double WINDOW = 0.25;  // [s]
constexpr double FIRST_WINDOW = 0.01;  // a first value soon: short runs want one too [s]
}  // namespace

Pacer::Pacer(double factor) : factor_(factor)
{
}

void Pacer::restart(double simulated, double wall)
{
  start_simulated_ = window_simulated_ = last_simulated_ = simulated;
  start_wall_ = window_wall_ = last_wall_ = wall;
}

double Pacer::wait(double simulated, double wall)
{
  if (factor_ <= 0.0)
    return 0.0;
  const double due = start_wall_ + (simulated - start_simulated_) / factor_;
  if (wall - due > MAX_DELAY)
  {
    start_simulated_ = simulated;
    start_wall_ = wall;
  }
  return std::max(0.0, due - wall);
}

void Pacer::measure(double simulated, double wall)
{
  total_simulated_ += simulated - last_simulated_;
  total_wall_ += wall - last_wall_;
  last_simulated_ = simulated;
  last_wall_ = wall;
  const double elapsed = wall - window_wall_;
  if (elapsed >= (measured_ > 0.0 ? WINDOW : FIRST_WINDOW))
  {
    measured_ = (simulated - window_simulated_) / elapsed;
    window_simulated_ = simulated;
    window_wall_ = wall;
  }
}

double Pacer::realTimeFactor() const
{
  return measured_;
}

double Pacer::meanRealTimeFactor() const
{
  return total_wall_ > 0.0 ? total_simulated_ / total_wall_ : 0.0;
}

}  // namespace frictional_contact_sim
