/**
 * @file least_norm_test.cpp
 * @brief Forces that the loads ask for: closed forms, then random hyperstatic problems against test/support's own
 * bound.
 */
#include "frictional_contact_sim/solver/least_norm.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "frictional_contact_sim/problem/law_functions.h"
#include "support/allocation_counter.h"
#include "support/hand_problems.h"
#include "support/least_norm_check.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
constexpr double THRESHOLD = 1e-9;
/// Of r, relative: to round-off, docs/residuals.md. Found: 1e-14 to 1e-11.
constexpr double EXACT = 1e-10;

struct Case
{
  IncrementalProblem problem;
  Solution solution;
};

/// At rest under the loads that r (and lambda) carry: v = 0, u = w, f = H^T r + G^T lambda.
Case caseOf(const Eigen::MatrixXd& M, const Eigen::MatrixXd& H, const std::vector<Law>& laws, const Eigen::VectorXd& r,
            const Eigen::MatrixXd& G = {}, const Eigen::VectorXd& lambda = {})
{
  Case made;
  made.problem.M = sparse(M);
  made.problem.H = sparse(H);
  made.problem.G = sparse(G.size() > 0 ? G : Eigen::MatrixXd(0, M.rows()));
  made.problem.laws = laws;
  made.problem.w = Eigen::VectorXd::Zero(H.rows());
  made.problem.b = Eigen::VectorXd::Zero(made.problem.G.rows());
  made.solution.r = r;
  made.solution.lambda = lambda;
  made.solution.u = made.problem.w;
  made.solution.v = Eigen::VectorXd::Zero(M.rows());
  made.problem.f = H.transpose() * r;
  if (G.size() > 0)
    made.problem.f += G.transpose() * lambda;
  return made;
}

Eigen::VectorXd thresholds(const IncrementalProblem& problem)
{
  return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(problem.laws.size()), THRESHOLD);
}

LeastNorm::Report improve(Case& given)
{
  LeastNorm least_norm;
  return least_norm.improve(given.problem, thresholds(given.problem), given.solution);
}

/// |H^T (r - r*) + G^T (lambda - lambda*)| over the largest term.
double forceChange(const Case& before, const Case& after)
{
  const IncrementalProblem& problem = before.problem;
  const Eigen::VectorXd loads = problem.H.transpose() * before.solution.r;
  Eigen::VectorXd change = problem.H.transpose() * (after.solution.r - before.solution.r);
  double scale = std::max(loads.norm(), 1e-300);
  if (problem.bilaterals() > 0)
  {
    const Eigen::VectorXd others = problem.G.transpose() * before.solution.lambda;
    change += problem.G.transpose() * (after.solution.lambda - before.solution.lambda);
    scale = std::max(scale, others.norm());
  }
  return change.norm() / scale;
}

/// Largest distance of an r_i to its set.
double outside(const Case& given)
{
  double worst = 0.0;
  int row = 0;
  for (const Law& law : given.problem.laws)
  {
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
    r.head(law.dimension()) = given.solution.r.segment(row, law.dimension());
    Eigen::Vector3d nearest = r;
    projectImpulse(law, nearest.data());
    worst = std::max(worst, (r - nearest).norm());
    row += law.dimension();
  }
  return worst;
}

double relativeDistance(const Eigen::VectorXd& a, const Eigen::VectorXd& b)
{
  return (a - b).norm() / std::max(a.norm(), 1e-300);
}

/// Rows of a contact of a free body at x from its centre: normal, two tangents.
Eigen::MatrixXd contactRows(const Eigen::Vector3d& x, const Eigen::Vector3d& normal)
{
  Eigen::Matrix3d axes;
  axes.row(0) = normal.normalized();
  axes.row(1) = normal.unitOrthogonal();
  axes.row(2) = axes.row(0).cross(axes.row(1));
  Eigen::Matrix3d cross;
  cross << 0.0, -x[2], x[1], x[2], 0.0, -x[0], -x[1], x[0], 0.0;
  Eigen::MatrixXd rows(3, 6);
  rows << axes, -axes * cross;
  return rows;
}

/// A box of 2 kg and its contacts.
Case boxOn(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& normals, double friction,
           const Eigen::VectorXd& r)
{
  Eigen::VectorXd inertia(6);
  inertia << 2.0, 2.0, 2.0, 0.3, 0.3, 0.3;
  Eigen::MatrixXd H(3 * points.size(), 6);
  for (size_t i = 0; i < points.size(); ++i)
    H.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = contactRows(points[i], normals[i]);
  return caseOf(inertia.asDiagonal(), H, std::vector<Law>(points.size(), {LawType::COULOMB_3D, friction}), r);
}

