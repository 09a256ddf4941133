/**
 * @file first_iterates_test.cpp
 * @brief No registry key is a wrapper of another: the first iterates of each are those of its own formula. The methods
 * with a test file of their own have it there; here are the remaining ones and what all have in common.
 */
#include <map>

#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/portfolio.h"
#include "method_test_support.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/// f of (1.23), (1.24) written out with rho = 1/2 everywhere, the disc's radius as the rule says.
VectorFunction textbookAlartCurnier(const DelassusProblem& problem, RadiusRule rule)
{
  return [problem, rule](const Eigen::VectorXd& r)
  {
    const Eigen::VectorXd u = problem.W.toDense() * r + problem.q;
    Eigen::VectorXd f(6);
    for (int i = 0; i < 2; ++i)
    {
      const double trial = r[3 * i] - 0.5 * u[3 * i];
      const double radius = problem.laws[static_cast<size_t>(i)].coefficient *
                            std::max(0.0, rule == RadiusRule::IMPULSE ? r[3 * i] : trial);
      Eigen::Vector2d y = r.segment<2>(3 * i + 1) - 0.5 * u.segment<2>(3 * i + 1);
      if (y.norm() > radius)
        y *= radius / y.norm();
      f[3 * i] = std::max(0.0, trial) - r[3 * i];
      f.segment<2>(3 * i + 1) = y - r.segment<2>(3 * i + 1);
    }
    return f;
  };
}

/// One contact with W_ii = 2 I in closed form: r_N = -q_N/2, r_T = -q_T/2 shortened to mu r_N.
Eigen::Vector3d isotropicContact(const Eigen::Vector3d& free, double mu)
{
  Eigen::Vector3d r = -0.5 * free;
  if (r.tail<2>().norm() > mu * r[0])
    r.tail<2>() *= mu * r[0] / r.tail<2>().norm();
  return r;
}

Eigen::VectorXd iterate(const std::string& name, int iterations, const Eigen::VectorXd& start)
{
  const std::unique_ptr<Solver> solver = createSolver(name);
  solver->setStopping(stopAfter(iterations, 1e-15));
  Solution guess;
  guess.r = start;
  return solver->solve(twoCoupledContacts(), &guess).solution.r;
}
}  // namespace

TEST(AcNewtonTest, FirstIterateIsNewtonOnAlartAndCurniersFunction)
{
  // From a start inside the pieces of the function: contact 1 slides, contact 2 sticks.
  const DelassusProblem problem = twoCoupledContacts();
  Eigen::VectorXd start(6);
  start << 0.7, 0.1, -0.2, 1.2, 0.1, 0.1;
  for (const RadiusRule rule : {RadiusRule::IMPULSE, RadiusRule::AUGMENTED})
  {
    AcNewton solver({}, rule);
    expectFirstIterateIsNewton(solver, problem, textbookAlartCurnier(problem, rule), start);
  }
}

TEST(GaussSeidelTest, ASweepSolvesContactAfterContact)
{
  const DelassusProblem problem = twoCoupledContacts();
  const Eigen::MatrixXd W = problem.W.toDense();
  Eigen::VectorXd r = Eigen::VectorXd::Zero(6);
  GaussSeidel solver;
  for (int sweeps = 1; sweeps <= 3; ++sweeps)
  {
    r.head<3>() = isotropicContact(problem.q.head<3>() + W.topRightCorner<3, 3>() * r.tail<3>(), 0.4);
    r.tail<3>() = isotropicContact(problem.q.tail<3>() + W.bottomLeftCorner<3, 3>() * r.head<3>(), 0.9);
    solver.setStopping(stopAfter(sweeps, 1e-15));
    EXPECT_LT((solver.solve(problem).solution.r - r).norm(), 1e-13) << sweeps;
  }
}

TEST(PortfolioTest, OnASmallProblemItStartsWithAlartAndCurniersNewton)
{
  const DelassusProblem problem = twoCoupledContacts();
  Eigen::VectorXd start(6);
  start << 0.7, 0.1, -0.2, 1.2, 0.1, 0.1;
  Portfolio portfolio;
  expectFirstIterateIsNewton(portfolio, problem, textbookAlartCurnier(problem, RadiusRule::AUGMENTED), start);
  const SolverResult result = portfolio.solve(problem);
  ASSERT_FALSE(result.tried.empty());
  EXPECT_EQ(result.tried.front(), "ac_newton");
}

TEST(FirstIteratesTest, NoMethodWalksTheWayOfAnother)
{
  // The iterates 1, 2, 3, 5 and 8 from one start, in a row. cadoux_* share r(s_0) and part afterwards; the portfolio is
  // made of others by its definition.
  Eigen::VectorXd start(6);
  start << 0.9, 0.2, -0.2, 1.5, 0.3, 0.2;
  std::map<std::string, Eigen::VectorXd> ways;
  for (const SolverEntry& entry : solverRegistry())
  {
    if (std::string(entry.name) == "portfolio")
      continue;
    Eigen::VectorXd way(5 * 6);
    int k = 0;
    for (const int iterations : {1, 2, 3, 5, 8})
      way.segment<6>(6 * k++) = iterate(entry.name, iterations, start);
    for (const auto& [name, other] : ways)
      EXPECT_GT((way - other).norm(), 1e-9) << entry.name << " and " << name;
    ways[entry.name] = way;
  }
}

TEST(FirstIteratesTest, EveryKeyIsComparedWithItsFormula)
{
  // Where: this file, or the method's own. A new key belongs here once its first iterate is tested.
  const std::vector<std::string> tested = {"portfolio",
                                           "ac_newton",
                                           "ds_newton",
                                           "ds_fixed_point",
                                           "ac_fixed_point",
                                           "fb_newton",
                                           "fb_bfgs",
                                           "bipotential",
                                           "gauss_seidel",
                                           "fb_newton_smoothed",
                                           "fb_levenberg_marquardt",
                                           "interior_point",
                                           "admm",
                                           "haslinger",
                                           "cadoux_fixed_point",
                                           "cadoux_newton",
                                           "cadoux_broyden",
                                           "lcp_lemke",
                                           "enumerate"};
  for (const SolverEntry& entry : solverRegistry())
    EXPECT_NE(std::find(tested.begin(), tested.end(), entry.name), tested.end()) << entry.name;
  EXPECT_EQ(tested.size(), solverRegistry().size());
}
