#include "frictional_contact_sim/problem/residual.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "frictional_contact_sim/problem/law_functions.h"
#include "support/hand_problems.h"
#include "support/validator.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
const Eigen::Matrix3d W = (Eigen::Matrix3d() << 2.0, 0.3, -0.2, 0.3, 1.5, 0.1, -0.2, 0.1, 1.0).finished();
constexpr double MU = 0.5;

/** A local one-contact problem that (u, r) solves: q = u - W r. */
DelassusProblem oneContact(const Eigen::Vector3d& u, const Eigen::Vector3d& r)
{
  return localProblem(W, u - W * r, {{LawType::COULOMB_3D, MU}});
}

/** A random answer, not a solution, with every law. */
IncrementalProblem everyLaw(std::uint32_t seed)
{
  RandomProblemOptions options;
  options.planar_contacts = 2;
  options.unilateral = 2;
  options.dry = 2;
  options.bilaterals = 2;
  options.moving_externals = true;
  return randomProblem(options, seed);
}

Solution randomAnswer(const IncrementalProblem& problem, unsigned seed)
{
  std::srand(seed);
  Solution solution;
  solution.v = Eigen::VectorXd::Random(problem.velocities());
  solution.r = Eigen::VectorXd::Random(problem.rows());
  solution.lambda = Eigen::VectorXd::Random(problem.bilaterals());
  return solution;
}
}  // namespace

TEST(ResidualTest, IsZeroOnTakeOffStickingAndSlidingInClosedForm)
{
  // Round-off of q = u - W r and back: a few eps.
  EXPECT_LT(evaluateResidual(oneContact({0.4, -1.0, 2.0}, {0, 0, 0}), Eigen::Vector3d(0, 0, 0)), 1e-15);
  EXPECT_LT(evaluateResidual(oneContact({0, 0, 0}, {2.0, 0.6, -0.5}), Eigen::Vector3d(2.0, 0.6, -0.5)), 1e-15);
  EXPECT_LT(evaluateResidual(oneContact({0, 3.0, -4.0}, {2.0, -0.6, 0.8}), Eigen::Vector3d(2.0, -0.6, 0.8)), 1e-15);
}

TEST(ResidualTest, IsNotZeroWhenSlidingFrictionPointsAlongTheMotion)
{
  EXPECT_GT(evaluateResidual(oneContact({0, 3.0, -4.0}, {2.0, 0.6, -0.8}), Eigen::Vector3d(2.0, 0.6, -0.8)), 0.1);
}

TEST(ResidualTest, HasTheValueOfItsDefinitionAtZeroImpulse)
{
  // r = 0, u = q = (-1, 0, 0): e = P_K(-u~) = 1 m/s, scale |q| = 1 m/s.
  const DelassusProblem problem = localProblem(W, Eigen::Vector3d(-1, 0, 0), {{LawType::COULOMB_3D, MU}});
  EXPECT_NEAR(evaluateResidual(problem, Eigen::Vector3d::Zero()), 1.0, 1e-15);
}

TEST(ResidualTest, OneDimensionalLawsVanishExactlyOnTheirGraphs)
{
  const struct
  {
    Law law;
    double u, r;
    bool on_graph;
  } cases[] = {{{LawType::UNILATERAL, 0}, 0.0, 3.0, true},    {{LawType::UNILATERAL, 0}, 2.0, 0.0, true},
               {{LawType::UNILATERAL, 0}, 2.0, 3.0, false},   {{LawType::UNILATERAL, 0}, -1.0, 0.0, false},
               {{LawType::DRY_FRICTION, 1}, 0.0, 0.7, true},  {{LawType::DRY_FRICTION, 1}, 2.0, -1.0, true},
               {{LawType::DRY_FRICTION, 1}, 2.0, 1.0, false}, {{LawType::DRY_FRICTION, 1}, -2.0, 1.0, true},
               {{LawType::BILATERAL, 0}, 0.0, -5.0, true},    {{LawType::BILATERAL, 0}, 0.1, -5.0, false}};
  for (const auto& item : cases)
  {
    const double error = naturalMapError(item.law, &item.u, &item.r, 0.37);
    if (item.on_graph)
      EXPECT_LT(error, 1e-15);
    else
      EXPECT_GT(error, 0.05);
  }
}