Case table(double friction, const Eigen::VectorXd& normal_loads)
{
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::VectorXd r = Eigen::VectorXd::Zero(12);
  for (int i = 0; i < 4; ++i)
    r[3 * i] = normal_loads[i];
  return boxOn({{1, 0.5, -0.2}, {-1, 0.5, -0.2}, {-1, -0.5, -0.2}, {1, -0.5, -0.2}}, {up, up, up, up}, friction, r);
}

/**
 * Random hyperstatic problem: low-rank H and G, every law, mu from 0 to 10; r* = r_0 plus `stress` times an impulse
 * without effect.
 */
Case randomCase(std::uint32_t seed, double stress)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto gaussian = [&](int rows, int columns)
  { return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); })); };
  const int nv = 4 + static_cast<int>(random() % 14);
  std::vector<Law> laws;
  const int count = 3 + static_cast<int>(random() % 6);
  for (int i = 0; i < count; ++i)
  {
    const double frictions[] = {0.0, 0.3, 1.0, 10.0};
    const auto kind = random() % 6;
    if (kind < 3)
      laws.push_back({LawType::COULOMB_3D, frictions[random() % 4]});
    else if (kind == 3)
      laws.push_back({LawType::COULOMB_2D, frictions[random() % 4]});
    else
      laws.push_back(kind == 4 ? Law{LawType::UNILATERAL, 0.0} : Law{LawType::DRY_FRICTION, 10.0 * uniform(random)});
  }
  const int rows = rowCount(laws), rank = std::min(nv, 2 + static_cast<int>(random() % 6));
  Eigen::VectorXd load(rows), inner(rows), w = Eigen::VectorXd::Zero(rows);
  int row = 0;
  for (const Law& law : laws)
  {
    const int d = law.dimension();
    for (Eigen::VectorXd* r : {&load, &inner})
    {
      r->segment(row, d).setZero();
      (*r)[row] = law.type == LawType::DRY_FRICTION ? law.coefficient * (uniform(random) - 0.5) : 0.2 + uniform(random);
      for (int k = 1; k < d; ++k)
        (*r)[row + k] = 0.6 * law.coefficient * (*r)[row] * (2.0 * uniform(random) - 1.0);
    }
    if (law.type == LawType::DRY_FRICTION)
      inner[row] = 0.0;
    if (random() % 6 == 0)  // slides, or has opened
    {
      const bool slides = law.isCoulomb() && law.coefficient > 0.0 && random() % 2 == 0;
      inner.segment(row, d).setZero();
      if (slides)
      {
        w[row + 1] = 0.1;
        load.segment(row, d).setZero();
        load[row] = 0.5;
        load[row + 1] = -law.coefficient * load[row];
        inner.segment(row, d) = load.segment(row, d);
      }
      else
      {
        w[row] = 0.1;
        load.segment(row, d).setZero();
        if (law.type == LawType::DRY_FRICTION)
          load[row] = -law.coefficient;
      }
    }
    row += d;
  }
  Eigen::MatrixXd H = gaussian(rows, rank) * gaussian(rank, nv);
  // `inner` is to have no effect, exactly up to round-off.
  if (inner.norm() > 0.0)
    H -= inner * (inner.transpose() * H) / inner.squaredNorm();
  const Eigen::MatrixXd root = gaussian(nv, nv);
  const Eigen::MatrixXd M = root * root.transpose() + Eigen::MatrixXd::Identity(nv, nv);
  Eigen::MatrixXd G;
  Eigen::VectorXd lambda;
  if (random() % 2 == 0)
  {
    G = gaussian(3, 2) * gaussian(2, nv);
    lambda = gaussian(3, 1);
  }
  Case made = caseOf(M, H, laws, load + stress * inner, G, lambda);
  made.problem.w = made.solution.u = w;
  return made;
}
}  // namespace

