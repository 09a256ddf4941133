#include "frictional_contact_sim/solver/fb_bfgs.h"

#include "frictional_contact_sim/solver/fb_system.h"
#include "method_test_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/// The gradient of 1/2 |Phi|^2 by differences of the textbook function.
Eigen::VectorXd textbookGradient(const VectorFunction& phi, const Eigen::VectorXd& z)
{
  return numericalJacobian([&](const Eigen::VectorXd& y) -> Eigen::VectorXd
                           { return Eigen::VectorXd::Constant(1, 0.5 * phi(y).squaredNorm()); },
                           z)
      .transpose();
}
}  // namespace

TEST(FbBfgsTest, GradientAgreesWithDifferences)
{
  const DelassusProblem problem = twoCoupledContacts();
  const VectorFunction phi = textbookSystem(problem, 0.0);
  FbSystem system;
  system.set(problem, Eigen::Vector2d(0.5, 0.5));
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  Eigen::VectorXd z(6), c(6), g(6);
  for (int draw = 0; draw < 50; ++draw)
  {
    for (int k = 0; k < 6; ++k)
      z[k] = normal(engine);
    system.velocity(z, c);
    // The textbook value has lost a few digits by its differences of squares.
    EXPECT_NEAR(system.evaluate(c, z, 0.0, true), 0.5 * phi(z).squaredNorm(), 1e-12);
    system.gradient(g);
    EXPECT_LT((g - textbookGradient(phi, z)).norm(), 1e-6) << draw;
  }
}

TEST(FbBfgsTest, FirstIterateIsASteepestDescentStepThatMeetsWolfesConditions)
{
  const DelassusProblem problem = twoCoupledContacts();
  const VectorFunction phi = textbookSystem(problem, 0.0);
  FbBfgs solver;
  solver.setStopping(stopAfter(1, 1e-14));
  Solution guess;
  guess.r.setZero(6);
  guess.r[0] = guess.r[3] = 3.0;  // far too much: every descent lowers the residual, the better iterate is kept
  const Eigen::VectorXd start = std::sqrt(2.0) * guess.r;
  const Eigen::VectorXd z = std::sqrt(2.0) * solver.solve(problem, &guess).solution.r;
  const Eigen::VectorXd g = textbookGradient(phi, start);
  const Eigen::VectorXd move = z - start;
  // The differences leave an angle of 1e-8, whose cosine is exact.
  EXPECT_NEAR(move.normalized().dot(-g.normalized()), 1.0, 1e-10);
  const FbBfgsOptions options;
  const double slope = g.dot(move);
  EXPECT_LE(0.5 * phi(z).squaredNorm(), 0.5 * phi(start).squaredNorm() + options.sufficient_decrease * slope);
  EXPECT_LE(std::abs(textbookGradient(phi, z).dot(move)), options.curvature * std::abs(slope));
}

TEST(FbBfgsTest, AgreesWithGaussSeidel)
{
  expectAgreementWithGaussSeidel("fb_bfgs", 50000);
}

TEST(FbBfgsTest, SaysWhenThereIsNoSolution)
{
  expectHonestWithoutSolution("fb_bfgs");
}

TEST(FbBfgsTest, RefusesSenselessOptions)
{
  FbBfgsOptions options;
  options.curvature = 1e-5;
  EXPECT_THROW(FbBfgs{options}, std::invalid_argument);
}
