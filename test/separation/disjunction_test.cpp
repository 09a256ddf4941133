/**
 * @file disjunction_test.cpp
 * @brief Cuts of disjunctive polyhedra, judged by the vertices of their terms: validity, duality, facets by rank.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/separation/facet_decomposition.h"
#include "frictional_contact_sim/separation/lift_and_project.h"
#include "separation_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace
{
/// The simplex method's tolerance on rows of length one, with multipliers of some tens.
constexpr double VALID = 1e-7;

/// Two polytopes that do not hold the origin, of which a row of each cuts the origin off from their hull.
Disjunction randomPair(Dice& dice, int n)
{
  while (true)
  {
    const VectorXd away = randomVector(dice, n).normalized() * dice.uniform(3.0, 8.0);
    Disjunction pair = {{MatrixXd(0, n), VectorXd(0)}, {}};
    for (int k = 0; k < 2; ++k)
      pair.terms.push_back(randomPolytope(dice, n, dice.integer(0, 3), away + randomVector(dice, n, 1.5)));
    std::vector<VectorXd> vertices = verticesOf(pair.terms[0]);
    const std::vector<VectorXd> others = verticesOf(pair.terms[1]);
    if (vertices.empty() || others.empty())
      continue;
    vertices.insert(vertices.end(), others.begin(), others.end());
    if (highest(vertices, -away.normalized()) < -0.2)
      return pair;
  }
}

/// A split at a vertex of a polytope, which becomes the origin; the vertex is not degenerate.
Disjunction randomSplit(Dice& dice, int n, int rows)
{
  while (true)
  {
    const Polyhedron polytope = withUnitRows(randomPolytope(dice, n, rows, VectorXd::Zero(n)));
    const std::vector<VectorXd> vertices = verticesOf(polytope);
    if (vertices.empty())
      continue;
    Polyhedron local =
        translated(polytope, vertices[static_cast<size_t>(dice.integer(0, static_cast<int>(vertices.size()) - 1))]);
    for (Eigen::Index i = 0; i < local.b.size(); ++i)
      if (std::abs(local.b[i]) < 1e-10)
        local.b[i] = 0.0;
    const Disjunction split =
        splitDisjunction(local, randomVector(dice, n).normalized(), -dice.uniform(0.1, 0.4), dice.uniform(0.1, 0.4));
    if (withoutEmptyTerms(split).terms.size() == 2)
      return split;
  }
}

std::vector<VectorXd> verticesOf(const Disjunction& disjunction)
{
  std::vector<VectorXd> all;
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
  {
    const std::vector<VectorXd> one = test_support::verticesOf(disjunction.term(k));
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

/// The dimension of the hull of those vertices that lie on d.x = max, by rank.
int faceRank(const std::vector<VectorXd>& vertices, const VectorXd& direction)
{
  const VectorXd d = direction.norm() > 0.0 ? VectorXd(direction.normalized()) : direction;
  const double top = highest(vertices, d);
  MatrixXd differences(direction.size(), static_cast<Eigen::Index>(vertices.size()));
  Eigen::Index count = 0;
  for (const VectorXd& vertex : vertices)
    if (d.dot(vertex) > top - 1e-7)
      differences.col(count++) = vertex;
  if (count < 2)
    return static_cast<int>(count) - 1;
  const MatrixXd spread = differences.middleCols(1, count - 1).colwise() - differences.col(0);
  Eigen::ColPivHouseholderQR<MatrixXd> factor;
  factor.setThreshold(1e-6);
  return static_cast<int>(factor.compute(spread).rank());
}

void expectDecomposition(const Disjunction& disjunction, const FacetDecomposition& found, bool bounded)
{
  ASSERT_EQ(found.status, NearestPointStatus::CONVERGED) << found.message << found.gap;
  const std::vector<VectorXd> vertices = verticesOf(disjunction);
  VectorXd sum = VectorXd::Zero(found.deepest.size());
  for (const FacetCut& cut : found.cuts)
  {
    EXPECT_LE(highest(vertices, cut.direction), (cut.is_ray ? 0.0 : -1.0) + VALID);
    EXPECT_GT(cut.weight, 0.0);
    sum += cut.weight * cut.direction;
    if (!cut.on_bound && !cut.is_ray)
    {
      EXPECT_EQ(faceRank(vertices, cut.direction), disjunction.dimension() - 1) << cut.direction.transpose();
    }
  }
  EXPECT_LT((sum - found.deepest).norm(), 1e-9 * found.deepest.norm());
  for (size_t k = 1; k < found.norms.size(); ++k)
    EXPECT_LT(found.norms[k], found.norms[k - 1]);
  if (bounded)
    return;
  // Strong duality (6.10) with a projection that knows nothing of Q^-, and lemma 6.14 at the vertices.
  const NearestPoint q = projectOrigin(disjunction);
  ASSERT_EQ(q.status, NearestPointStatus::CONVERGED);
  EXPECT_NEAR(found.deepest.norm() * q.point.norm(), 1.0, 1e-10);
  EXPECT_LT((found.deepest + q.point / q.point.squaredNorm()).norm(), 1e-8 * found.deepest.norm());
  EXPECT_GT(-highest(vertices, -q.point), q.point.squaredNorm() * (1.0 - 1e-9));
}
}  // namespace

TEST(DisjunctionTest, FacesHaveTheDimensionOfTheirVertices)
{
  Dice dice(1);
  for (int draw = 0; draw < 25; ++draw)
  {
    const Disjunction pair = randomPair(dice, dice.integer(2, 4));
    const std::vector<VectorXd> vertices = verticesOf(pair);
    for (int k = 0; k < 3; ++k)
    {
      const VectorXd d = k == 0   ? VectorXd(VectorXd::Zero(pair.dimension()))
                         : k == 1 ? VectorXd(pair.terms[0].A.row(0).transpose())
                                  : randomVector(dice, pair.dimension());
      EXPECT_EQ(faceDimension(pair, d), faceRank(vertices, d)) << draw << ' ' << d.transpose();
      EXPECT_NEAR(support(pair, d).value, highest(vertices, d), VALID);
    }
  }
}

TEST(PolarOracleTest, ReachesTheBottomOfTheIntersectionOfTheReversePolars)
{
  // Lemma 6.4: the answer is in Q^-, by the vertices of both, and no direction around it that is in Q^- is lower.
  Dice dice(2);
  for (int draw = 0; draw < 40; ++draw)
  {
    const Disjunction pair = randomPair(dice, dice.integer(2, 4));
    const std::vector<VectorXd> vertices = verticesOf(pair);
    PolarOracle oracle(pair);
    for (int k = 0; k < 4; ++k)
    {
      const VectorXd direction = k == 0 ? VectorXd(-vertices.front()) : randomVector(dice, pair.dimension());
      const OracleAnswer answer = oracle(direction);
      ASSERT_EQ(answer.status, OracleStatus::FOUND);
      const VectorXd& d = answer.generator.value;
      EXPECT_LE(highest(vertices, d), (answer.generator.is_ray ? 0.0 : -1.0) + VALID * (1.0 + d.norm()));
      for (size_t term = 0; term < 2; ++term)  // Farkas' multipliers, (7.14)
      {
        EXPECT_GE(oracle.multipliers(term).minCoeff(), -1e-9);
        EXPECT_LT((pair.terms[term].A.transpose() * oracle.multipliers(term) - d).norm(), VALID * (1.0 + d.norm()));
      }
      if (answer.generator.is_ray)
      {
        EXPECT_LT(direction.dot(d), 0.0);
        continue;
      }
      for (int other = 0; other < 50; ++other)
      {
        const VectorXd guess = d + dice.logUniform(0.01, 1.0) * randomVector(dice, pair.dimension());
        const double top = highest(vertices, guess);
        if (top < 0.0)
        {
          EXPECT_GE(direction.dot(-guess / top), direction.dot(d) - VALID);
        }
      }
    }
  }
}

TEST(FacetDecompositionTest, OfTwoPolytopes)
{
  Dice dice(3);
  for (int draw = 0; draw < 60; ++draw)
  {
    SCOPED_TRACE(draw);
    const Disjunction pair = randomPair(dice, dice.integer(2, 4));
    expectDecomposition(pair, decomposeDeepestCut(pair), false);
  }
}

TEST(FacetDecompositionTest, OfSplitsWithAndWithoutTheBound)
{
  Dice dice(4);
  int facets = 0, on_bound = 0;
  for (int draw = 0; draw < 60; ++draw)
  {
    SCOPED_TRACE(draw);
    const Disjunction split = randomSplit(dice, dice.integer(2, 4), 3);
    for (const double factor : {0.0, 1.0, 100.0})
      for (const DecompositionStart start : {DecompositionStart::MOST_VIOLATED, DecompositionStart::PROJECTION})
      {
        if (start == DecompositionStart::PROJECTION && factor == 1.0)
          continue;  // the projection is of Q^-, the bound may cut it off
        DecompositionOptions options;
        options.bound_factor = factor;
        options.start = start;
        const FacetDecomposition found = decomposeDeepestCut(split, options);
        expectDecomposition(split, found, factor == 1.0);
        for (const FacetCut& cut : found.cuts)
        {
          facets += !cut.is_ray && !cut.on_bound ? 1 : 0;
          on_bound += cut.on_bound ? 1 : 0;
        }
      }
  }
  EXPECT_GT(facets, 200);
  EXPECT_GT(on_bound, 0);
}

TEST(IntersectionCutTest, IsValidAndFulfilsTheBoundItSets)
{
  Dice dice(5);
  for (int draw = 0; draw < 60; ++draw)
  {
    const Disjunction split = randomSplit(dice, dice.integer(2, 5), 2);
    const IntersectionCut cut = intersectionCut(split);
    ASSERT_TRUE(cut.found);
    EXPECT_LE(highest(verticesOf(split), cut.direction), -1.0 + VALID);
    // (7.24): it passes through the points where the edges of the cone leave the split.
    const int n = split.dimension();
    MatrixXd basis(n, n);
    for (int k = 0; k < n; ++k)
      basis.row(k) = split.common.A.row(cut.basis[static_cast<size_t>(k)]);
    const MatrixXd edges = -basis.colPivHouseholderQr().solve(MatrixXd::Identity(n, n));
    for (int k = 0; k < n; ++k)
    {
      const double slope = split.terms[0].A.row(0).dot(edges.col(k));
      const double length = slope < 0.0 ? split.terms[0].b[0] / slope : -split.terms[1].b[0] / slope;
      EXPECT_NEAR(cut.direction.dot(length * edges.col(k)), -1.0, 1e-8) << draw;
    }
    PolarOracle enough(split, cut.bound * (1.0 + 1e-9));
    EXPECT_EQ(enough(cut.direction).status, OracleStatus::FOUND);
    EXPECT_LE(enough.multiplierSum(), cut.bound * (1.0 + 1e-6));
  }
  // Not a vertex: no basis.
  Polyhedron strip = {MatrixXd(2, 2), Vector2d(0.0, 1.0)};
  strip.A << 0, 1, 0, -1;
  EXPECT_FALSE(intersectionCut(splitDisjunction(strip, Vector2d(1, 0), -0.5, 0.5)).found);
}

TEST(MostViolatedCutTest, UnderNormsItIsTheDistanceInTheDualNorm)
{
  // Theorem 6.11 with its signs put right, the distance by a linear program of its own over the hull of the vertices.
  Dice dice(6);
  for (int draw = 0; draw < 40; ++draw)
  {
    const Disjunction pair = randomPair(dice, dice.integer(2, 4));
    const std::vector<VectorXd> vertices = verticesOf(pair);
    const int n = pair.dimension(), count = static_cast<int>(vertices.size());
    for (const bool maximum : {true, false})
    {
      LinearProgram distance;  // columns: weights, then bounds t_j of |x_j| (one for all in the maximum norm)
      for (int i = 0; i < count; ++i)
        distance.addColumn(0.0, LinearProgram::INFINITE, 0.0);
      for (int j = 0; j < (maximum ? 1 : n); ++j)
        distance.addColumn(0.0, LinearProgram::INFINITE, 1.0);
      std::vector<int> all;
      for (int i = 0; i < count; ++i)
        all.push_back(i);
      distance.addRow(1.0, 1.0, all, std::vector<double>(static_cast<size_t>(count), 1.0));
      for (int j = 0; j < n; ++j)
        for (const double sign : {1.0, -1.0})
        {
          std::vector<int> columns = all;
          std::vector<double> values;
          for (const VectorXd& vertex : vertices)
            values.push_back(sign * vertex[j]);
          columns.push_back(count + (maximum ? 0 : j));
          values.push_back(1.0);
          distance.addRow(0.0, LinearProgram::INFINITE, columns, values);
        }
      ASSERT_TRUE(distance.solve(10000));
      const double expected = distance.solution().tail(maximum ? 1 : n).sum();
      const ViolatedCut cut = mostViolatedCut(pair, maximum ? Normalisation::ONE_NORM : Normalisation::MAXIMUM_NORM);
      ASSERT_TRUE(cut.found);
      EXPECT_NEAR(cut.violation, expected, VALID);
      EXPECT_LE(highest(vertices, cut.direction), -1.0 + VALID);
    }
  }
}

TEST(MostViolatedCutTest, OfRemark718IsValidAndNoShallowerThanItsNormalisationAllows)
{
  Dice dice(7);
  for (int draw = 0; draw < 40; ++draw)
  {
    const Disjunction split = randomSplit(dice, dice.integer(2, 4), 3);
    const IntersectionCut intersection = intersectionCut(split);
    const std::vector<VectorXd> vertices = verticesOf(split);
    const FacetDecomposition deepest = decomposeDeepestCut(split, {0.0, DecompositionStart::MOST_VIOLATED, {}});
    for (const Normalisation normalisation : {Normalisation::MULTIPLIERS, Normalisation::LIFT_AND_PROJECT})
    {
      const ViolatedCut cut = mostViolatedCut(split, normalisation, intersection.bound);
      ASSERT_TRUE(cut.found);
      EXPECT_NEAR(highest(vertices, cut.direction), -1.0, VALID);
      EXPECT_LE(1.0 / cut.direction.norm(), deepest.depth * (1.0 + 1e-8));
      if (normalisation == Normalisation::MULTIPLIERS)  // the intersection cut has violation 1
      {
        EXPECT_GE(cut.violation, 1.0 - 1e-9);
      }
    }
  }
}

TEST(DisjunctionTest, OneEmptySideLeavesTheOther)
{
  // 7.3.3: beyond x = 1/2 there is nothing; cuts by both terms are valid, without the empty one the deepest is x_1 <=
  // -1/2.
  Polyhedron box = {MatrixXd(4, 2), Eigen::Vector4d(0.0, 2.0, 1.0, 1.0)};
  box.A << 1, 0, -1, 0, 0, 1, 0, -1;
  const Disjunction split = splitDisjunction(box, Vector2d(1, 0), -0.5, 0.5);
  const Disjunction left = withoutEmptyTerms(split);
  ASSERT_EQ(left.terms.size(), 1U);
  const FacetDecomposition found = decomposeDeepestCut(left);
  EXPECT_LT((found.deepest - Vector2d(2, 0)).norm(), 1e-9);
  const FacetDecomposition both = decomposeDeepestCut(split, {0.0, DecompositionStart::MOST_VIOLATED, {}});
  for (const FacetCut& cut : both.cuts)
    EXPECT_LE(highest(verticesOf(left), cut.direction), (cut.is_ray ? 0.0 : -1.0) + VALID);
}

TEST(DisjunctionTest, AFlatSetIsCutStill)
{
  // Figure 7.7: Q is a segment of the horizontal axis.
  Disjunction segment = {{MatrixXd(2, 2), VectorXd::Zero(2)},
                         {{Eigen::RowVector2d(1, 0), VectorXd::Constant(1, -1.0)},
                          {Eigen::RowVector2d(1, 0), VectorXd::Constant(1, -2.0)}}};
  segment.common.A << 0, 1, 0, -1;
  EXPECT_EQ(faceDimension(segment, Vector2d::Zero()), 1);
  EXPECT_EQ(faceDimension(segment, Vector2d(1, 0.3)), 0);
  const FacetDecomposition found = decomposeDeepestCut(segment);
  ASSERT_EQ(found.status, NearestPointStatus::CONVERGED);
  EXPECT_LT((found.deepest - Vector2d(1, 0)).norm(), 1e-9);
}

TEST(DisjunctionTest, SaysWhatIsWrong)
{
  const Polyhedron plane = {MatrixXd(0, 2), VectorXd(0)};
  EXPECT_THROW(splitDisjunction(plane, Vector2d(1, 0), 0.5, 1.0), std::invalid_argument);
  EXPECT_THROW(validate(Disjunction{plane, {}}), std::invalid_argument);
  const Disjunction around = {plane, {{Eigen::RowVector2d(1, 0), VectorXd::Constant(1, 1.0)}}};
  EXPECT_THROW(PolarOracle{around}, std::invalid_argument);
}

TEST(LiftAndProjectTest, TheProjectionIsTheHullOfBothSides)
{
  // Lemma 7.19: support functions of M_j in the directions (d, 0) are those of P_0 and P_1.
  Dice dice(8);
  int cuts = 0;
  for (int draw = 0; draw < 40; ++draw)
  {
    const int n = dice.integer(2, 5), j = dice.integer(0, n - 1);
    Polyhedron P = {MatrixXd::Zero(2 * n + 2, n), VectorXd::Zero(2 * n + 2)};
    for (int i = 0; i < n; ++i)
    {
      P.A(2 * i, i) = 1.0;
      P.b[2 * i] = 1.0;
      P.A(2 * i + 1, i) = -1.0;
    }
    for (int i = 2 * n; i < P.rows(); ++i)
    {
      P.A.row(i) = randomVector(dice, n).transpose();
      P.b[i] = 0.5 * P.A.row(i).sum() + dice.uniform(0.0, 0.4);
    }
    SupportProgram lifted(liftedPolyhedron(P, j));
    Disjunction sides = {P, {}};
    for (const double value : {0.0, 1.0})
    {
      Polyhedron fixed = {MatrixXd::Zero(2, n), Vector2d(value, -value)};
      fixed.A(0, j) = 1.0;
      fixed.A(1, j) = -1.0;
      sides.terms.push_back(fixed);
    }
    for (int k = 0; k < 5; ++k)
    {
      VectorXd d = VectorXd::Zero(2 * n - 1);
      d.head(n) = randomVector(dice, n);
      EXPECT_NEAR(lifted.maximise(d).value, support(sides, d.head(n)).value, VALID);
    }
    const VectorXd point = SupportProgram(P).maximise(randomVector(dice, n)).point;
    const LiftAndProjectCut cut = liftAndProjectCut(P, j, point);
    if (point[j] > 1e-6 && point[j] < 1.0 - 1e-6)  // a vertex of P is in the hull only with x_j whole
    {
      ASSERT_TRUE(cut.found);
      EXPECT_LE(support(sides, cut.direction).value, cut.right_hand_side + VALID);
      EXPECT_GT(cut.direction.dot(point) - cut.right_hand_side, 1e-9);
      ++cuts;
    }
    else
    {
      EXPECT_FALSE(cut.found);
    }
  }
  EXPECT_GT(cuts, 5);
  EXPECT_THROW(liftAndProjectCut({MatrixXd(0, 2), VectorXd(0)}, 2, Vector2d(0, 0)), std::invalid_argument);
}
