#include "frictional_contact_sim/solver/fb_newton.h"

#include "frictional_contact_sim/solver/fb_newton_smoothed.h"
#include "method_test_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

TEST(FbNewtonTest, FirstIterateIsNewtonOnFischerBurmeister)
{
  const DelassusProblem problem = twoCoupledContacts();
  const VectorFunction phi = textbookSystem(problem, 0.0);
  FbNewton solver;
  expectFirstIterateIsNewton(solver, problem,
                             [&](const Eigen::VectorXd& r) -> Eigen::VectorXd { return phi(std::sqrt(2.0) * r); });
}

TEST(FbNewtonTest, JacobiansAgreeWithDifferences)
{
  std::mt19937 engine(4);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < 200; ++draw)
  {
    Eigen::VectorXd x(6);
    for (int k = 0; k < 6; ++k)
      x[k] = normal(engine);
    const double mu = draw % 10 == 0 ? 0.0 : 0.1 + 0.01 * draw;
    const auto function = [&](const Eigen::VectorXd& y) -> Eigen::VectorXd
    { return fischerBurmeisterMap().spatial(y.head<3>(), y.tail<3>(), mu, 0.7, 1.9).value; };
    const ContactFunction<3> f = fischerBurmeisterMap().spatial(x.head<3>(), x.tail<3>(), mu, 0.7, 1.9);
    const Eigen::MatrixXd numerical = numericalJacobian(function, x);
    // Curvature grows like the inverse of the smallest eigenvalue; in these draws below 1e3.
    EXPECT_LT((numerical.leftCols<3>() - f.by_u).norm(), 1e-5) << draw;
    EXPECT_LT((numerical.rightCols<3>() - f.by_r).norm(), 1e-5) << draw;
  }
}

TEST(FbNewtonTest, SurvivesTheStartOfExampleD2)
{
  expectConvergenceFromExampleD2("fb_newton", 200);
}

TEST(FbNewtonTest, AgreesWithGaussSeidel)
{
  expectAgreementWithGaussSeidel("fb_newton", 500);
}

TEST(FbNewtonTest, SaysWhenThereIsNoSolution)
{
  expectHonestWithoutSolution("fb_newton");
}

TEST(FbNewtonSmoothedTest, FirstIterateIsNewtonOnTheSmoothedFunction)
{
  const DelassusProblem problem = twoCoupledContacts();
  FbNewtonSmoothedOptions options;
  options.first_smoothing = 0.5;
  // Scaled free velocity q / 2^(1/2), its largest entry 2 / 2^(1/2).
  const VectorFunction phi = textbookSystem(problem, 0.5 * std::sqrt(2.0));
  FbNewtonSmoothed solver(options);
  expectFirstIterateIsNewton(solver, problem,
                             [&](const Eigen::VectorXd& r) -> Eigen::VectorXd { return phi(std::sqrt(2.0) * r); });
}

TEST(FbNewtonSmoothedTest, SurvivesTheStartOfExampleD2)
{
  expectConvergenceFromExampleD2("fb_newton_smoothed", 200);
}

TEST(FbNewtonSmoothedTest, AgreesWithGaussSeidel)
{
  expectAgreementWithGaussSeidel("fb_newton_smoothed", 500);
}

TEST(FbNewtonSmoothedTest, SaysWhenThereIsNoSolution)
{
  expectHonestWithoutSolution("fb_newton_smoothed");
}

TEST(FbNewtonSmoothedTest, RefusesSenselessOptions)
{
  FbNewtonSmoothedOptions options;
  options.smoothing_decrease = 1.0;
  EXPECT_THROW(FbNewtonSmoothed{options}, std::invalid_argument);
}