TEST(LeastNormTest, BoxOnFourContactsCarriesItsWeightEquallyWithoutFriction)
{
  // r* stands on a diagonal.
  Case given = table(0.5, Eigen::Vector4d(0.05, 0.0, 0.05, 0.0));
  const Case before = given;
  const LeastNorm::Report report = improve(given);
  EXPECT_EQ(report.dependent_islands, 1);
  EXPECT_EQ(report.changed_islands, 1);
  EXPECT_EQ(report.inexact_islands, 0);
  EXPECT_NEAR(report.largest_ratio, std::sqrt(2.0), 1e-12);
  for (int i = 0; i < 4; ++i)
  {
    EXPECT_NEAR(given.solution.r[3 * i], 0.025, 1e-15);
    EXPECT_NEAR(given.solution.r.segment<2>(3 * i + 1).norm(), 0.0, 1e-15);
  }
  EXPECT_EQ(given.solution.v, before.solution.v);
  EXPECT_EQ(given.solution.u, before.solution.u);
}

TEST(LeastNormTest, TableWithItsLoadOffCentreIsLinearInThePosition)
{
  // Load 1 at (0.3, 0.1), feet at (+-1, +-0.5), frictionless: r_i = 1/4 (1 + 0.3 x_i/1 + 0.1 y_i/0.25).
  const double x = 0.3, y = 0.1;
  const Eigen::Vector4d linear = 0.25 * Eigen::Vector4d(1 + x + 2 * y, 1 - x + 2 * y, 1 - x - 2 * y, 1 + x - 2 * y);
  const Eigen::Vector4d twist(1.0, -1.0, 1.0, -1.0);
  Case given = table(0.0, linear + 0.07 * twist);
  improve(given);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(given.solution.r[3 * i], linear[i], 1e-14);
}

TEST(LeastNormTest, FarOffCentreTheFootThatWouldPullCarriesNothing)
{
  // At (0.8, 0.3) the linear law would pull at the far foot: three feet, whose loads follow from statics.
  const Eigen::Vector4d linear = 0.25 * Eigen::Vector4d(1 + 0.8 + 0.6, 1 - 0.8 + 0.6, 1 - 0.8 - 0.6, 1 + 0.8 - 0.6);
  const Eigen::Vector4d twist(1.0, -1.0, 1.0, -1.0);
  Case given = table(0.0, linear + 0.15 * twist);
  improve(given);
  const Eigen::Vector4d expected = linear - linear[2] * twist;
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(given.solution.r[3 * i], expected[i], 1e-14);
}

TEST(LeastNormTest, BoxBetweenTwoWallsKeepsNoForceOnThem)
{
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  for (const double stress : {1.0, 1e4, 1e8})
  {
    Eigen::VectorXd r = Eigen::VectorXd::Zero(12);
    for (int i = 0; i < 4; ++i)
      r[3 * i] = stress;
    Case given = boxOn({{-1, 0.5, 0}, {-1, -0.5, 0}, {1, 0.5, 0}, {1, -0.5, 0}}, {x, x, -x, -x}, 0.4, r);
    improve(given);
    EXPECT_EQ(given.solution.r.norm(), 0.0) << stress;
  }
}

TEST(LeastNormTest, PinchKeepsTheSqueezeThatFrictionNeeds)
{
  const double weight = 0.02, friction = 0.5;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  Eigen::VectorXd r = Eigen::VectorXd::Zero(6);
  Case given = boxOn({{-0.5, 0, 0}, {0.5, 0, 0}}, {x, -x}, friction, r);
  const Eigen::MatrixXd H(given.problem.H);
  for (int i = 0; i < 2; ++i)
  {
    given.solution.r[3 * i] = 3.0;
    given.solution.r.segment<2>(3 * i + 1) = 0.5 * weight * H.block<2, 1>(3 * i + 1, 2);
  }
  Case before = given;
  const LeastNorm::Report report = improve(given);
  EXPECT_EQ(report.inexact_islands, 0);
  // The weight at either finger 1/2, within its cone: a squeeze of weight / (2 mu), not less.
  for (int i = 0; i < 2; ++i)
  {
    EXPECT_NEAR(given.solution.r[3 * i], weight / (2.0 * friction), 1e-12);
    EXPECT_NEAR(given.solution.r.segment<2>(3 * i + 1).norm(), weight / 2.0, 1e-12);
  }
  EXPECT_LE(forceChange(before, given), 1e-11);
}

