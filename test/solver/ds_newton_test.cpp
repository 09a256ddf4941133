#include "frictional_contact_sim/solver/ds_newton.h"

#include "method_test_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

TEST(DsNewtonTest, EqualStepLengthsGiveTheProjectionOfTheThesis)
{
  const Eigen::Vector3d u(0.4, -1.0, 0.5), r(1.0, 0.6, -0.2);
  const double mu = 0.7, rho = 0.3;
  const Eigen::Vector3d shifted(u[0] + mu * std::hypot(u[1], u[2]), u[1], u[2]);
  const Eigen::Vector3d expected = projectOntoCone<3>(r - rho * shifted, mu) - r;
  // Round-off of two square roots and a division.
  EXPECT_LT((deSaxceMap().spatial(u, r, mu, rho, rho).value - expected).norm(), 1e-14);
}

TEST(DsNewtonTest, ZerosDoNotDependOnTheStepLengths)
{
  const double mu = 0.5;
  // Sliding: u_N = 0, r on the boundary against u_T; sticking; taking off.
  const Eigen::Vector3d cases[3][2] = {
      {{0, 3, 4}, {2, -0.6, -0.8}}, {{0, 0, 0}, {2, 0.3, -0.4}}, {{1, 3, 4}, {0, 0, 0}}};
  for (const auto& pair : cases)
    for (const double rho_normal : {0.01, 1.0, 30.0})
      for (const double rho_tangential : {0.01, 1.0, 30.0})
        EXPECT_LT(deSaxceMap().spatial(pair[0], pair[1], mu, rho_normal, rho_tangential).value.norm(), 1e-13);
}

TEST(DsNewtonTest, JacobiansAgreeWithDifferences)
{
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < 200; ++draw)
  {
    Eigen::VectorXd x(6);
    for (int k = 0; k < 6; ++k)
      x[k] = normal(engine);
    const double mu = 0.1 + 0.01 * draw;
    const auto function = [&](const Eigen::VectorXd& y) -> Eigen::VectorXd
    { return deSaxceMap().spatial(y.head<3>(), y.tail<3>(), mu, 0.7, 1.9).value; };
    const ContactFunction<3> f = deSaxceMap().spatial(x.head<3>(), x.tail<3>(), mu, 0.7, 1.9);
    const Eigen::MatrixXd numerical = numericalJacobian(function, x);
    // Second differences of a curvature up to 1/|u_T|, which these draws keep above 0.01.
    EXPECT_LT((numerical.leftCols<3>() - f.by_u).norm(), 1e-5) << draw;
    EXPECT_LT((numerical.rightCols<3>() - f.by_r).norm(), 1e-5) << draw;
  }
}

TEST(DsNewtonTest, FirstIterateIsNewtonOnTheProjectionFunction)
{
  const DelassusProblem problem = twoCoupledContacts();
  DsNewton solver;
  expectFirstIterateIsNewton(solver, problem,
                             [&](const Eigen::VectorXd& r) -> Eigen::VectorXd
                             {
                               const Eigen::VectorXd u = problem.W.toDense() * r + problem.q;
                               Eigen::VectorXd f(6);
                               for (int i = 0; i < 2; ++i)
                               {
                                 const double mu = problem.laws[static_cast<size_t>(i)].coefficient;
                                 Eigen::Vector3d shifted = u.segment<3>(3 * i);
                                 shifted[0] += mu * shifted.tail<2>().norm();
                                 const Eigen::Vector3d impulse = r.segment<3>(3 * i);
                                 f.segment<3>(3 * i) = projectOntoCone<3>(impulse - 0.5 * shifted, mu) - impulse;
                               }
                               return f;
                             });
}

TEST(DsNewtonTest, ExampleD2StartsWhereAlartCurnierHasASingularJacobian)
{
  const IncrementalProblem problem = squareOnTwoContacts();
  const Eigen::MatrixXd H = problem.H;
  const Eigen::Vector4d r(6, 1, 8, 9);
  const Eigen::Vector4d u = H * (H.transpose() * r - problem.f);
  Eigen::Matrix4d by_u = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 2; ++i)
  {
    const ContactFunction<2> f =
        alartCurnierJacobian<2>(u.segment<2>(2 * i), r.segment<2>(2 * i), 1.0, 0.1, 0.1, RadiusRule::IMPULSE);
    EXPECT_EQ(f.by_r, Eigen::Matrix2d::Zero()) << "contact " << i;
    by_u.block<2, 2>(2 * i, 2 * i) = f.by_u;
  }
  const Eigen::Matrix4d jacobian = by_u * H * H.transpose();
  EXPECT_EQ(jacobian.fullPivLu().rank(), 3);
  expectConvergenceFromExampleD2("ds_newton", 200);
}

TEST(DsNewtonTest, AgreesWithGaussSeidel)
{
  expectAgreementWithGaussSeidel("ds_newton", 500);
}

TEST(DsNewtonTest, SaysWhenThereIsNoSolution)
{
  expectHonestWithoutSolution("ds_newton");
}
