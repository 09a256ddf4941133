#include "frictional_contact_sim/solver/ac_fixed_point.h"
#include "frictional_contact_sim/solver/ds_fixed_point.h"
#include "method_test_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/// One contact, W = diag(4, 2, 2), mu = 1/2, with impulse r = (1, 0.1, 0) as the start.
DelassusProblem oneContact()
{
  const Eigen::Vector3d diagonal(4, 2, 2);
  return localProblem(diagonal.asDiagonal(), Eigen::Vector3d(-5, 1.8, 2), {{LawType::COULOMB_3D, 0.5}});
}

Eigen::Vector3d firstIterate(FixedPoint& solver, const Eigen::Vector3d& start)
{
  Solution guess;
  guess.r = start;
  solver.setStopping(stopAfter(1, 1e-14));
  return solver.solve(oneContact(), &guess).solution.r;
}

FixedPointOptions fixedStep(double step)
{
  FixedPointOptions options;
  options.adapt = false;
  options.first_step = step;
  return options;
}
}  // namespace

TEST(DsFixedPointTest, FirstIterateIsDeSaxceAndFengs)
{
  // u = (-1, 2, 2), u~ = (-1 + sqrt 2, 2, 2), rho = 1/4 and theta = 1/2: r - u~/8 is outside the cone.
  const Eigen::Vector3d start(1, 0.1, 0);
  DsFixedPoint solver(fixedStep(0.5));
  const double shift = 0.5 * std::sqrt(8.0);
  const Eigen::Vector3d expected = projectOntoCone<3>(start - 0.125 * Eigen::Vector3d(-1.0 + shift, 2, 2), 0.5);
  // Round-off of the scaling by a square root.
  EXPECT_LT((firstIterate(solver, start) - expected).norm(), 1e-14);
}

TEST(AcFixedPointTest, FirstIterateIsAlartAndCurniers)
{
  // u = (-1, 2, 2); rho_N = 1/4, rho_T = 1/2, theta = 1/4: r_N <- 1 + 1/16, r_T <- projection of (0.1, 0) - (2, 2)/8 =
  // (-0.15, -0.25) on the disc of radius mu r_N(old) = 1/2: inside.
  AcFixedPoint solver(fixedStep(0.25));
  EXPECT_LT((firstIterate(solver, {1, 0.1, 0}) - Eigen::Vector3d(1.0625, -0.15, -0.25)).norm(), 1e-14);
}

TEST(AcFixedPointTest, TheRadiusFollowsTheOldImpulse)
{
  // theta = 2: r_N <- 3/2, r_T <- projection of (0.1 - 2, -2) on the disc of radius 1/2, not 3/4.
  AcFixedPoint solver(fixedStep(2.0));
  const Eigen::Vector2d direction = Eigen::Vector2d(-1.9, -2.0).normalized();
  const Eigen::Vector3d result = firstIterate(solver, {1, 0.1, 0});
  EXPECT_LT((result.tail<2>() - 0.5 * direction).norm(), 1e-14);
  EXPECT_NEAR(result[0], 1.5, 1e-14);
}

TEST(FixedPointTest, TheStepLengthAdaptsWhereAFixedOneDiverges)
{
  // Two rows that share one degree of freedom almost: the largest eigenvalue of the scaled W is almost 2, that of eight
  // rows almost 8; theta = 1 for each alone is too long together.
  const Eigen::MatrixXd W = Eigen::MatrixXd::Constant(8, 8, 1.0) + 0.05 * Eigen::MatrixXd::Identity(8, 8);
  Eigen::VectorXd q = Eigen::VectorXd::Constant(8, -1.0);
  q[3] = -1.02;
  const DelassusProblem problem = localProblem(W, q, std::vector<Law>(8, Law{LawType::UNILATERAL, 0.0}));
  DsFixedPoint plain(fixedStep(1.0)), adaptive;
  plain.setStopping(stopAfter(2000));
  adaptive.setStopping(stopAfter(2000));
  EXPECT_NE(plain.solve(problem).status, SolverStatus::CONVERGED);
  EXPECT_EQ(adaptive.solve(problem).status, SolverStatus::CONVERGED);
}

TEST(FixedPointTest, AgreesWithGaussSeidel)
{
  expectAgreementWithGaussSeidel("ds_fixed_point", 50000);
  expectAgreementWithGaussSeidel("ac_fixed_point", 50000);
}

TEST(FixedPointTest, SaysWhenThereIsNoSolution)
{
  expectHonestWithoutSolution("ds_fixed_point");
  expectHonestWithoutSolution("ac_fixed_point");
}

TEST(FixedPointTest, RefusesSenselessOptions)
{
  FixedPointOptions options;
  options.smallest_ratio = 1.5;
  EXPECT_THROW(DsFixedPoint{options}, std::invalid_argument);
}
