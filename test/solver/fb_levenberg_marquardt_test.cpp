#include "frictional_contact_sim/solver/fb_levenberg_marquardt.h"

#include "method_test_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

TEST(FbLevenbergMarquardtTest, FirstIterateIsTheDampedGaussNewtonStep)
{
  const DelassusProblem problem = twoCoupledContacts();
  const VectorFunction phi = textbookSystem(problem, 0.0);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  const Eigen::MatrixXd J = numericalJacobian(phi, zero);
  FbLevenbergMarquardtOptions options;
  // lambda = damping |Phi| / |q| in scaled variables; large enough to tell the step from Newton's.
  const double lambda = options.first_damping * phi(zero).norm() / (problem.q.norm() / std::sqrt(2.0));
  const Eigen::MatrixXd normal = J.transpose() * J + lambda * Eigen::MatrixXd::Identity(6, 6);
  const Eigen::VectorXd step = -normal.partialPivLu().solve(J.transpose() * phi(zero)) / std::sqrt(2.0);
  FbLevenbergMarquardt solver(options);
  solver.setStopping(stopAfter(1, 1e-14));
  const SolverResult result = solver.solve(problem);
  // Differences of order 1e-10 times the squared condition of J, below 1e3.
  EXPECT_LT((result.solution.r - step).norm(), 1e-6 * step.norm());
}

TEST(FbLevenbergMarquardtTest, SurvivesTheStartOfExampleD2)
{
  expectConvergenceFromExampleD2("fb_levenberg_marquardt", 500);
}

TEST(FbLevenbergMarquardtTest, AgreesWithGaussSeidel)
{
  expectAgreementWithGaussSeidel("fb_levenberg_marquardt", 1000);
}

TEST(FbLevenbergMarquardtTest, SaysWhenThereIsNoSolution)
{
  expectHonestWithoutSolution("fb_levenberg_marquardt");
}
