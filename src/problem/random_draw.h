#pragma once
/**
 * @file random_draw.h
 * @brief Random numbers that are the same on every machine, for the problem families.
 *
 * The engine (64-bit Mersenne twister) is fixed by the C++ standard, the distributions of <random> are not; so they are
 * written out here. Normal values are rounded to multiples of 2^-32, which hides the last bits in which mathematical
 * libraries differ.
 *
 * Source: Box and Muller (1958), "A note on the generation of random normal deviates".
 */
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>

namespace frictional_contact_sim
{
class RandomDraw
{
public:
  explicit RandomDraw(std::uint64_t seed) : engine_(seed) {}

  /** @brief In [0, 1), 53 random bits. */
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /** @brief In 0 .. count - 1 (the bias of the remainder is count 2^-64). */
  int integer(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }

  /** @brief Standard normal. */
  double normal()
  {
    if (has_second_)
    {
      has_second_ = false;
      return second_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * PI * uniform();
    second_ = rounded(radius * std::sin(angle));
    has_second_ = true;
    return rounded(radius * std::cos(angle));
  }

  /** @brief Independent standard normals, row by row. */
  Eigen::MatrixXd normals(int rows, int columns)
  {
    Eigen::MatrixXd result(rows, columns);
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j)
        result(i, j) = normal();
    return result;
  }

  /** @brief Uniform on the unit sphere. */
  Eigen::Vector3d direction()
  {
    Eigen::Vector3d result = normals(3, 1);
    while (!(result.squaredNorm() > 0.0))
      result = normals(3, 1);
    return result.normalized();
  }

private:
  static constexpr double PI = 3.14159265358979323846;
  static double rounded(double x) { return std::nearbyint(x * 0x1p32) * 0x1p-32; }

  std::mt19937_64 engine_;
  double second_ = 0.0;
  bool has_second_ = false;
};

/** @brief Contact frame of a normal: its rows are the normal and two tangents, right-handed, no case near the poles. */
inline Eigen::Matrix3d contactFrame(const Eigen::Vector3d& normal)
{
  // Duff et al. (2017), "Building an orthonormal basis, revisited".
  const double sign = std::copysign(1.0, normal[2]);
  const double a = -1.0 / (sign + normal[2]);
  const double b = normal[0] * normal[1] * a;
  Eigen::Matrix3d frame;
  frame << normal.transpose(), 1.0 + sign * normal[0] * normal[0] * a, sign * b, -sign * normal[0],  //
      b, sign + normal[1] * normal[1] * a, -normal[1];
  return frame;
}

}  // namespace frictional_contact_sim
