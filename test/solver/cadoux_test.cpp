/**
 * @file cadoux_test.cpp
 * @brief The outer loops around convex problems (cadoux_*, haslinger, interior_point) and admm.
 */
#include <gtest/gtest.h>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/random_family.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/admm.h"
#include "frictional_contact_sim/solver/cadoux_broyden.h"
#include "frictional_contact_sim/solver/cadoux_fixed_point.h"
#include "frictional_contact_sim/solver/cadoux_newton.h"
#include "frictional_contact_sim/solver/convex/convex_interior_point.h"
#include "frictional_contact_sim/solver/convex/projected_gradient.h"
#include "frictional_contact_sim/solver/haslinger.h"
#include "frictional_contact_sim/solver/interior_point.h"
#include "frictional_contact_sim/solver/outer_loop.h"
#include "method_test_support.h"
#include "support/hand_problems.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
const std::vector<std::string> METHODS = {"cadoux_fixed_point", "cadoux_newton",  "cadoux_broyden",
                                          "haslinger",          "interior_point", "admm"};

/// Exact here: with W = I one projected gradient step solves the convex problem.
std::unique_ptr<ConvexSolver> exactInner()
{
  return std::make_unique<ProjectedGradient>();
}

template <typename Method>
Eigen::VectorXd impulseAfter(Method& solver, int iterations)
{
  solver.setStopping(stopAfter(iterations, 1e-15));
  return solver.solve(slidingContact()).solution.r;
}
}  // namespace

TEST(CadouxFixedPointTest, FirstIteratesAreThoseOfTheFormula)
{
  // s_0 = |q_T| = 2: r_1 = (0.8, 0.4, 0), s_1 = F(2) = 1.6: r_2 = (0.96, 0.48, 0).
  CadouxFixedPoint solver({}, exactInner());
  EXPECT_LT((impulseAfter(solver, 1) - Eigen::Vector3d(0.8, 0.4, 0)).norm(), 1e-15);
  EXPECT_LT((impulseAfter(solver, 2) - Eigen::Vector3d(0.96, 0.48, 0)).norm(), 1e-15);
}

TEST(CadouxFixedPointTest, ZeroInitialSlipIsTheThesisStart)
{
  // r(0) = P_K(1, 2, 0) = (1.6, 0.8, 0), worse than r = 0 in no way: E is smaller, it is kept.
  CadouxOptions options;
  options.initial_slip = InitialSlip::ZERO;
  CadouxFixedPoint solver(options, exactInner());
  EXPECT_LT((impulseAfter(solver, 1) - Eigen::Vector3d(1.6, 0.8, 0)).norm(), 1e-14);
}

TEST(CadouxNewtonTest, OneStepFromTheAffineMapIsExact)
{
  // F is affine near s = 2: Newton's ds = (F - s)/(1 - F') = -0.4/0.8.
  const DelassusProblem problem = slidingContact();
  const ResidualMetric metric = makeMetric(problem);
  SlipMap map(exactInner());
  map.setProblem(problem, SolveContext{metric});
  map.setGuess(Eigen::VectorXd::Zero(3));
  const Eigen::VectorXd s = map.value();
  ConvexBudget budget;
  budget.tolerance = 1e-14;
  map.evaluate(s, budget);
  // The proximal term is the only other thing in the step: relative to W it is 1e-13.
  Eigen::VectorXd step;
  ASSERT_TRUE(CadouxNewtonStep().compute(problem, map, s, 1e-13, step));
  ASSERT_EQ(step.size(), 1);
  EXPECT_NEAR(step[0], -0.5, 1e-12);
}

