#pragma once
/**
 * @file separation_support.h
 * @brief Random polyhedra and programs, and least-distance by active sets of a few rows: judges of test/separation.
 */
#include <Eigen/QR>
#include <limits>

#include "frictional_contact_sim/separation/disjunction.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace test_support
{
inline Eigen::VectorXd randomVector(Dice& dice, int size, double reach = 1.0)
{
  Eigen::VectorXd x(size);
  for (int i = 0; i < size; ++i)
    x[i] = dice.uniform(-reach, reach);
  return x;
}

/** @brief A polytope around `center`: a box of half size 1 to 2 cut by further random rows. */
inline Polyhedron randomPolytope(Dice& dice, int dimension, int rows, const Eigen::VectorXd& center)
{
  Polyhedron polytope = {Eigen::MatrixXd(2 * dimension + rows, dimension), Eigen::VectorXd(2 * dimension + rows)};
  for (int j = 0; j < dimension; ++j)
    for (int side = 0; side < 2; ++side)
    {
      polytope.A.row(2 * j + side) = (side == 0 ? 1.0 : -1.0) * Eigen::RowVectorXd::Unit(dimension, j);
      polytope.b[2 * j + side] = dice.uniform(1.0, 2.0);
    }
  for (int i = 0; i < rows; ++i)
  {
    polytope.A.row(2 * dimension + i) = randomVector(dice, dimension).normalized().transpose();
    polytope.b[2 * dimension + i] = dice.uniform(0.3, 1.2);
  }
  polytope.b += polytope.A * center;
  return polytope;
}

/** @brief All vertices, from every choice of n rows. */
inline std::vector<Eigen::VectorXd> verticesOf(const Polyhedron& polyhedron)
{
  const int n = polyhedron.dimension(), m = polyhedron.rows();
  std::vector<Eigen::VectorXd> vertices;
  std::vector<int> chosen(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i)
    chosen[static_cast<size_t>(i)] = i;
  while (n <= m)
  {
    Eigen::MatrixXd A(n, n);
    Eigen::VectorXd b(n);
    for (int i = 0; i < n; ++i)
    {
      A.row(i) = polyhedron.A.row(chosen[static_cast<size_t>(i)]);
      b[i] = polyhedron.b[chosen[static_cast<size_t>(i)]];
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(A);
    if (factor.rank() == n)
    {
      const Eigen::VectorXd x = factor.solve(b);
      if ((polyhedron.A * x - polyhedron.b).maxCoeff() <= 1e-9 * (1.0 + x.norm()))
        vertices.push_back(x);
    }
    int k = n - 1;
    while (k >= 0 && chosen[static_cast<size_t>(k)] == m - n + k)
      --k;
    if (k < 0)
      break;
    ++chosen[static_cast<size_t>(k)];
    for (int i = k + 1; i < n; ++i)
      chosen[static_cast<size_t>(i)] = chosen[static_cast<size_t>(i - 1)] + 1;
  }
  return vertices;
}

/** @brief The largest d.x over some points. */
inline double highest(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& direction)
{
  double value = -std::numeric_limits<double>::infinity();
  for (const Eigen::VectorXd& point : points)
    value = std::max(value, direction.dot(point));
  return value;
}

}  // namespace test_support
}  // namespace frictional_contact_sim
