#include "frictional_contact_sim/solver/bipotential.h"

#include "method_test_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/// r . u~(r) of (4.12).
double bipotentialValue(const DelassusProblem& problem, const Eigen::VectorXd& r)
{
  const Eigen::VectorXd u = problem.W.toDense() * r + problem.q;
  double value = u.dot(r);
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    const auto row = static_cast<Eigen::Index>(3 * i);
    value += problem.laws[i].coefficient * r[row] * u.segment<2>(row + 1).norm();
  }
  return value;
}
}  // namespace

TEST(BipotentialTest, FirstIterateOfOneContact)
{
  // W = I, q = (-1, -2, 0), mu = 1/2, sigma = 3, from r = 0: w = q, alpha = -q/3, beta = 0, a = 0, s = 2.
  // z = (2 I + 3 I + 3 I)^-1 (-q + 3 (0 - alpha) + 3 (q - 0 - q)) = (-q + q) / 8 = 0
  // x = P_K(0 + (1, 2, 0)/3 - (1/2 2 / 3) e_N) = P_K(0, 2/3, 0) with t = (1/2 2/3) / (1 + 1/4) = 4/15: (4/15, 2/15, 0).
  const DelassusProblem problem =
      localProblem(Eigen::Matrix3d::Identity(), Eigen::Vector3d(-1, -2, 0), {{LawType::COULOMB_3D, 0.5}});
  BipotentialOptions options;
  options.relaxation = 1.0;
  Bipotential solver(options);
  solver.setStopping(stopAfter(1, 1e-14));
  const SolverResult result = solver.solve(problem);
  EXPECT_LT((result.solution.r - Eigen::Vector3d(4.0 / 15, 2.0 / 15, 0)).norm(), 1e-14);
}

TEST(BipotentialTest, ReachesTheMinimumZeroInsideTheConstraints)
{
  const DelassusProblem problem = twoCoupledContacts();
  Bipotential solver;
  solver.setStopping(stopAfter(5000, 1e-10));
  const SolverResult result = solver.solve(problem);
  ASSERT_EQ(result.status, SolverStatus::CONVERGED) << result.message;
  // Residual 1e-10 on numbers of order one: the value is an error of first order in it.
  EXPECT_NEAR(bipotentialValue(problem, result.solution.r), 0.0, 1e-9);
  for (int i = 0; i < 2; ++i)
    EXPECT_GE(result.solution.u[3 * i], -1e-9);
}

TEST(BipotentialTest, AgreesWithGaussSeidel)
{
  expectAgreementWithGaussSeidel("bipotential", 50000);
}

TEST(BipotentialTest, SaysWhenThereIsNoSolutionOrTooManyRows)
{
  expectHonestWithoutSolution("bipotential");
  BipotentialOptions options;
  options.max_rows = 5;
  Bipotential solver(options);
  const SolverResult result = solver.solve(twoCoupledContacts());
  EXPECT_EQ(result.status, SolverStatus::NUMERICAL_FAILURE);
  EXPECT_FALSE(result.message.empty());
}