TEST(ResidualTest, DoesNotDependOnTheUnits)
{
  // Length in mm (1e3), mass in g (1e3), time in ms (1e3): velocity x 1, impulse x 1e6 / ... any factors must cancel.
  const IncrementalProblem problem = randomProblem({}, 3);
  const Solution answer = randomAnswer(problem, 3);
  const double velocity = 7.3, mass = 1.9e3;
  IncrementalProblem scaled = problem;
  scaled.M = problem.M * mass;
  scaled.f = problem.f * (mass * velocity);
  scaled.w = problem.w * velocity;
  Solution other = answer;
  other.v *= velocity;
  other.r *= mass * velocity;
  const GlobalResidual a = evaluateResidual(problem, answer), b = evaluateResidual(scaled, other);
  EXPECT_NEAR(a.law, b.law, 1e-13 * a.law);
  EXPECT_NEAR(a.dynamics, b.dynamics, 1e-13 * a.dynamics);
}

TEST(ResidualTest, DoesNotDependOnTheOrderOfContacts)
{
  std::srand(5);
  const int contacts = 5;
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(3 * contacts, 3 * contacts);
  const Eigen::MatrixXd delassus = A * A.transpose();
  const Eigen::VectorXd q = Eigen::VectorXd::Random(3 * contacts), r = Eigen::VectorXd::Random(3 * contacts);
  const std::vector<int> order = {3, 0, 4, 1, 2};
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(3 * contacts, 3 * contacts);
  std::vector<Law> laws, permuted;
  for (int i = 0; i < contacts; ++i)
    laws.push_back({LawType::COULOMB_3D, 0.2 * (i + 1)});
  for (int i = 0; i < contacts; ++i)
  {
    P.block<3, 3>(3 * i, 3 * order[static_cast<size_t>(i)]).setIdentity();
    permuted.push_back(laws[static_cast<size_t>(order[static_cast<size_t>(i)])]);
  }
  const double a = evaluateResidual(localProblem(delassus, q, laws), r);
  const double b = evaluateResidual(localProblem(P * delassus * P.transpose(), P * q, permuted), P * r);
  EXPECT_NEAR(a, b, 1e-13 * a);
}

TEST(ResidualTest, AgreesWithTheIndependentValidatorOnAnswersThatAreNotSolutions)
{
  for (std::uint32_t seed = 1; seed <= 20; ++seed)
  {
    const IncrementalProblem problem = everyLaw(seed);
    const Solution answer = randomAnswer(problem, seed);
    const GlobalResidual ours = evaluateResidual(problem, answer);
    const Verdict theirs = validateAnswer(problem, answer.v, answer.r, answer.lambda);
    // Two ways to the same numbers; M has a condition below 1e3.
    EXPECT_NEAR(ours.law, theirs.law, 1e-11 * theirs.law);
    EXPECT_NEAR(ours.dynamics, theirs.dynamics, 1e-11 * theirs.dynamics);
    EXPECT_NEAR(ours.bilateral, theirs.bilateral, 1e-11 * theirs.bilateral);
  }
}

TEST(ResidualTest, IsZeroWithoutRowsAndNotANumberIsNeverSmall)
{
  EXPECT_EQ(evaluateResidual(localProblem(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0), {}), Eigen::VectorXd(0)), 0.0);
  const DelassusProblem problem = oneContact({0, 0, 0}, {2.0, 0.6, -0.5});
  const Eigen::Vector3d broken(2.0, std::numeric_limits<double>::quiet_NaN(), 0.0);
  EXPECT_FALSE(evaluateResidual(problem, broken) <= 1e30);
  // In the first of two laws too, where the finite error of the second follows.
  Eigen::VectorXd u(2), r(2);
  u << std::numeric_limits<double>::quiet_NaN(), 1.0;
  r << 1.0, 1.0;
  const std::vector<Law> laws(2, Law{LawType::UNILATERAL, 0.0});
  ResidualMetric metric;
  metric.step_lengths = metric.scales = Eigen::Vector2d(1.0, 1.0);
  metric.round_off = Eigen::Vector2d(0.0, 0.0);
  EXPECT_FALSE(lawResidual(laws, metric, u, r) <= 1e30);
  GlobalResidual broken_first;
  broken_first.law = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(broken_first.value() <= 1e30);
}

