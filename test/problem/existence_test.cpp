#include "frictional_contact_sim/problem/existence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/random_family.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/** Painleve's rod, Cadoux (2009), (3.32): u_T = u_0 + v cos(theta), u_N = v sin(theta), mu; in 2D or embedded in 3D. */
IncrementalProblem painleveRod(double theta, double mu, double u0, int dimension)
{
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(dimension, 1);
  H(0, 0) = std::sin(theta);
  H(1, 0) = std::cos(theta);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(dimension);
  w[1] = u0;
  return kinematics(H, w, {{dimension == 2 ? LawType::COULOMB_2D : LawType::COULOMB_3D, mu}});
}

RandomFamilyOptions randomOptions(int contacts, std::uint64_t seed)
{
  RandomFamilyOptions options;
  options.velocities = 60;
  options.contacts = contacts;
  options.seed = seed;
  return options;
}
}  // namespace

TEST(ExistencePainleveRodTest, TheCriterionHoldsExactlyWhereTheThesisSays)
{
  for (const int dimension : {2, 3})
    for (const double mu : {0.3, 0.8, 2.0})
      for (const double side : {0.9, 0.99, 1.01, 1.1})
        for (const double u0 : {-1.0, 1.0})
        {
          const double theta = std::atan(side * mu);
          const ExistenceReport report = checkExistence(painleveRod(theta, mu, u0, dimension));
          const bool holds = u0 < 0.0 || side > 1.0;  // (3.31)
          SCOPED_TRACE(testing::Message()
                       << dimension << "D, mu " << mu << ", tan(theta)/mu " << side << ", u0 " << u0);
          EXPECT_EQ(report.verdict, holds ? Existence::CERTIFIED : Existence::UNDECIDED);
          EXPECT_EQ(report.criterion_violated, !holds);
          EXPECT_EQ(report.margin >= 0.0, holds);
          // Otherwise the best is the vertical velocity of (3.4.3): v = -u_0/cos(theta), s = -u_0 tan(theta).
          if (!holds)
          {
            EXPECT_NEAR(report.margin, -u0 * std::tan(theta), 1e-8);  // the simplex tolerance is 1e-9
          }
        }
}

TEST(ExistenceTest, ADiscSqueezedBetweenAStillAndAnApproachingPlaneIsRefutedWhateverTheFriction)
{
  Eigen::MatrixXd H(6, 3);
  H << 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Eigen::VectorXd w = Eigen::VectorXd::Zero(6);
  w[3] = -1.0;  // the upper plane comes down
  for (const double mu : {0.0, 0.5, 10.0})
  {
    const ExistenceReport report =
        checkExistence(kinematics(H, w, {{LawType::COULOMB_3D, mu}, {LawType::COULOMB_3D, mu}}));
    EXPECT_EQ(report.verdict, Existence::REFUTED);
    EXPECT_EQ(report.blocking, (std::vector<int>{0, 1}));
    // The multiplier is the pinch itself: equal impulses on both sides.
    ASSERT_EQ(report.multiplier.size(), 6);
    EXPECT_NEAR(report.multiplier[0], report.multiplier[3], 1e-12);
  }
  w[3] = 1.0;  // it goes up: any small opening velocity does
  EXPECT_EQ(checkExistence(kinematics(H, w, {{LawType::COULOMB_3D, 0.5}, {LawType::COULOMB_3D, 0.5}})).verdict,
            Existence::CERTIFIED);
}

TEST(ExistenceTest, ImmobileSurroundingsAreCertifiedByRest)
{
  const IncrementalProblem box =
      restingBox(2.0, {0.1, 0.2, 0.3}, 0.7, Eigen::Vector3d::Zero(), {0.0, 0.0, -9.81}, 1e-3);
  const ExistenceReport report = checkExistence(box);
  EXPECT_EQ(report.verdict, Existence::CERTIFIED);
  EXPECT_EQ(report.margin, 0.0);  // exactly, nothing is computed
  EXPECT_EQ(report.v, Eigen::VectorXd(Eigen::VectorXd::Zero(6)));
  EXPECT_EQ(checkExistence(kinematics(Eigen::MatrixXd(0, 2), Eigen::VectorXd(0), {})).verdict, Existence::CERTIFIED);
}

TEST(ExistenceTest, TheLargestMarginIsTheClosedFormOfOneContact)
{
  // u = v + w, |v_j| <= R: v_N = R, and each tangential component is brought as near zero as R allows.
  const Eigen::Vector3d w(-1.0, 2.0, 1.5);
  ExistenceOptions options;
  options.maximise = true;
  options.velocity_bound = 1.0;
  const ExistenceReport report =
      checkExistence(kinematics(Eigen::Matrix3d::Identity(), w, {{LawType::COULOMB_3D, 0.5}}), options);
  const double exact = (1.0 - 1.0) - 0.5 * std::hypot(1.0, 0.5);
  EXPECT_LE(report.margin, exact);
  EXPECT_GE(report.upper_bound, exact - 1e-9);  // simplex tolerance
  EXPECT_NEAR(report.margin, exact, options.gap * std::abs(exact));
  const ExistenceReport planar =
      checkExistence(kinematics(Eigen::Matrix2d::Identity(), w.head<2>(), {{LawType::COULOMB_2D, 0.5}}), options);
  EXPECT_NEAR(planar.margin, -0.5, 1e-8);
  EXPECT_EQ(planar.rounds, 2);  // in 2D one program is exact; the other is the frictionless one
}

