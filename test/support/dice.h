#pragma once
/**
 * @file dice.h
 * @brief Random numbers that are the same on every machine, and numbers as text, for generated robots and scenes.
 */
#include <Eigen/Core>
#include <cmath>
#include <random>
#include <sstream>
#include <string>

namespace frictional_contact_sim
{
namespace test_support
{
/** @brief Numbers that are the same on every machine: no distribution of the standard library. */
class Dice
{
public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  double logUniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  int integer(int low, int high) { return low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1)); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  Eigen::Vector3d vector(double size)
  {
    const double x = uniform(-size, size);
    const double y = uniform(-size, size);
    return {x, y, uniform(-size, size)};
  }

private:
  std::mt19937 engine_;
};

inline std::string text(double value)
{
  std::ostringstream stream;
  stream.precision(12);
  stream << value;
  return stream.str();
}
inline std::string text(const Eigen::Vector3d& v, const char* separator = " ")
{
  return text(v.x()) + separator + text(v.y()) + separator + text(v.z());
}
inline std::string list(const Eigen::Vector3d& v)
{
  return "[" + text(v, ", ") + "]";
}

}  // namespace test_support
}  // namespace frictional_contact_sim
