/**
 * @file uniqueness_test.cpp
 * @brief Uniqueness from W alone, against all solutions of small planar problems by brute force; P-matrices and
 * copositivity against their definitions.
 */
#include "frictional_contact_sim/problem/certificate/uniqueness.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "frictional_contact_sim/math/matrix_classes.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
using Random = std::mt19937;

Eigen::MatrixXd gauss(Eigen::Index rows, Eigen::Index columns, Random& random)
{
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&](auto, auto) { return normal(random); });
}

/** Isolated solutions of a planar problem with regular pieces: four modes a contact, each a linear system. */
int countSolutions(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<double>& friction)
{
  const auto n = static_cast<int>(friction.size());
  int modes = 1, found = 0;
  for (int i = 0; i < n; ++i)
    modes *= 4;
  std::vector<Eigen::VectorXd> solutions;
  for (int code = 0; code < modes; ++code)
  {
    // Unknowns (r, u) of 4 n; rows: u - W r = q and two equations of the mode a contact.
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(4 * n, 4 * n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(4 * n);
    A.topLeftCorner(2 * n, 2 * n) = -W;
    A.topRightCorner(2 * n, 2 * n).setIdentity();
    right.head(2 * n) = q;
    std::vector<int> mode;
    for (int i = 0, rest = code; i < n; ++i, rest /= 4)
    {
      mode.push_back(rest % 4);
      const int N = 2 * i, T = 2 * i + 1, u = 2 * n, row = 2 * n + 2 * i;
      A(row, mode[i] == 0 ? N : u + N) = 1.0;
      if (mode[i] < 2)
        A(row + 1, mode[i] == 0 ? T : u + T) = 1.0;
      else
      {
        A(row + 1, T) = 1.0;
        A(row + 1, N) = mode[i] == 2 ? -friction[i] : friction[i];
      }
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> factor(A);
    if (!factor.isInvertible())
      continue;
    const Eigen::VectorXd x = factor.solve(right);
    bool valid = true;
    for (int i = 0; i < n && valid; ++i)
    {
      const double rN = x[2 * i], rT = x[2 * i + 1], uN = x[2 * n + 2 * i], uT = x[2 * n + 2 * i + 1];
      const double e = 1e-9;
      valid = mode[i] == 0   ? uN >= -e
              : mode[i] == 1 ? rN >= -e && std::abs(rT) <= friction[i] * rN + e
              : mode[i] == 2 ? rN >= -e && uT <= e
                             : rN >= -e && uT >= -e;
    }
    if (valid && std::none_of(solutions.begin(), solutions.end(),
                              [&](const Eigen::VectorXd& other) { return (other - x).norm() < 1e-7; }))
    {
      solutions.push_back(x);
      ++found;
    }
  }
  return found;
}
}  // namespace

TEST(UniquenessTest, ThePlanarMinorsDecideWhetherEveryLoadHasOneSolution)
{
  Random random(21);
  std::uniform_real_distribution<double> uniform(0.05, 1.5);
  int unique = 0, several = 0;
  for (int draw = 0; draw < 200; ++draw)
  {
    const int n = 1 + draw % 3;
    const Eigen::MatrixXd A = gauss(2 * n, 2 * n + draw % 4, random);
    const Eigen::MatrixXd W = A * A.transpose();
    std::vector<double> friction;
    std::vector<Law> laws;
    for (int i = 0; i < n; ++i)
    {
      friction.push_back(uniform(random));
      laws.push_back({LawType::COULOMB_2D, friction.back()});
    }
    const UniquenessReport report = checkUniqueness(localProblem(W, Eigen::VectorXd::Ones(2 * n), laws));
    int other = 0;
    for (int load = 0; load < 12; ++load)
    {
      const int count = countSolutions(W, gauss(2 * n, 1, random), friction);
      other += count != 1;
      if (report.verdict == Uniqueness::UNIQUE_V)
      {
        EXPECT_EQ(count, 1) << "draw " << draw << ", load " << load << ": " << report.message;
      }
    }
    unique += report.verdict == Uniqueness::UNIQUE_V;
    several += report.some_load_has_several && other > 0;
    if (other > 0)
    {
      EXPECT_TRUE(report.some_load_has_several) << "draw " << draw;
    }
  }
  EXPECT_GT(unique, 5);
  EXPECT_GT(several, 2);
}

TEST(UniquenessTest, PainlevesRodIsUniqueExactlyBelowTheFrictionOfTheParadox)
{
  for (const double theta : {0.3, 0.8, 1.2})
    for (const double share : {0.5, 0.99, 1.01, 2.0})
    {
      // W is singular (one velocity), so sticking has no minor: not known, but the sliding minor turns negative.
      const UniquenessReport report = checkUniqueness(painleveRod(theta, share * std::tan(theta), 1.0, 1.0));
      EXPECT_EQ(report.verdict, Uniqueness::UNKNOWN);
      EXPECT_EQ(report.some_load_has_several, share > 1.0);
    }
}

TEST(UniquenessTest, WithoutFrictionVelocitiesAreUniqueWhateverTheRank)
{
  IncrementalProblem box = restingBox(2.0, {0.1, 0.2, 0.3}, 0.0, Eigen::Vector3d::Zero(), {0, 0, -9.81}, 1e-3);
  EXPECT_EQ(checkUniqueness(box).verdict, Uniqueness::UNIQUE_V);
  for (Law& law : box.laws)
    law.coefficient = 0.5;
  EXPECT_EQ(checkUniqueness(box).verdict, Uniqueness::UNKNOWN);
}

TEST(UniquenessTest, ASmallFrictionOnARegularMatrixIsAContraction)
{
  Random random(22);
  const Eigen::MatrixXd A = gauss(9, 9, random);
  const Eigen::MatrixXd W = A * A.transpose() / 9.0 + Eigen::MatrixXd::Identity(9, 9);
  const Eigen::VectorXd q = Eigen::VectorXd::Ones(9);
  const auto report = [&](double mu) {
    return checkUniqueness(localProblem(W, q, std::vector<Law>(3, {LawType::COULOMB_3D, mu})));
  };
  const UniquenessReport small = report(0.1), large = report(0.2);
  EXPECT_NEAR(large.contraction, 2.0 * small.contraction, 1e-9);
  EXPECT_EQ(report(0.9 * 0.1 / small.contraction).verdict, Uniqueness::UNIQUE_V);
  EXPECT_EQ(report(1.1 * 0.1 / small.contraction).verdict, Uniqueness::UNKNOWN);
}

TEST(MatrixClassesTest, PMatricesAreThoseWithPositiveMinors)
{
  Random random(23);
  int yes = 0, no = 0;
  for (int draw = 0; draw < 300; ++draw)
  {
    const int n = 1 + draw % 5;
    const Eigen::MatrixXd A = gauss(n, n, random) + 1.3 * Eigen::MatrixXd::Identity(n, n);
    bool positive = true;
    for (unsigned subset = 1; subset < (1u << n); ++subset)
    {
      std::vector<int> rows;
      for (int i = 0; i < n; ++i)
        if (subset & (1u << i))
          rows.push_back(i);
      Eigen::MatrixXd part(rows.size(), rows.size());
      for (size_t i = 0; i < rows.size(); ++i)
        for (size_t j = 0; j < rows.size(); ++j)
          part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = A(rows[i], rows[j]);
      positive = positive && part.determinant() > 0.0;
    }
    const PMatrixReport report = checkPMatrix(A);
    EXPECT_EQ(report.verdict, positive ? MatrixVerdict::YES : MatrixVerdict::NO);
    (positive ? yes : no) += 1;
  }
  EXPECT_GT(yes, 30);
  EXPECT_GT(no, 30);
  EXPECT_EQ(checkPMatrix(Eigen::Matrix2d::Zero()).verdict, MatrixVerdict::NO);
}

TEST(MatrixClassesTest, CopositivityIsThatOfASampleOfTheOrthant)
{
  Random random(24);
  std::uniform_real_distribution<double> uniform;
  int yes = 0, no = 0;
  for (int draw = 0; draw < 200; ++draw)
  {
    const int n = 2 + draw % 3;
    const Eigen::MatrixXd A = gauss(n, n, random) + (0.4 + uniform(random)) * Eigen::MatrixXd::Ones(n, n);
    const CopositivityReport report = checkCopositivity(A);
    if (report.copositive == MatrixVerdict::NO)
    {
      ++no;
      EXPECT_GE(report.x.minCoeff(), 0.0);
      EXPECT_LT(report.x.dot(A * report.x), 0.0);
      continue;
    }
    ++yes;
    for (int sample = 0; sample < 300; ++sample)
    {
      Eigen::VectorXd x = gauss(n, 1, random).cwiseAbs();
      x *= 1.0 / x.norm();
      if (sample % 2 == 0)
        x[sample % n] = 0.0;
      ASSERT_GE(x.dot(A * x), -1e-12) << draw;
    }
  }
  EXPECT_GT(yes, 20);
  EXPECT_GT(no, 20);
  Eigen::Matrix2d borderline;
  borderline << 1, -1, -1, 1;  // (x - y)^2
  EXPECT_EQ(checkCopositivity(borderline).copositive, MatrixVerdict::YES);
  EXPECT_EQ(checkCopositivity(borderline).strictly, MatrixVerdict::NO);
}