TEST(ResidualTest, LargestEigenvaluesAgreeWithTheirCharacteristicEquation)
{
  std::srand(11);
  for (int k = 0; k < 200; ++k)
  {
    const Eigen::Matrix3d A = Eigen::Matrix3d::Random();
    const Eigen::Matrix3d S = A * A.transpose();
    const double lambda = largestEigenvalue(SquareMatrix<3>(S));
    // lambda I - S is singular and positive semi-definite: its leading minors are not negative.
    const Eigen::Matrix3d shifted = lambda * Eigen::Matrix3d::Identity() - S;
    const double determinant = shifted(0, 0) * (shifted(1, 1) * shifted(2, 2) - shifted(1, 2) * shifted(2, 1)) -
                               shifted(0, 1) * (shifted(1, 0) * shifted(2, 2) - shifted(1, 2) * shifted(2, 0)) +
                               shifted(0, 2) * (shifted(1, 0) * shifted(2, 1) - shifted(1, 1) * shifted(2, 0));
    EXPECT_NEAR(determinant, 0.0, 1e-13 * std::pow(1.0 + lambda, 3));
    EXPECT_GE(shifted(0, 0), -1e-13);
    EXPECT_GE(shifted(0, 0) * shifted(1, 1) - shifted(0, 1) * shifted(1, 0), -1e-13);
  }
}

namespace
{
/** A mass of 1 kg on a line: between two walls, or pushed on one. */
DelassusProblem betweenWalls(double q)
{
  Eigen::Matrix2d W;
  W << 1.0, -1.0, -1.0, 1.0;
  return localProblem(W, Eigen::Vector2d(q, -q), {{LawType::UNILATERAL, 0.0}, {LawType::UNILATERAL, 0.0}});
}
}  // namespace

TEST(ResidualTest, SelfStressBuysNothing)
{
  // One wall has to stop 1 m/s, r = (1, 0); half of it is missing, u = (-0.5, 0.5). The walls' own stress moves
  // nothing: e_2 = min(u_2, r_2) is 0.5 m/s as soon as there is some, e_1 is -0.5 m/s always.
  const DelassusProblem problem = betweenWalls(-1.0);
  for (const double stress : {0.0, 1.0, 1e4, 1e8})
    EXPECT_NEAR(evaluateResidual(problem, Eigen::Vector2d(0.5 + stress, stress)), 0.5, 1e-7) << stress;
}

TEST(ResidualTest, IsNeverReportedBelowTheRoundOffOfTheImpulses)
{
  // u = 0 in doubles, whatever it is: r - P(r - u) vanishes. 1e8 m/s of stress against 1 m/s that matters.
  const DelassusProblem problem = betweenWalls(-1.0);
  const double eps = std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(evaluateResidual(problem, Eigen::Vector2d(1.0 + 1e8, 1e8)), eps * 1e8, 1e-3 * eps * 1e8);
  EXPECT_GT(evaluateResidual(problem, Eigen::Vector2d(1.0 + 1e9, 1e9)), 1e-8);
}

TEST(ResidualTest, IdleRowsDoNotCount)
{
  // A limit 0.01 rad away has q = 10 rad/s; the other row closes with 1e-3 rad/s and misses by half of that.
  Eigen::Matrix2d W;
  W << 1.0, 0.5, 0.5, 1.0;
  const std::vector<Law> laws(2, Law{LawType::UNILATERAL, 0.0});
  EXPECT_NEAR(evaluateResidual(localProblem(W, Eigen::Vector2d(10.0, -1e-3), laws), Eigen::Vector2d(0.0, 0.5e-3)), 0.5,
              1e-12);
}

