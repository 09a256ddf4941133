// Frequencies of plates from K and M alone, against exact solutions of elasticity: Lame's mode of a free square, in the
// plane and as a plate of tetrahedra, and bending waves of a strip between supports (Rayleigh and Lamb).
#include <gtest/gtest.h>

#include <Eigen/SparseLU>
#include <cmath>
#include <functional>
#include <vector>

#include "frictional_contact_sim/deformable/elastic_mesh.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.141592653589793;

ElasticMaterial material(PlaneModel plane, double poisson_ratio)
{
  ElasticMaterial some;
  some.young_modulus = 2.0e9;
  some.poisson_ratio = poisson_ratio;
  some.density = 1200.0;
  some.plane = plane;
  some.thickness = 0.01;
  return some;
}

double shearSpeed(const ElasticMaterial& material)
{
  return std::sqrt(0.5 * material.young_modulus / (1.0 + material.poisson_ratio) / material.density);
}

using Field = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

struct Mode
{
  double frequency = 0.0;  ///< [rad/s]
  double likeness = 0.0;  ///< cosine with the exact mode in the metric of M
};

/** The eigenpair that Rayleigh's quotient iteration finds from the exact mode. @param held rows of the matrices that do
 * not move */
Mode modeNear(const ElasticMesh& mesh, const ElasticMaterial& material, const Field& field,
              const std::function<bool(const Eigen::Vector3d& node, int axis)>& held = {})
{
  const ElasticParts parts = assembleElastic(mesh, material);
  const std::vector<int>& axes = axesOf(mesh.dimension);
  std::vector<int> kept(parts.mass.rows(), -1);
  std::vector<double> values;
  for (size_t node = 0; node < mesh.nodes.size(); ++node)
    for (size_t i = 0; i < axes.size(); ++i)
      if (!held || !held(mesh.nodes[node], axes[i]))
      {
        kept[node * axes.size() + i] = static_cast<int>(values.size());
        values.push_back(field(mesh.nodes[node])[axes[i]]);
      }
  const auto restricted = [&](const SparseRows& whole)
  {
    std::vector<Eigen::Triplet<double>> entries;
    for (int row = 0; row < whole.rows(); ++row)
      for (SparseRows::InnerIterator entry(whole, row); entry; ++entry)
        if (kept[row] >= 0 && kept[entry.col()] >= 0)
          entries.emplace_back(kept[row], kept[entry.col()], entry.value());
    Eigen::SparseMatrix<double> part(values.size(), values.size());
    part.setFromTriplets(entries.begin(), entries.end());
    return part;
  };
  const Eigen::SparseMatrix<double> M = restricted(parts.mass);
  const Eigen::SparseMatrix<double> K = restricted(parts.stiffness);
  const Eigen::VectorXd start = Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
  Eigen::VectorXd mode = start / std::sqrt(start.dot(M * start));
  Eigen::SparseLU<Eigen::SparseMatrix<double>> shifted;
  for (int round = 0; round < 5; ++round)
  {
    const double square = mode.dot(K * mode);
    if ((K * mode - square * (M * mode)).norm() < 1e-9 * (K * mode).norm())
      break;
    shifted.compute(K - square * M);
    EXPECT_EQ(shifted.info(), Eigen::Success);
    const Eigen::VectorXd moved = M * mode;
    mode = shifted.solve(moved);
    mode /= std::sqrt(mode.dot(M * mode));
  }
  Mode found;
  found.frequency = std::sqrt(mode.dot(K * mode));
  found.likeness = std::abs(start.dot(M * mode)) / std::sqrt(start.dot(M * start));
  return found;
}

/** Lame (1852): u = (cos kx sin kz, -sin kx cos kz), x and z from a corner, k = pi/a: divergence, shear stress and
 *  tractions on all faces vanish, those of a plate too; omega = sqrt(2) k c_s for any Poisson ratio and thickness. */
Field lameField(double side)
{
  const double k = PI / side;
  return [=](const Eigen::Vector3d& at)
  {
    const double x = k * (at.x() + 0.5 * side);
    const double z = k * (at.z() + 0.5 * side);
    return Eigen::Vector3d(std::cos(x) * std::sin(z), 0.0, -std::sin(x) * std::cos(z));
  };
}

/** @param least, most order between the last two meshes, halved */
void expectConvergence(const std::vector<Mode>& modes, double exact, double least, double most, double finest)
{
  for (const Mode& mode : modes)
  {
    EXPECT_GT(mode.frequency, exact) << "by Rayleigh and Ritz from above";
    EXPECT_GT(mode.likeness, 0.9);
  }
  const double error = modes.back().frequency / exact - 1.0;
  const double order = std::log2((modes[modes.size() - 2].frequency / exact - 1.0) / error);
  EXPECT_GT(order, least);
  EXPECT_LT(order, most);
  EXPECT_LT(error, finest);
}