TEST(ExistenceTest, BilateralRowsRestrictTheCertificateAndRedundantOnesAreHarmless)
{
  IncrementalProblem problem =
      kinematics(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.0, 0.3, 0.0), {{LawType::COULOMB_3D, 0.5}});
  Eigen::MatrixXd G(2, 3);
  G << 1, 0, 0, 2, 0, 0;
  problem.G = sparse(G);
  problem.b = Eigen::Vector2d(-0.1, -0.2);  // the normal velocity is held at 0.1
  const ExistenceReport open = checkExistence(problem);
  EXPECT_EQ(open.verdict, Existence::CERTIFIED);
  EXPECT_NEAR(open.v[0], 0.1, 1e-14);
  problem.b = -problem.b;  // at -0.1
  EXPECT_EQ(checkExistence(problem).verdict, Existence::REFUTED);
  problem.b = Eigen::Vector2d(-0.1, 0.2);  // at 0.1 and at -0.1
  EXPECT_NE(checkExistence(problem).verdict, Existence::CERTIFIED);
}

TEST(ExistenceTest, OneDimensionalLaws)
{
  const Eigen::MatrixXd H = Eigen::Vector2d(1.0, -1.0);
  const Law limit{LawType::UNILATERAL, 0.0};
  // Two limits that close on each other, and the same with dry friction in place of one, which only resists.
  EXPECT_EQ(checkExistence(kinematics(H, Eigen::Vector2d(-1, -1), {limit, limit})).verdict, Existence::REFUTED);
  EXPECT_EQ(checkExistence(kinematics(H, Eigen::Vector2d(-1, -1), {limit, {LawType::DRY_FRICTION, 2.0}})).verdict,
            Existence::CERTIFIED);
  EXPECT_EQ(checkExistence(kinematics(H, Eigen::Vector2d(-1, -1), {limit, {LawType::BILATERAL, 0.0}})).verdict,
            Existence::REFUTED);
}

TEST(ExistenceTest, EveryVerdictOnRandomProblemsSurvivesAnIndependentCheck)
{
  int certified = 0, violated = 0;
  for (const int contacts : {20, 40, 50, 60, 100})
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
    {
      const IncrementalProblem problem = randomFamilyProblem(randomOptions(contacts, seed));
      const ExistenceReport report = checkExistence(problem);
      const Eigen::Matrix<long double, -1, -1> H = Eigen::MatrixXd(problem.H).cast<long double>();
      if (report.verdict == Existence::CERTIFIED)
      {
        ++certified;
        const Eigen::Matrix<long double, -1, 1> u = H * report.v.cast<long double>() + problem.w.cast<long double>();
        for (int i = 0; i < contacts; ++i)
          EXPECT_GE(u[3 * i], problem.laws[static_cast<size_t>(i)].coefficient * u.segment(3 * i + 1, 2).norm());
      }
      else if (report.criterion_violated)
      {
        ++violated;
        const Eigen::Matrix<long double, -1, 1> r = report.multiplier.cast<long double>();
        for (int i = 0; i < contacts; ++i)
          EXPECT_LE(r.segment(3 * i + 1, 2).norm(),
                    problem.laws[static_cast<size_t>(i)].coefficient * r[3 * i] + 1e-18L);
        const long double power = r.dot(problem.w.cast<long double>());
        EXPECT_LT(power, 0.0L);
        EXPECT_LT((H.transpose() * r).lpNorm<1>() * 1e6L, -power);
        EXPECT_LE(report.margin, report.upper_bound);
      }
      // f and M have no part in it, and the local form of the same problem gives the same answer.
      EXPECT_EQ(checkExistence(reduce(problem)).verdict, report.verdict) << contacts << " contacts, seed " << seed;
    }
  EXPECT_GT(certified, 5);
  EXPECT_GT(violated, 5);
}

TEST(ExistenceTest, TheThirtyProblemsOfTheThesisFamilyAreCertified)
{
  for (const auto& table : {smallRandomFamily(), largeRandomFamily()})
    for (const RandomFamilyEntry& entry : table)
      EXPECT_EQ(checkExistence(randomFamilyProblem(entry.options)).verdict, Existence::CERTIFIED) << entry.name;
}

TEST(ExistenceTest, BadOptionsAreNamed)
{
  ExistenceOptions options;
  options.facets = 2;
  EXPECT_THROW(checkExistence(painleveRod(0.5, 0.3, 1.0, 3), options), std::invalid_argument);
  options = {};
  options.velocity_bound = -1.0;
  EXPECT_THROW(checkExistence(painleveRod(0.5, 0.3, 1.0, 3), options), std::invalid_argument);
}