TEST(LeastNormTest, SlidingContactsStayOnTheirRays)
{
  Case given = table(0.5, Eigen::Vector4d(0.04, 0.01, 0.04, 0.01));
  for (int i = 0; i < 4; ++i)
  {
    given.solution.r[3 * i + 1] = -0.5 * given.solution.r[3 * i];
    given.solution.u[3 * i + 1] = 0.3;
  }
  const Case before = given;
  improve(given);
  for (int i = 0; i < 4; ++i)
  {
    EXPECT_NEAR(given.solution.r[3 * i + 1], -0.5 * given.solution.r[3 * i], 1e-15);
    EXPECT_EQ(given.solution.r[3 * i + 2], 0.0);
  }
  EXPECT_LE(forceChange(before, given), 1e-12);
  EXPECT_LT(given.solution.r.norm(), before.solution.r.norm());
}

TEST(LeastNormTest, RandomProblemsReachTheIndependentBound)
{
  int dependent = 0, inexact = 0;
  for (std::uint32_t seed = 1; seed <= 300; ++seed)
    for (const double stress : {0.0, 1.0, 1e3})
    {
      Case given = randomCase(seed, stress);
      const Case before = given;
      const LeastNorm::Report report = improve(given);
      dependent += report.dependent_islands;
      inexact += report.inexact_islands;
      const LeastNormBound bound = leastNormBound(before.problem, thresholds(before.problem), given.solution);
      const double start = leastNormBound(before.problem, thresholds(before.problem), before.solution, 1).sum;
      // The largest of r* is what its generalized force is known by.
      EXPECT_LE(forceChange(before, given), 1e-11 + 1e-15 * stress) << seed << " " << stress;
      EXPECT_LE(outside(given), outside(before) + 1e-15 * before.solution.r.norm()) << seed;
      EXPECT_LE(bound.sum, start * (1.0 + 1e-14)) << seed;
      // First-order ascent: the certificate itself is good to its own defect.
      if (report.inexact_islands == 0)
      {
        EXPECT_LE(bound.sum, bound.bound * (1.0 + 1e-9 + 10.0 * bound.gap) + 1e-24 * start) << seed << " " << stress;
      }
      else
      {
        EXPECT_LE(bound.sum, 2.0 * bound.bound) << seed << " " << stress;
      }
    }
  EXPECT_GT(dependent, 300);
  EXPECT_LE(inexact, dependent / 100);
}

TEST(LeastNormTest, WhateverTheSelfStressTheAnswerIsTheSame)
{
  for (std::uint32_t seed = 1; seed <= 100; ++seed)
  {
    Case plain = randomCase(seed, 0.0);
    if (improve(plain).inexact_islands > 0)
      continue;
    for (const double stress : {1.0, 1e3, 1e5})
    {
      Case stressed = randomCase(seed, stress);
      if (improve(stressed).inexact_islands > 0)
        continue;
      // What H^T r* loses to round-off with the stress in it comes on top.
      EXPECT_LE(relativeDistance(plain.solution.r, stressed.solution.r), 1e-9 + 1e-13 * stress)
          << seed << " " << stress;
    }
  }
}

TEST(LeastNormTest, SecondCallChangesNoBit)
{
  for (std::uint32_t seed = 1; seed <= 100; ++seed)
  {
    Case given = randomCase(seed, 1.0);
    if (improve(given).inexact_islands > 0)
      continue;
    const Case before = given;
    EXPECT_EQ(improve(given).changed_islands, 0) << seed;
    EXPECT_EQ(given.solution.r, before.solution.r) << seed;
    EXPECT_EQ(given.solution.lambda, before.solution.lambda) << seed;
  }
}

TEST(LeastNormTest, AnotherIslandChangesNoBit)
{
  for (std::uint32_t seed = 1; seed <= 30; ++seed)
  {
    Case first = randomCase(seed, 2.0), second = randomCase(seed + 1000, 3.0);
    const int rows = first.problem.rows(), nb = first.problem.bilaterals();
    const auto both = [](const SparseRows& a, const SparseRows& b)
    {
      Eigen::MatrixXd joined = Eigen::MatrixXd::Zero(a.rows() + b.rows(), a.cols() + b.cols());
      joined.topLeftCorner(a.rows(), a.cols()) = Eigen::MatrixXd(a);
      joined.bottomRightCorner(b.rows(), b.cols()) = Eigen::MatrixXd(b);
      return joined;
    };
    std::vector<Law> laws = first.problem.laws;
    laws.insert(laws.end(), second.problem.laws.begin(), second.problem.laws.end());
    Eigen::VectorXd r(rows + second.problem.rows()), lambda(nb + second.problem.bilaterals()), u(r.size());
    r << first.solution.r, second.solution.r;
    u << first.solution.u, second.solution.u;
    lambda << first.solution.lambda, second.solution.lambda;
    Case joined = caseOf(both(first.problem.M, second.problem.M), both(first.problem.H, second.problem.H), laws, r,
                         both(first.problem.G, second.problem.G), lambda);
    joined.solution.u = joined.problem.w = u;
    improve(first);
    improve(joined);
    EXPECT_EQ(joined.solution.r.head(rows), first.solution.r) << seed;
    // lambda is DelassusReduction's, whose order of elimination is that of the whole M.
    EXPECT_LE(relativeDistance(joined.solution.lambda.head(nb), first.solution.lambda), 1e-11) << seed;
  }
}