TEST(CadouxNewtonTest, IteratesAreNewtonsOnTheFixedPoint)
{
  // s_0 = 2: r_1 = r(2); Newton on the affine F - s gives s_1 = 3/2, the solution.
  // The proximal term shortens the step by its own share.
  CadouxNewtonOptions options;
  options.proximal = 1e-13;
  CadouxNewton solver(options, exactInner());
  EXPECT_LT((impulseAfter(solver, 1) - Eigen::Vector3d(0.8, 0.4, 0)).norm(), 1e-14);
  EXPECT_LT((impulseAfter(solver, 2) - Eigen::Vector3d(1, 0.5, 0)).norm(), 1e-12);
}

TEST(CadouxNewtonTest, StepIsNewtonsOnTheSlipMap)
{
  // Three coupled contacts: one sticks, one slides, one parts. The step must solve (F' - I) ds = s - F with the
  // Jacobian of F from central differences.
  Eigen::Matrix<double, 9, 9> H;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j)
      H(i, j) = std::sin(1.0 + 3.0 * i + 7.0 * j);
  DelassusProblem problem;
  problem.laws.assign(3, Law{LawType::COULOMB_3D, 0.5});
  problem.W.assign(Eigen::MatrixXd(Eigen::MatrixXd::Identity(9, 9) + 0.05 * H * H.transpose()), problem.laws);
  problem.q.resize(9);
  problem.q << -2.0, 0.1, 0.1, -1.0, 2.0, -1.5, 3.0, 0.3, -0.2;
  const ResidualMetric metric = makeMetric(problem);
  SlipMap map(std::make_unique<ConvexInteriorPoint>());
  map.setProblem(problem, SolveContext{metric});
  map.setGuess(Eigen::VectorXd::Zero(9));
  ConvexBudget budget;
  budget.tolerance = 1e-13;
  const Eigen::Vector3d s(0.05, 2.0, 0.4);
  constexpr double WIDTH = 1e-4;
  Eigen::Matrix3d slope;
  for (int k = 0; k < 3; ++k)
  {
    map.evaluate(s + WIDTH * Eigen::Vector3d::Unit(k), budget);
    slope.col(k) = map.value();
    map.evaluate(s - WIDTH * Eigen::Vector3d::Unit(k), budget);
    slope.col(k) = (slope.col(k) - map.value()) / (2.0 * WIDTH);
  }
  map.evaluate(s, budget);
  ASSERT_LT(map.r().segment<2>(1).norm(), 0.5 * map.r()[0]);  // sticks
  ASSERT_GT(map.value()[1], 0.1);  // slides
  ASSERT_LT(map.r()[6], 1e-12);  // parts
  const Eigen::Vector3d expected = (Eigen::Matrix3d::Identity() - slope).lu().solve(map.value() - s);
  Eigen::VectorXd step;
  ASSERT_TRUE(CadouxNewtonStep().compute(problem, map, s, 1e-13, step));
  // Central differences: WIDTH^2 beside the inner tolerance over WIDTH.
  EXPECT_LT((step - expected).norm(), 1e-6 * expected.norm());
}

TEST(CadouxNewtonTest, SolvesTheLargestRandomDraw)
{
  // 500 contacts, 1500 rows of rank 1260: the least-squares step of the thesis is singular here, and dense.
  DelassusReduction reduction;
  reduction.compute(randomFamilyProblem(largeRandomFamily().back().options));
  CadouxNewton solver;
  solver.setStopping(stopAfter(50, 1e-8));
  const SolverResult result = solver.solve(reduction.problem());
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message << ' ' << result.residual;
}

TEST(CadouxBroydenTest, SecondUpdateIsTheSecant)
{
  // s = 2, 1.6, then the secant of an affine function: 1.5 exactly, so the third evaluation is the solution.
  CadouxBroyden solver({}, exactInner());
  solver.setStopping(stopAfter(3, 1e-14));
  const SolverResult result = solver.solve(slidingContact());
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.residual;
  EXPECT_EQ(result.iterations, 3);
}