TEST(PlateFrequencyTest, LamesModeOfAFreeSquare)
{
  constexpr double SIDE = 0.3;
  for (const PlaneModel plane : {PlaneModel::STRAIN, PlaneModel::STRESS})
    for (const double poisson_ratio : {0.1, 0.3, 0.45})
    {
      // Where nu = 0 it shares its frequency with a mode of extension.
      const ElasticMaterial some = material(plane, poisson_ratio);
      const double exact = std::sqrt(2.0) * PI / SIDE * shearSpeed(some);
      std::vector<Mode> modes;
      for (const int cells : {16, 32, 64})
        modes.push_back(modeNear(boxMesh({SIDE, SIDE}, {cells, cells}), some, lameField(SIDE)));
      expectConvergence(modes, exact, 1.8, 2.1, 5e-4);
    }
}

TEST(PlateFrequencyTest, LamesModeOfASquarePlateOfTetrahedra)
{
  // Tetrahedra are stiffer: the order is 0.7 from 4 to 8 cells and 1.3 from 8 to 16, still on its way to two.
  constexpr double SIDE = 0.3;
  const ElasticMaterial some = material(PlaneModel::STRAIN, 0.3);
  const double exact = std::sqrt(2.0) * PI / SIDE * shearSpeed(some);
  std::vector<Mode> modes;
  for (const int cells : {8, 16})
    modes.push_back(modeNear(boxMesh({SIDE, 0.25 * SIDE, SIDE}, {cells, cells / 4, cells}), some, lameField(SIDE)));
  expectConvergence(modes, exact, 1.2, 2.1, 0.01);
}

/** Rayleigh and Lamb's equation of antisymmetric waves in a plate of thickness 2 h, plane strain:
 *  (k^2 + b^2)^2 sinh(a h) cosh(b h) = 4 k^2 a b cosh(a h) sinh(b h), a^2 = k^2 - (omega/c_p)^2,
 *  b^2 = k^2 - (omega/c_s)^2; the bending branch has omega < k c_s. Source: Graff (1975), section 8.1. */
struct BendingWave
{
  BendingWave(const ElasticMaterial& material, double wave_number, double half_thickness)
    : k(wave_number), h(half_thickness)
  {
    const double c_s = shearSpeed(material);
    const double nu = material.poisson_ratio;
    const double c_p = c_s * std::sqrt(2.0 * (1.0 - nu) / (1.0 - 2.0 * nu));
    double low = 1e-3 * k * c_s * k * h;
    double high = (1.0 - 1e-9) * k * c_s;
    const auto excess = [&](double omega)
    {
      a = std::sqrt(k * k - std::pow(omega / c_p, 2));
      b = std::sqrt(k * k - std::pow(omega / c_s, 2));
      return std::pow(k * k + b * b, 2) * std::sinh(a * h) * std::cosh(b * h) -
             4.0 * k * k * a * b * std::cosh(a * h) * std::sinh(b * h);
    };
    const bool is_positive = excess(low) > 0.0;
    for (int round = 0; round < 200; ++round)
    {
      omega = 0.5 * (low + high);
      ((excess(omega) > 0.0) == is_positive ? low : high) = omega;
    }
    excess(omega);
  }
  /** From potentials A sinh(a z) and B cosh(b z): shear stress vanishes at z = h. */
  Eigen::Vector3d shape(double x, double z) const
  {
    const double B = -2.0 * k * a * std::cosh(a * h) / ((k * k + b * b) * std::cosh(b * h));
    return {(k * std::sinh(a * z) + B * b * std::sinh(b * z)) * std::cos(k * x), 0.0,
            (a * std::cosh(a * z) + B * k * std::cosh(b * z)) * std::sin(k * x)};
  }
  double k, h, a = 0.0, b = 0.0, omega = 0.0;
};

TEST(PlateFrequencyTest, SimplySupportedStripBendsAsRayleighAndLambSay)
{
  constexpr double LENGTH = 1.0;
  constexpr double THICKNESS = 0.1;
  const ElasticMaterial some = material(PlaneModel::STRAIN, 0.3);
  for (const int n : {1, 2, 3})
  {
    const BendingWave wave(some, n * PI / LENGTH, 0.5 * THICKNESS);
    if (n == 1)  // a thin plate, less 2 % for shear and rotation: the equation is solved rightly
    {
      const double thin =
          std::pow(wave.k, 2) * THICKNESS * std::sqrt(some.young_modulus / (12.0 * 0.91 * some.density));
      EXPECT_NEAR(wave.omega / thin, 0.983, 1e-3);
    }
    std::vector<Mode> modes;
    for (const int cells : {4, 8, 16})
      modes.push_back(modeNear(
          boxMesh({LENGTH, THICKNESS}, {10 * cells, cells}), some,
          [&](const Eigen::Vector3d& at) { return wave.shape(at.x() + 0.5 * LENGTH, at.z()); },
          [&](const Eigen::Vector3d& at, int axis)
          { return axis == 2 && std::abs(std::abs(at.x()) - 0.5 * LENGTH) < 1e-9; }));
    expectConvergence(modes, wave.omega, 1.9, 2.1, 5e-3);
  }
}

}  // namespace
}  // namespace frictional_contact_sim