TEST(LeastNormTest, MirroredAndRenumberedContactsGetMirroredForces)
{
  Case given = table(0.3, Eigen::Vector4d(0.5, 0.1, 0.4, 0.2));
  Case turned = table(0.3, Eigen::Vector4d(0.4, 0.2, 0.5, 0.1));  // half a turn about z: feet 0, 2 and 1, 3 swap
  improve(given);
  improve(turned);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(given.solution.r[3 * i], turned.solution.r[3 * ((i + 2) % 4)], 1e-15);
}

TEST(LeastNormTest, ImpulsesOutsideTheirConesNeverGetWorse)
{
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (std::uint32_t seed = 1; seed <= 100; ++seed)
  {
    Case given = randomCase(seed, 1.0);
    const double size = seed % 2 == 0 ? 1e-9 : 1.0;
    for (double& value : given.solution.r)
      value += size * normal(random);
    given.problem.f = given.problem.H.transpose() * given.solution.r;
    if (given.problem.bilaterals() > 0)
      given.problem.f += given.problem.G.transpose() * given.solution.lambda;
    const Case before = given;
    improve(given);
    ASSERT_TRUE(given.solution.r.allFinite());
    EXPECT_LE(outside(given), outside(before) * (1.0 + 1e-14) + 1e-15) << seed;
    EXPECT_LE(forceChange(before, given), 2e-12) << seed;
  }
  Case given = randomCase(1, 1.0);
  given.solution.r.setConstant(std::nan(""));
  EXPECT_EQ(improve(given).changed_islands, 0);
}

TEST(LeastNormTest, LargeIslandsEndBelowTwiceTheBound)
{
  // 160 cubes side by side on 4 points each would be islands; a row of cubes pressed together is one.
  for (const int boxes : {20, 40})
  {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const int contacts = 4 * (boxes + 1);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3 * contacts, 6 * boxes);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(3 * contacts);
    for (int i = 0; i <= boxes; ++i)
      for (int k = 0; k < 4; ++k)
      {
        const Eigen::Vector3d point(0.5, k % 2 == 0 ? 0.5 : -0.5, k < 2 ? 0.5 : -0.5);
        const int row = 3 * (4 * i + k);
        if (i < boxes)
          H.block(row, 6 * i, 3, 6) = contactRows(point - x, x);
        if (i > 0)
          H.block(row, 6 * (i - 1), 3, 6) = -contactRows(point, x);
        r[row] = 1.0 + 0.2 * (k % 2);
        r[row + 1] = 0.02 * i;
      }
    Case given = caseOf(Eigen::MatrixXd::Identity(6 * boxes, 6 * boxes), H,
                        std::vector<Law>(static_cast<size_t>(contacts), {LawType::COULOMB_3D, 0.8}), r);
    const Case before = given;
    const LeastNorm::Report report = improve(given);
    const LeastNormBound bound = leastNormBound(before.problem, thresholds(before.problem), given.solution, 5000);
    EXPECT_LE(bound.sum, 2.0 * bound.bound) << boxes;
    EXPECT_LE(forceChange(before, given), 1e-11) << boxes;
    EXPECT_EQ(report.dependent_islands, 1);
  }
}

TEST(LeastNormTest, AllocatesNothingWhenSizesRepeat)
{
  Case first = randomCase(3, 1.0);
  const Case again = first;
  const Eigen::VectorXd limits = thresholds(first.problem);
  LeastNorm least_norm;
  DelassusReduction reduction;
  reduction.compute(first.problem);
  least_norm.improve(first.problem, reduction, limits, first.solution);
  first.solution = again.solution;
  const AllocationCounter counter;
  least_norm.improve(first.problem, reduction, limits, first.solution);
  EXPECT_EQ(counter.count(), 0);
}