TEST(ResidualTest, RowsOfUnlikeUnitsHaveTheirOwnScales)
{
  // A slide of 10 m/s that misses its law by 0.1 m/s and a hinge of 1e-3 rad/s that misses by 8e-3 rad/s.
  Eigen::Matrix2d W;
  W << 1.0, 0.1, 0.1, 1.0;
  DelassusProblem problem =
      localProblem(W, Eigen::Vector2d(-10.0, 1e-3), {{LawType::DRY_FRICTION, 10.0}, {LawType::DRY_FRICTION, 1.0}});
  const Eigen::Vector2d r(9.9, -0.999);  // u = (-0.1999, -8e-3), e = (-0.1, -8e-3)
  const double mixed = evaluateResidual(problem, r);
  problem.scales = {{VelocityUnit::LENGTH, 1.0, 0.0, 0.0}, {VelocityUnit::ANGLE, 0.5, 0.0, 0.0}};
  EXPECT_GT(evaluateResidual(problem, r), 10.0 * mixed);
  // From the bodies' change of speed, 0.2 m/s, at 0.5 m: 0.4 rad/s.
  problem.scales[0].speed_change = 0.2;
  ResidualMetric metric = makeMetric(problem);
  EXPECT_EQ(metric.scales[0], 10.0);
  EXPECT_EQ(metric.scales[1], 0.4);
}

TEST(ResidualTest, AnIslandsScaleIsItsOwn)
{
  // With the speeds of a simulation, what another island does is nothing to it; bare, 1e-6 of the whole's q is.
  Eigen::Matrix2d W = Eigen::Matrix2d::Identity();
  DelassusProblem problem =
      localProblem(W, Eigen::Vector2d(-1e3, -1e-9), std::vector<Law>(2, Law{LawType::UNILATERAL, 0.0}));
  EXPECT_EQ(makeMetric(problem).scales, Eigen::Vector2d(1e3, 1e-3));
  problem.scales.assign(2, {VelocityUnit::LENGTH, 1.0, 1e-2, 0.0});
  EXPECT_EQ(makeMetric(problem).scales, Eigen::Vector2d(1e3, 1e-2));
}

TEST(ResidualTest, WhatIsLostInTheSpeedsOfTheBodiesIsZero)
{
  // Free fall at 100 m/s: a joint at its limit closes with 1e-15 rad/s, a few eps of what its velocity was taken from.
  DelassusProblem problem =
      localProblem(Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, -1e-15), {{LawType::UNILATERAL, 0.0}});
  EXPECT_EQ(evaluateResidual(problem, Eigen::VectorXd::Zero(1)), 1e-15 / VELOCITY_FLOOR);
  problem.scales = {{VelocityUnit::ANGLE, 0.5, 1e-2, 100.0}};
  EXPECT_EQ(evaluateResidual(problem, Eigen::VectorXd::Zero(1)), 0.0);
}

TEST(ResidualTest, AgreesWithTheIndependentValidatorOnScaledProblems)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(0.01, 1.0);
  for (std::uint32_t seed = 1; seed <= 20; ++seed)
  {
    IncrementalProblem problem = everyLaw(seed);
    for (size_t i = 0; i < problem.laws.size(); ++i)
      problem.scales.push_back({problem.laws[i].isCoulomb() ? VelocityUnit::LENGTH : static_cast<VelocityUnit>(i % 3),
                                number(random), number(random), number(random)});
    for (int k = 0; k < problem.bilaterals(); ++k)
      problem.bilateral_scales.push_back({VelocityUnit::ANGLE, number(random), 100.0 * number(random), number(random)});
    const Solution answer = randomAnswer(problem, seed);
    const GlobalResidual ours = evaluateResidual(problem, answer);
    const Verdict theirs = validateAnswer(problem, answer.v, answer.r, answer.lambda);
    EXPECT_NEAR(ours.law, theirs.law, 1e-11 * theirs.law);
    EXPECT_NEAR(ours.bilateral, theirs.bilateral, 1e-11 * theirs.bilateral);
  }
}
