/**
 * @file core_solvers_test.cpp
 * @brief The same contact posed as a local problem of the core (W = F, q = rigid displacements, displacement in the
 * part of velocity, traction in that of impulse) and given to the core's solvers: the same tractions.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/rolling/closed_forms.h"
#include "frictional_contact_sim/rolling/frictional_lcp.h"
#include "frictional_contact_sim/solver/registry.h"

using namespace frictional_contact_sim;

namespace
{
/// Nodes interleaved (N, T); units in which displacements and flexibilities are of order one.
DelassusProblem poseAsContacts(const ContactFlexibility& F, double friction, const Eigen::VectorXd& d_N,
                               const Eigen::VectorXd& d_T, double unit, double depth)
{
  const Eigen::Index n = F.size();
  DelassusProblem problem;
  problem.laws.assign(static_cast<std::size_t>(n), Law{LawType::COULOMB_2D, friction});
  Eigen::MatrixXd W(2 * n, 2 * n);
  problem.q.resize(2 * n);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    problem.q.segment<2>(2 * i) << d_N[i] / depth, d_T[i] / depth;
    for (Eigen::Index j = 0; j < n; ++j)
      W.block<2, 2>(2 * i, 2 * j) << F.NN(i, j), F.NT(i, j), F.TN(i, j), F.TT(i, j);
  }
  problem.W.assign(Eigen::MatrixXd(W / unit), problem.laws);
  return problem;
}

class CoreSolverTest : public testing::TestWithParam<const char*>
{
};
}  // namespace

TEST_P(CoreSolverTest, FindsTheTractionsOfTheNonsymmetricLcp)
{
  const int n = 30;
  const ElasticMaterial rubber{94500.0, 0.1};
  Eigen::VectorXd x, w;
  makeUniformNodes(0.06, n, x, w);
  for (bool rigid : {false, true})
    for (double shift : {1e-4, 4e-4})
    {
      const ContactFlexibility F = halfPlaneFlexibility(MaterialPair{rubber, rubber, rigid}, x, w, 2.0);
      const double depth = 2e-3, friction = 0.3;
      const Eigen::VectorXd d_N = x.array().square() / 2.0 - depth, d_T = Eigen::VectorXd::Constant(n, shift);
      const FrictionalContact lcp = FrictionalLcp(F, Eigen::VectorXd::Constant(1, friction)).solve(d_N, d_T);
      ASSERT_EQ(lcp.status, LcpStatus::SOLVED);
      const double unit = F.NN.cwiseAbs().rowwise().sum().maxCoeff();
      const DelassusProblem problem = poseAsContacts(F, friction, d_N, d_T, unit, depth);
      const std::unique_ptr<Solver> solver = createSolver(GetParam());
      StoppingOptions stopping;
      stopping.tolerance = 1e-12;
      stopping.max_iterations = 100000;
      solver->setStopping(stopping);
      const SolverResult result = solver->solve(problem);
      EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message << " " << result.residual;
      const double peak = lcp.r_N.maxCoeff() * unit / depth;
      // E = 1e-12 times the condition of W (about 1e2 here) stays far below the 1e-8 asked for.
      for (Eigen::Index i = 0; i < n; ++i)
      {
        EXPECT_NEAR(result.solution.r[2 * i], lcp.r_N[i] * unit / depth, 1e-8 * peak) << i << rigid << shift;
        EXPECT_NEAR(result.solution.r[2 * i + 1], lcp.r_T[i] * unit / depth, 1e-8 * peak) << i << rigid << shift;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Registry, CoreSolverTest,
                         testing::Values("lcp_lemke", "ac_newton", "interior_point", "gauss_seidel"),
                         [](const testing::TestParamInfo<const char*>& param) { return std::string(param.param); });