TEST(HaslingerTest, FirstIteratesAreThoseOfTheFormula)
{
  // s_0 = 0: r_1 = (1, 0, 0), s_1 = 1/2: r_2 = (1, 1/2, 0), the solution.
  Haslinger solver({}, exactInner());
  EXPECT_LT((impulseAfter(solver, 1) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((impulseAfter(solver, 2) - Eigen::Vector3d(1, 0.5, 0)).norm(), 1e-15);
}

TEST(AdmmTest, FirstIterateByHand)
{
  // y = x = 0, s = 0, rho = 1: r = -q/2 = (1/2, 1, 0), y = P_K(r) = (0.8, 0.4, 0).
  Admm solver;
  EXPECT_LT((impulseAfter(solver, 1) - Eigen::Vector3d(0.8, 0.4, 0)).norm(), 1e-15);
}

TEST(OuterLoopsTest, FrictionlessProblemsAreOneConvexProblem)
{
  // The inner solver must do it in one outer iteration: nothing enters the loop (remarks 4.15, 4.18).
  const IncrementalProblem box = restingBox(10, {0.5, 0.3, 0.1}, 0.0, {1, 0, 0}, {0, 0, -9.81}, 1e-3);
  for (int k = 0; k < 4; ++k)
  {
    std::unique_ptr<Solver> solver;
    if (k == 0)
      solver = std::make_unique<CadouxFixedPoint>(CadouxOptions{}, std::make_unique<ConvexInteriorPoint>());
    else if (k == 1)
      solver = std::make_unique<Haslinger>(HaslingerOptions{}, std::make_unique<ConvexInteriorPoint>());
    else if (k == 2)
      solver = std::make_unique<CadouxBroyden>(CadouxBroydenOptions{}, std::make_unique<ConvexInteriorPoint>());
    else
      solver = std::make_unique<CadouxNewton>(CadouxNewtonOptions{}, std::make_unique<ConvexInteriorPoint>());
    const SolverResult result = solver->solve(box);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << solver->name();
    EXPECT_EQ(result.iterations, 1) << solver->name();
  }
}

TEST(OuterLoopsTest, Example321HasItsTrueSolution)
{
  for (const std::string& name : METHODS)
  {
    const std::unique_ptr<Solver> solver = createSolver(name);
    solver->setStopping(stopAfter(500));
    const SolverResult result = solver->solve(example321());
    ASSERT_EQ(result.status, SolverStatus::CONVERGED) << name << ": " << result.message;
    // The residual's tolerance; M = I.
    EXPECT_LT((result.solution.v - Eigen::Vector2d(0, -1)).norm(), 1e-7) << name;
    EXPECT_LT(result.solution.r.norm(), 1e-7) << name;
  }
}

TEST(OuterLoopsTest, Example321FromZeroSlipIsUnqualifiedAndLeft)
{
  // At s = 0 the convex problem has no minimum: r runs to infinity along (1, -1, 0), which isUnqualified() sees.
  DelassusReduction reduction;
  reduction.compute(example321());
  const DelassusProblem& local = reduction.problem();
  const ResidualMetric metric = makeMetric(local);
  SlipMap map(std::make_unique<ConvexInteriorPoint>());
  map.setProblem(local, SolveContext{metric});
  map.setGuess(Eigen::VectorXd::Zero(3));
  ConvexBudget budget;
  budget.tolerance = 1e-12;
  EXPECT_NE(map.evaluate(Eigen::VectorXd::Zero(1), budget).status, ConvexStatus::CONVERGED);
  EXPECT_TRUE(isUnqualified(map.convexProblem(), map.shiftedVelocity(), map.r())) << map.r().transpose();
  map.setGuess(Eigen::VectorXd::Zero(3));
  map.evaluate(Eigen::VectorXd::Ones(1), budget);
  EXPECT_FALSE(isUnqualified(map.convexProblem(), map.shiftedVelocity(), map.r()));

  CadouxOptions options;
  options.initial_slip = InitialSlip::ZERO;
  CadouxFixedPoint solver(options, std::make_unique<ConvexInteriorPoint>());
  const SolverResult result = solver.solve(example321());
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message;
  EXPECT_LT((result.solution.v - Eigen::Vector2d(0, -1)).norm(), 1e-6) << "the false fixed point is v = 0";
}

TEST(OuterLoopsTest, AgreeWithGaussSeidelOnAllLaws)
{
  for (const std::string& name : METHODS)
    expectAgreementWithGaussSeidel(name, 5000);
}

TEST(OuterLoopsTest, HonestWhereThereIsNoSolution)
{
  for (const std::string& name : METHODS)
    expectHonestWithoutSolution(name);
}

TEST(OuterLoopsTest, ConvergeFromTheStartOfExampleD2)
{
  for (const std::string& name : METHODS)
    expectConvergenceFromExampleD2(name, 2000);
}

TEST(InteriorPointTest, FirstIterateByHand)
{
  // Cold: s = |q_T| = 2, c = (0, -2, 0), x = (1, 0, 0), z = (4, 0, 0), so r = (2, 0, 0), N = 1/2, lambda = (2, 0, 0)
  // and A = diag(1/2, 1, 1): the matrix is I + 4 A^2 = diag(2, 5, 5).
  //   predictor  dr = (-2, 2, 0) / diag = (-1, 2/5, 0), dx = (-1, 4/5, 0), dz = (-1, -4/5, 0): t_a = 10/9, sigma = 0
  //   corrector  lambda \ (-4 - (1 - 0.64), 0, 0) = (-2.18, 0, 0): dr = (-2.18, 2, 0) / diag, a whole step
  InteriorPoint solver;
  EXPECT_LT((impulseAfter(solver, 1) - Eigen::Vector3d(0.91, 0.4, 0)).norm(), 1e-12);
}

TEST(InteriorPointTest, ReachesTenDigitsOnRedundantContacts)
{
  const IncrementalProblem box = restingBox(10, {0.5, 0.3, 0.1}, 0.5, {1, -2, 0}, {0, 0, -9.81}, 1e-3);
  InteriorPoint solver;
  solver.setStopping(stopAfter(200, 1e-10));
  const SolverResult result = solver.solve(box);
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message << " E = " << result.residual;
}

TEST(OuterLoopsTest, AnInnerProblemIsNeverAskedForMoreThanATenthOfALooseTolerance)
{
  const ResidualMetric metric;
  SolveContext context{metric};
  SolverResult result;
  const OuterLoop loop(context, result);  // whose last residual counts as 1
  context.tolerance = 1e-8;
  EXPECT_EQ(loop.innerTolerance(0.01, true), 0.01);
  EXPECT_EQ(loop.innerTolerance(0.01, false), 0.1 * 1e-8);
  // A tolerance above ten times the inner accuracy crosses the two bounds.
  context.tolerance = 0.5;
  EXPECT_EQ(loop.innerTolerance(0.01, true), 0.1 * 0.5);
  for (const char* name : {"cadoux_fixed_point", "cadoux_newton", "cadoux_broyden", "haslinger"})
  {
    const std::unique_ptr<Solver> solver = createSolver(name);
    StoppingOptions stopping;
    stopping.tolerance = 0.5;
    solver->setStopping(stopping);
    EXPECT_EQ(solver->solve(randomProblem({}, 3)).status, SolverStatus::CONVERGED) << name;
  }
}

TEST(OuterLoopsTest, OptionsAreChecked)
{
  CadouxOptions cadoux;
  cadoux.relaxation = 0.0;
  EXPECT_THROW(CadouxFixedPoint{cadoux}, std::invalid_argument);
  InteriorPointOptions interior;
  interior.slip_centring = -1.0;
  EXPECT_THROW(InteriorPoint{interior}, std::invalid_argument);
  AdmmOptions admm;
  admm.penalty = 0.0;
  EXPECT_THROW(Admm{admm}, std::invalid_argument);
}
