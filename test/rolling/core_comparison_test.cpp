/**
 * @file core_comparison_test.cpp
 * @brief The same contact given to the core's solvers as a local problem with planar Coulomb laws: the same tractions.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/rolling/core_comparison.h"

using namespace frictional_contact_sim;

namespace
{
class CoreSolverTest : public testing::TestWithParam<const char*>
{
};
}  // namespace

TEST_P(CoreSolverTest, FindsTheTractionsOfTheNonsymmetricLcp)
{
  const int n = 30;
  const PlaneStrainMaterial rubber{94500.0, 0.1};
  const Eigen::VectorXd friction = Eigen::VectorXd::Constant(1, 0.3);
  Eigen::VectorXd x, w;
  makeUniformNodes(0.06, n, x, w);
  for (bool rigid : {false, true})
    for (double shift : {1e-4, 4e-4})
    {
      const ContactFlexibility F = halfPlaneFlexibility(MaterialPair{rubber, rubber, rigid}, x, w, 2.0);
      const Eigen::VectorXd d_N = x.array().square() / 2.0 - 2e-3, d_T = Eigen::VectorXd::Constant(n, shift);
      const FrictionalContact contact = FrictionalLcp(F, friction).solve(d_N, d_T);
      ASSERT_EQ(contact.status, LcpStatus::SOLVED);
      const CoreComparison comparison =
          compareWithCore(poseForTheCore(F, friction, d_N, d_T), contact, GetParam(), 1e-12);
      EXPECT_EQ(comparison.status, "CONVERGED");
      // A residual of 1e-12 times the condition of W (about 1e2 here) stays far below.
      EXPECT_LT(comparison.difference, 1e-8) << rigid << shift;
    }
}

INSTANTIATE_TEST_SUITE_P(Registry, CoreSolverTest,
                         testing::Values("lcp_lemke", "ac_newton", "interior_point", "gauss_seidel"),
                         [](const testing::TestParamInfo<const char*>& param) { return std::string(param.param); });

TEST(CoreProblemTest, MisuseIsNamed)
{
  Eigen::VectorXd x, w;
  makeUniformNodes(0.06, 3, x, w);
  const ContactFlexibility F = halfPlaneFlexibility(PlaneStrainMaterial{}, x, w, 2.0);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3), mu = Eigen::VectorXd::Constant(1, 0.3);
  EXPECT_THROW(poseForTheCore(F, mu, zero, zero), std::invalid_argument);
  EXPECT_THROW(poseForTheCore(F, mu, Eigen::VectorXd::Zero(2), zero), std::invalid_argument);
  EXPECT_THROW(poseForTheCore(F, Eigen::VectorXd::Zero(2), zero, zero), std::invalid_argument);
}
