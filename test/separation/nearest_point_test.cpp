/**
 * @file nearest_point_test.cpp
 * @brief Wolfe's method with an oracle: optimality by lemma 6.14, the rate of theorem 7.4, rays.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/separation/nearest_point.h"
#include "separation_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace
{
MatrixXd randomColumns(Dice& dice, int rows, int columns, const VectorXd& shift)
{
  MatrixXd result(rows, columns);
  for (int j = 0; j < columns; ++j)
    result.col(j) = shift + randomVector(dice, rows);
  return result;
}

/// Lemma 6.14 and that the point is what its weights make.
void expectNearest(const NearestPoint& found, const MatrixXd& points, const MatrixXd& rays)
{
  ASSERT_EQ(found.status, NearestPointStatus::CONVERGED);
  const VectorXd& x = found.point;
  const double size = std::max(1.0, points.cwiseAbs().maxCoeff());
  EXPECT_GE((points.transpose() * x).minCoeff() - x.squaredNorm(), -1e-9 * size * size);
  if (rays.cols() > 0)
  {
    EXPECT_GE((rays.transpose() * x).minCoeff(), -1e-9 * size * rays.colwise().norm().maxCoeff());
  }
  VectorXd sum = VectorXd::Zero(x.size());
  double weight = 0.0;
  for (size_t i = 0; i < found.generators.size(); ++i)
  {
    const double a = found.weights[static_cast<Eigen::Index>(i)];
    EXPECT_GT(a, 0.0);
    sum += a * found.generators[i].value;
    weight += found.generators[i].is_ray ? 0.0 : a;
  }
  EXPECT_NEAR(weight, 1.0, 1e-10);
  EXPECT_LT((sum - x).norm(), 1e-10 * size);
  EXPECT_LE(static_cast<Eigen::Index>(found.generators.size()), x.size() + 1);  // affinely independent
}
}  // namespace

TEST(NearestPointTest, OfRandomClouds)
{
  Dice dice(1);
  for (int draw = 0; draw < 200; ++draw)
  {
    const int n = dice.integer(1, 12), count = dice.integer(1, 60);
    const MatrixXd points = randomColumns(dice, n, count, randomVector(dice, n, dice.chance(0.5) ? 0.3 : 3.0));
    expectNearest(nearestPoint(listOracle(points, MatrixXd(n, 0)), points.col(0)), points, MatrixXd(n, 0));
  }
}

TEST(NearestPointTest, OfPointsThatCoincideOrAreNearlyDependent)
{
  Dice dice(2);
  for (int draw = 0; draw < 60; ++draw)
  {
    const int n = dice.integer(2, 8);
    MatrixXd points = randomColumns(dice, n, 12, randomVector(dice, n, 2.0));
    points.rightCols(4) = points.leftCols(4);
    points.middleCols(4, 3) = points.leftCols(3) + 1e-11 * randomColumns(dice, n, 3, VectorXd::Zero(n));
    expectNearest(nearestPoint(listOracle(points, MatrixXd(n, 0)), points.col(0)), points, MatrixXd(n, 0));
  }
}

TEST(NearestPointTest, OfUnboundedSets)
{
  Dice dice(3);
  int used = 0;
  for (int draw = 0; draw < 200; ++draw)
  {
    const int n = dice.integer(2, 8);
    const VectorXd away = randomVector(dice, n, 3.0);
    const MatrixXd points = randomColumns(dice, n, dice.integer(1, 12), away);
    const MatrixXd rays = randomColumns(dice, n, dice.integer(1, 6), 0.3 * away);
    const NearestPoint found = nearestPoint(listOracle(points, rays), points.col(0));
    expectNearest(found, points, rays);
    for (const Generator& generator : found.generators)
      used += generator.is_ray ? 1 : 0;
  }
  EXPECT_GT(used, 40);
}

TEST(NearestPointTest, Figure73DoesNotGoRoundForEver)
{
  // A horizontal ray and a point that is nearer: d_1, then the ray, then d_2, by an oracle that prefers rays and whose
  // digits call one falling that is orthogonal.
  const Vector2d first(-2.0, 1.2), second(0.3, 1.0), ray(1.0, 0.0);
  const LinearOracle sloppy = [&](const VectorXd& x) -> OracleAnswer
  {
    if (x.dot(ray) < 1e-12)
      return {OracleStatus::FOUND, {ray, true}};
    return {OracleStatus::FOUND, {x.dot(first) < x.dot(second) ? first : second, false}};
  };
  const NearestPoint found = nearestPoint(sloppy, first);
  EXPECT_LT(found.calls, 10);
  EXPECT_NE(found.status, NearestPointStatus::MAX_CALLS);
}

TEST(NearestPointTest, ConvergesAsTheorem74Says)
{
  // |d_k+1|^2 <= |d_k|^2 - delta^2 / M, delta = |d - d_k|^2, M the largest |d_k+1 - d_k|^2; as |d_k| falls alone is
  // seen, delta >= 0 is bounded from below by (|d_k| - |d|)^2.
  Dice dice(4);
  for (int draw = 0; draw < 60; ++draw)
  {
    const int n = dice.integer(3, 15);
    const MatrixXd points = randomColumns(dice, n, 80, randomVector(dice, n, 1.0));
    const NearestPoint found = nearestPoint(listOracle(points, MatrixXd(n, 0)), points.col(0));
    expectNearest(found, points, MatrixXd(n, 0));
    double diameter = 0.0;
    for (int i = 0; i < 80; ++i)
      diameter = std::max(diameter, (points.colwise() - points.col(i)).colwise().norm().maxCoeff());
    for (size_t k = 0; k + 1 < found.norms.size(); ++k)
    {
      const double delta = std::pow(found.norms[k] - found.point.norm(), 2), M = diameter * diameter;
      EXPECT_LT(found.norms[k + 1], found.norms[k]);
      EXPECT_LE(std::pow(found.norms[k + 1], 2), std::pow(found.norms[k], 2) - delta * delta / M + 1e-12);
    }
  }
}

TEST(NearestPointTest, TheOriginInTheSetIsFoundAndFailuresAreSaid)
{
  Dice dice(5);
  const MatrixXd around = randomColumns(dice, 4, 60, VectorXd::Zero(4));
  EXPECT_LT(nearestPoint(listOracle(around, MatrixXd(4, 0)), around.col(0)).point.norm(), 1e-12);
  const LinearOracle broken = [](const VectorXd&) -> OracleAnswer { return {OracleStatus::FAILED, {}}; };
  EXPECT_EQ(nearestPoint(broken, Vector2d(1, 0)).status, NearestPointStatus::FAILED);
  NearestPointOptions few;
  few.max_calls = 2;
  const MatrixXd cloud = randomColumns(dice, 10, 80, 2.0 * VectorXd::Ones(10));
  EXPECT_EQ(nearestPoint(listOracle(cloud, MatrixXd(10, 0)), cloud.col(0), few).status, NearestPointStatus::MAX_CALLS);
  EXPECT_THROW(nearestPoint(broken, Vector2d(NAN, 0)), std::invalid_argument);
}
