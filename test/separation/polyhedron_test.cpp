/**
 * @file polyhedron_test.cpp
 * @brief Support functions, normal cones and reverse polars of polyhedra: example 7.10, and random polytopes against
 * their vertices.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/separation/reverse_polar.h"
#include "separation_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace
{
/// Linear programs and QR of numbers about 1.
constexpr double EXACT = 1e-8;

/// Example 7.10: the square with the corners (-3, -1), (-3, 1), (-1, -1), (-1, 1).
Polyhedron thesisSquare()
{
  Polyhedron square = {MatrixXd(4, 2), VectorXd(4)};
  square.A << 0, 1, 1, 0, 0, -1, -1, 0;
  square.b << 1, -1, 1, 3;
  return square;
}

bool hasColumn(const MatrixXd& columns, const VectorXd& column)
{
  for (Eigen::Index j = 0; j < columns.cols(); ++j)
    if (columns.col(j) == column)
      return true;
  return false;
}
}  // namespace

TEST(PolyhedronTest, Example710ToTheDigit)
{
  const Polyhedron square = thesisSquare();
  const MatrixXd multipliers = normalConeMultipliers(square.b);
  ASSERT_EQ(multipliers.cols(), 4);
  for (const Eigen::Vector4d& e : {Eigen::Vector4d(0, 1, 0, 0), Eigen::Vector4d(1, 1, 0, 0),
                                   Eigen::Vector4d(0, 1, 1, 0), Eigen::Vector4d(0, 3, 0, 1)})
    EXPECT_TRUE(hasColumn(multipliers, e)) << e.transpose();
  const MatrixXd generators = normalConeGenerators(square);
  ASSERT_EQ(generators.cols(), 4);
  for (const Vector2d& g : {Vector2d(1, 0), Vector2d(1, 1), Vector2d(1, -1), Vector2d(2, 0)})
    EXPECT_TRUE(hasColumn(generators, g)) << g.transpose();
  const ReversePolar polar = reversePolar(square);
  ASSERT_EQ(polar.rays.cols(), 2);
  for (const Vector2d& ray : {Vector2d(1, 1), Vector2d(1, -1)})
    EXPECT_TRUE(hasColumn(polar.rays, ray.normalized())) << ray.transpose();
  ASSERT_EQ(polar.points.cols(), 1);
  EXPECT_EQ(polar.points.col(0), Vector2d(1, 0));
  const NearestPoint deepest = deepestCut(square);
  EXPECT_EQ(deepest.status, NearestPointStatus::CONVERGED);
  EXPECT_EQ(deepest.point, Vector2d(1, 0));  // q = (-1, 0), d = -q / |q|^2
  ASSERT_EQ(deepest.generators.size(), 1U);
  EXPECT_FALSE(deepest.generators[0].is_ray);
}

TEST(PolyhedronTest, SupportIsTheHighestVertex)
{
  Dice dice(1);
  for (int draw = 0; draw < 60; ++draw)
  {
    const int n = dice.integer(2, 4);
    const Polyhedron polytope = randomPolytope(dice, n, dice.integer(0, 4), randomVector(dice, n, 5.0));
    SupportProgram program(polytope);
    const std::vector<VectorXd> vertices = verticesOf(polytope);
    if (vertices.empty())  // the further rows left nothing
    {
      EXPECT_EQ(program.maximise(randomVector(dice, n)).status, LinearProgramStatus::INFEASIBLE);
      continue;
    }
    for (int k = 0; k < 5; ++k)
    {
      const VectorXd d = randomVector(dice, n);
      const Support support = program.maximise(d);
      ASSERT_EQ(support.status, LinearProgramStatus::OPTIMAL);
      EXPECT_NEAR(support.value, highest(vertices, d), EXACT);
      EXPECT_LT((polytope.A * support.point - polytope.b).maxCoeff(), EXACT);
    }
  }
}

TEST(PolyhedronTest, AHalfPlaneIsUnboundedAndAnEmptyOneHasNoSupport)
{
  const Polyhedron half = {Eigen::RowVector2d(1, 0), VectorXd::Constant(1, -1.0)};
  SupportProgram program(half);
  EXPECT_NEAR(program.maximise(Vector2d(2, 0)).value, -2.0, EXACT);
  const Support unbounded = program.maximise(Vector2d(0, 1));
  EXPECT_EQ(unbounded.status, LinearProgramStatus::UNBOUNDED);
  EXPECT_GT(unbounded.point.dot(Vector2d(0, 1)), 0.0);
  Polyhedron empty = {MatrixXd(2, 2), VectorXd::Constant(2, -1.0)};
  empty.A << 1, 0, -1, 0;  // 7.3.3
  EXPECT_EQ(SupportProgram(empty).maximise(Vector2d(0, 1)).value, -std::numeric_limits<double>::infinity());
  // Its normal cone is the plane; Farkas' form gives the axis alone.
  const MatrixXd generators = normalConeGenerators(empty);
  EXPECT_EQ(generators.cols(), 2);
  EXPECT_EQ(generators.row(1).norm(), 0.0);
}

TEST(ReversePolarTest, IsWhatTheSupportFunctionSays)
{
  // d in conv(P) + cone(A^T E) exactly when sigma_Q(d) <= -1, by the vertices of Q.
  Dice dice(2);
  int inside = 0, outside = 0;
  for (int draw = 0; draw < 150; ++draw)
  {
    const int n = dice.integer(2, 4);
    const Polyhedron polytope = randomPolytope(dice, n, dice.integer(0, 3), randomVector(dice, n, 6.0));
    const std::vector<VectorXd> vertices = verticesOf(polytope);
    if (vertices.empty() || !(polytope.b.minCoeff() < -0.1))
      continue;
    const MatrixXd points = reversePolarPoints(polytope), rays = normalConeGenerators(polytope);
    for (Eigen::Index j = 0; j < points.cols(); ++j)
      EXPECT_LE(highest(vertices, points.col(j)), -1.0 + EXACT);
    for (Eigen::Index j = 0; j < rays.cols(); ++j)
      EXPECT_LE(highest(vertices, rays.col(j)), EXACT * (1.0 + rays.col(j).norm()));
    for (int k = 0; k < 6; ++k)
    {
      const VectorXd d = 0.7 * randomVector(dice, n) + points.col(0);
      const double value = highest(vertices, d);
      if (std::abs(value + 1.0) < 1e-6)
        continue;
      const NearestPoint distance = nearestPoint(listOracle(points.colwise() - d, rays), points.col(0) - d);
      EXPECT_EQ(value < -1.0, distance.point.norm() < 1e-7) << value << ' ' << distance.point.norm();
      ++(value < -1.0 ? inside : outside);
    }
  }
  EXPECT_GT(inside, 50);
  EXPECT_GT(outside, 50);
}

TEST(ReversePolarTest, ExtremePointsAreTheFacetsThatSeparate)
{
  // Theorem 6.6, facets counted by the rank of the vertices on them.
  Dice dice(3);
  int counted = 0;
  for (int draw = 0; draw < 60; ++draw)
  {
    const int n = dice.integer(2, 3);
    const Polyhedron polytope = randomPolytope(dice, n, dice.integer(1, 5), randomVector(dice, n, 5.0));
    const std::vector<VectorXd> vertices = verticesOf(polytope);
    if (vertices.empty() || !(polytope.b.minCoeff() < -0.1))
      continue;
    int facets = 0;
    for (int i = 0; i < polytope.rows(); ++i)
    {
      MatrixXd on(n + 1, static_cast<Eigen::Index>(vertices.size()));
      Eigen::Index count = 0;
      for (const VectorXd& vertex : vertices)
        if (std::abs(polytope.A.row(i).dot(vertex) - polytope.b[i]) < 1e-8)
          on.col(count++) << vertex, 1.0;
      Eigen::ColPivHouseholderQR<MatrixXd> factor;
      factor.setThreshold(1e-8);
      const bool is_facet = count >= n && factor.compute(on.leftCols(count)).rank() == n;
      EXPECT_EQ(exposesFacet({polytope, {{MatrixXd(0, n), VectorXd(0)}}}, polytope.A.row(i).transpose()), is_facet);
      facets += is_facet && polytope.b[i] < 0.0 ? 1 : 0;
    }
    EXPECT_EQ(reversePolar(polytope).points.cols(), facets) << draw;
    counted += facets;
  }
  EXPECT_GT(counted, 50);
}

TEST(ReversePolarTest, TheDeepestCutIsDualToTheNearestPoint)
{
  // (6.10) and lemma 6.14: q = -d / |d|^2 is in Q, and q.x >= |q|^2 at every vertex.
  Dice dice(4);
  int with_rays = 0, without = 0;
  for (int draw = 0; draw < 150; ++draw)
  {
    const int n = dice.integer(2, 4);
    const Polyhedron polytope = randomPolytope(dice, n, dice.integer(0, 4), randomVector(dice, n, 5.0));
    const std::vector<VectorXd> vertices = verticesOf(polytope);
    if (vertices.empty() || !(polytope.b.minCoeff() < -0.1))
      continue;
    const NearestPoint deepest = deepestCut(polytope);
    ASSERT_EQ(deepest.status, NearestPointStatus::CONVERGED);
    const VectorXd q = -deepest.point / deepest.point.squaredNorm();
    EXPECT_LT((polytope.A * q - polytope.b).maxCoeff(), 1e-10);
    EXPECT_GT(-highest(vertices, -q) / q.squaredNorm(), 1.0 - 1e-10);
    bool has_ray = false;
    for (const Generator& generator : deepest.generators)
      has_ray = has_ray || generator.is_ray;
    ++(has_ray ? with_rays : without);
  }
  EXPECT_GT(with_rays, 5);  // figure 7.2
  EXPECT_GT(without, 30);
}

TEST(ReversePolarTest, ADeepestCutThatFacetsDoNotMake)
{
  // Figure 7.2: x + 2 y >= 3 and x <= 1/5; the nearest point is the corner (1/5, 7/5), of which one facet separates.
  Polyhedron wedge = {MatrixXd(2, 2), Vector2d(-3.0, 0.2)};
  wedge.A << -1, -2, 1, 0;
  const NearestPoint deepest = deepestCut(wedge);
  EXPECT_LT((deepest.point + Vector2d(0.2, 1.4) / 2.0).norm(), 1e-14);
  ASSERT_EQ(deepest.generators.size(), 2U);
  EXPECT_NE(deepest.generators[0].is_ray, deepest.generators[1].is_ray);
}

TEST(ReversePolarTest, RefusesWhatCannotBeSeparated)
{
  EXPECT_THROW(deepestCut({Eigen::RowVector2d(1, 0), VectorXd::Constant(1, 0.0)}), std::invalid_argument);
  EXPECT_THROW(reversePolar({Eigen::RowVector2d(1, 0), VectorXd::Constant(2, -1.0)}), std::invalid_argument);
  EXPECT_THROW(deepestCut({Eigen::RowVector2d(1, NAN), VectorXd::Constant(1, -1.0)}), std::invalid_argument);
}
