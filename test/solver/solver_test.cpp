#include "frictional_contact_sim/solver/solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/dense_lu.h"
#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/portfolio.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/allocation_counter.h"
#include "support/hand_problems.h"
#include "support/validator.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{
const Eigen::Vector3d GRAVITY(0, 0, -9.81);
constexpr double TIME_STEP = 1e-3;

StoppingOptions stopping(double tolerance, int iterations = 1000)
{
  StoppingOptions options;
  options.tolerance = tolerance;
  options.max_iterations = iterations;
  return options;
}

/** Claims convergence without doing anything. */
class Liar : public Solver
{
public:
  Liar() : Solver("liar") {}

protected:
  void doSolve(const DelassusProblem&, const SolveContext&, SolverResult& result) override
  {
    result.status = SolverStatus::CONVERGED;
  }
};

IncrementalProblem everyLaw(std::uint32_t seed)
{
  RandomProblemOptions options;
  options.planar_contacts = 2;
  options.unilateral = 2;
  options.dry = 2;
  return randomProblem(options, seed);
}
}  // namespace

TEST(SolverTest, WithdrawsAConvergenceThatTheResidualDoesNotConfirm)
{
  Liar liar;
  const SolverResult result = liar.solve(restingBox(1, {1, 1, 1}, 0.5, {0, 0, 0}, GRAVITY, TIME_STEP));
  EXPECT_EQ(result.status, SolverStatus::STAGNATED);
  EXPECT_GT(result.residual, 0.1);
  EXPECT_FALSE(result.message.empty());
}

TEST(SolverTest, MisuseThrowsWithTheNameAndTheValue)
{
  GaussSeidel solver;
  const auto expectMessage = [](const auto& call, const std::string& part)
  {
    try
    {
      call();
      FAIL() << "accepted, expected a complaint about " << part;
    }
    catch (const std::invalid_argument& error)
    {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  const IncrementalProblem problem = everyLaw(1);
  Solution guess;
  guess.r.setZero(3);
  expectMessage([&] { solver.solve(problem, &guess); }, "guess.r has 3");
  expectMessage([&] { solver.setStopping(stopping(-1.0)); }, "tolerance is -1");
  expectMessage([&] { solver.setStopping(stopping(1e-8, -2)); }, "max_iterations is -2");
  expectMessage([] { createSolver("nonsense"); }, "'nonsense', expected one of: portfolio");
  GaussSeidelOptions sweeps;
  sweeps.relaxation = 2.5;
  expectMessage([&] { solver.setOptions(sweeps); }, "gauss_seidel.relaxation is 2.5");
  SemismoothNewtonOptions newton;
  newton.proximal_start = 0.0;
  expectMessage([&] { AcNewton{newton}; }, "proximal_start is 0");
  newton = {};
  newton.proximal_restart = 20.0;
  expectMessage([&] { AcNewton{newton}; }, "proximal_restart is 20");
  PortfolioOptions portfolio;
  portfolio.newton_steps = 0;
  expectMessage([&] { Portfolio{portfolio}; }, "portfolio.newton_steps is 0");
}

TEST(SolverTest, ProblemsWithoutRowsAreSolvedByTheDynamicsAlone)
{
  RandomProblemOptions options;
  options.contacts = 0;
  options.bilaterals = 2;
  const IncrementalProblem problem = randomProblem(options, 5);
  for (const SolverEntry& entry : solverRegistry())
  {
    const SolverResult result = entry.create()->solve(problem);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << entry.name;
    EXPECT_LT(validateAnswer(problem, result.solution.v, result.solution.r, result.solution.lambda).worst(), 1e-12);
  }
}

TEST(DenseLuTest, SolvesWithPivoting)
{
  std::srand(3);
  DenseLu lu;
  lu.reserve(40);
  for (int size = 1; size <= 40; ++size)
  {
    MatrixXd A = MatrixXd::Random(size, size);
    A(0, 0) = 0.0;
    if (size == 1)
      A(0, 0) = 2.0;
    const VectorXd x = VectorXd::Random(size);
    VectorXd b = A * x;
    lu.start(size) = A;
    ASSERT_TRUE(lu.factor());
    lu.solve(b);
    EXPECT_LT((b - x).norm(), 1e-14 * A.inverse().norm() * A.norm() * 10);
  }
  lu.start(3).setZero();
  EXPECT_FALSE(lu.factor());
}

// Twelve rows of rank six: only the proximal term makes the Jacobian regular. Every contact sticks, so that the
// equations are linear and one step solves them but for what that term, 1e-6, leaves: its square.
TEST(AcNewtonTest, ProximalTermLeavesOnlyItsSquareInAStepFromTheCentre)
{
  const IncrementalProblem problem = restingBox(1, {1, 1, 1}, 0.5, {0, 0, 0}, GRAVITY, TIME_STEP);
  AcNewton newton;
  newton.setStopping(stopping(1e-10));
  const SolverResult result = newton.solve(problem);
  EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.residual;
  EXPECT_EQ(result.iterations, 1);
}

TEST(AcNewtonTest, WithoutRestartsTheFirstFailureEndsTheRun)
{
  // A start far out on one contact: no length of the first step decreases the merit enough.
  const IncrementalProblem problem = restingBox(1, {1, 1, 1}, 0.5, {3, 1, -5}, GRAVITY, TIME_STEP);
  Solution guess;
  guess.r = 1e6 * VectorXd::Random(problem.rows());
  SemismoothNewtonOptions options;
  options.watchdog_min = 1.0;
  options.inner_iterations = 1;
  AcNewton newton(options);
  newton.setStopping(stopping(1e-10));
  const SolverResult stubborn = newton.solve(problem, &guess);
  options.restarts = false;
  newton.setOptions(options);
  const SolverResult once = newton.solve(problem, &guess);
  EXPECT_EQ(once.status, SolverStatus::STAGNATED);
  EXPECT_LT(once.iterations, stubborn.iterations);
}

TEST(AcNewtonTest, SurvivesTheSingularJacobianOfExampleD2)
{
  const IncrementalProblem problem = squareOnTwoContacts();
  const DelassusProblem local = reduce(problem);
  const MatrixXd W = local.W.toDense();
  const Eigen::Vector4d start(6, 1, 8, 9);
  const VectorXd u = W * start + local.q;
  // The thesis's start with rho = 0.1: df/dr = 0 at both contacts, and the Jacobian A W is singular since W is.
  MatrixXd A = MatrixXd::Zero(4, 4);
  for (int i = 0; i < 2; ++i)
  {
    const ContactFunction<2> f =
        alartCurnierJacobian<2>(u.segment<2>(2 * i), start.segment<2>(2 * i), 1.0, 0.1, 0.1, RadiusRule::IMPULSE);
    EXPECT_EQ(f.by_r.norm(), 0.0);
    A.block<2, 2>(2 * i, 2 * i) = f.by_u;
  }
  EXPECT_LT(std::abs((A * W).determinant()), 1e-15);
  EXPECT_EQ(Eigen::FullPivLU<MatrixXd>(A * W).rank(), 3);

  for (const RadiusRule rule : {RadiusRule::IMPULSE, RadiusRule::AUGMENTED})
  {
    AcNewton newton({}, rule);
    newton.setStopping(stopping(1e-13, 50));
    Solution guess;
    guess.r = start;
    const SolverResult result = newton.solve(problem, &guess);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << result.message << " E = " << result.residual;
    EXPECT_LT(result.solution.v.norm(), 1e-12);
    // The forces carry the weight half and half, and push against each other sideways by any amount within the cones.
    EXPECT_NEAR(result.solution.r[0], 0.5, 1e-12);
    EXPECT_NEAR(result.solution.r[2], 0.5, 1e-12);
    EXPECT_NEAR(result.solution.r[1] + result.solution.r[3], 0.0, 1e-12);
  }
}

class RestingBoxTest : public testing::TestWithParam<const char*>
{
};

TEST_P(RestingBoxTest, ReachesRoundOffWithoutStallingAHairAboveTheTolerance)
{
  const std::unique_ptr<Solver> solver = createSolver(GetParam());
  for (const double tolerance : {1e-8, 1e-11, 1e-13})
  {
    solver->setStopping(stopping(tolerance, 200));
    const IncrementalProblem box = restingBox(10, {0.5, 0.3, 0.2}, 0.5, {0, 0, 0}, GRAVITY, TIME_STEP);
    const SolverResult result = solver->solve(box);
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << tolerance << " E = " << result.residual;
    const VectorXd& r = result.solution.r;
    EXPECT_NEAR(r[0] + r[3] + r[6] + r[9], 0.0981, 10 * 0.00981 * tolerance * 10);
  }
}

TEST_P(RestingBoxTest, ASymmetricProblemHasSymmetricForces)
{
  const std::unique_ptr<Solver> solver = createSolver(GetParam());
  solver->setStopping(stopping(1e-12, 200));
  const SolverResult result = solver->solve(restingBox(10, {0.5, 0.3, 0.2}, 0.5, {0, 0, 0}, GRAVITY, TIME_STEP));
  ASSERT_EQ(result.status, SolverStatus::CONVERGED);
  for (int corner = 0; corner < 4; ++corner)
  {
    // A quarter of the weight each; sideways nothing. Null-space noise is eps / alpha, about 1e-10 relative.
    EXPECT_NEAR(result.solution.r[3 * corner], 0.0981 / 4, 1e-9);
    EXPECT_NEAR(result.solution.r.segment<2>(3 * corner + 1).norm(), 0.0, 1e-9);
  }
}

TEST_P(RestingBoxTest, SlidesWithFullFrictionAgainstItsMotion)
{
  const std::unique_ptr<Solver> solver = createSolver(GetParam());
  solver->setStopping(stopping(1e-12, 500));
  const Eigen::Vector3d velocity(0.6, -0.8, 0);
  const IncrementalProblem box = restingBox(10, {0.5, 0.3, 0.02}, 0.5, velocity, GRAVITY, TIME_STEP);
  const SolverResult result = solver->solve(box);
  ASSERT_EQ(result.status, SolverStatus::CONVERGED) << result.residual;
  // Deceleration mu g along the motion, no lift, no turn.
  VectorXd expected = VectorXd::Zero(6);
  expected.head<3>() = velocity * (1.0 - 0.5 * 9.81 * TIME_STEP);
  EXPECT_LT((result.solution.v - expected).norm(), 1e-11);
}

INSTANTIATE_TEST_SUITE_P(SymmetricMethods, RestingBoxTest, testing::Values("ac_newton", "portfolio"));

TEST(PortfolioTest, AGoodGuessNeedsNoIteration)
{
  Portfolio portfolio;
  portfolio.setStopping(stopping(1e-10));
  const IncrementalProblem box = restingBox(10, {0.5, 0.3, 0.2}, 0.5, {0, 0, 0}, GRAVITY, TIME_STEP);
  const SolverResult cold = portfolio.solve(box);
  const SolverResult warm = portfolio.solve(box, &cold.solution);
  EXPECT_EQ(warm.status, SolverStatus::CONVERGED);
  EXPECT_EQ(warm.iterations, 0);
  EXPECT_EQ(warm.solution.r, cold.solution.r);
}

TEST(PortfolioTest, StaysNearTheGuessAmongManySolutions)
{
  // The square on two contacts: sideways impulses (s, -s) are all solutions for |s| <= 1/2. Start near s = 0.2.
  Portfolio portfolio;
  portfolio.setStopping(stopping(1e-12));
  Solution guess;
  guess.r = Eigen::Vector4d(0.4, 0.21, 0.55, -0.19);
  const SolverResult result = portfolio.solve(squareOnTwoContacts(), &guess);
  ASSERT_EQ(result.status, SolverStatus::CONVERGED);
  EXPECT_NEAR(result.solution.r[1], 0.2, 1e-6);
  EXPECT_NEAR(result.solution.r[3], -0.2, 1e-6);
}

TEST(PortfolioTest, NeverReturnsWorseThanTheGuess)
{
  // One iteration is not enough for these; what comes back must not be worse than the guess.
  Portfolio portfolio;
  portfolio.setStopping(stopping(1e-14, 1));
  for (std::uint32_t seed = 1; seed <= 30; ++seed)
  {
    const DelassusProblem problem = reduce(everyLaw(seed));
    std::srand(seed);
    Solution guess;
    guess.r = VectorXd::Random(problem.W.rows());
    const double before = evaluateResidual(problem, guess.r);
    const SolverResult result = portfolio.solve(problem, &guess);
    EXPECT_LE(result.residual, before);
    EXPECT_EQ(result.residual <= 1e-14, result.status == SolverStatus::CONVERGED);
  }
}

TEST(PortfolioTest, InfeasibleProblemsAreReportedWithTheBestIterate)
{
  // A disc squeezed between a still and an approaching plane: u_1 = v, u_2 = -v - 1, both must be >= 0.
  IncrementalProblem problem;
  problem.M = sparse(MatrixXd::Identity(1, 1));
  problem.f = VectorXd::Zero(1);
  problem.H = sparse((MatrixXd(2, 1) << 1, -1).finished());
  problem.w = Eigen::Vector2d(0, -1);
  problem.laws.assign(2, {LawType::UNILATERAL, 0.0});
  problem.G.resize(0, 1);
  Portfolio portfolio;
  const SolverResult result = portfolio.solve(problem);
  EXPECT_NE(result.status, SolverStatus::CONVERGED);
  EXPECT_TRUE(result.solution.r.allFinite());
  EXPECT_TRUE(result.solution.v.allFinite());
  EXPECT_FALSE(result.message.empty());
}

TEST(AllocationTest, RepeatedSolvesOfOneShapeAllocateNothing)
{
  for (const char* name : {"gauss_seidel", "ac_newton", "portfolio"})
  {
    const std::unique_ptr<Solver> solver = createSolver(name);
    solver->setStopping(stopping(1e-10, 500));
    SolverResult result;
    // The active sets of the second problem differ from the first's: their sizes must not matter either.
    const IncrementalProblem first = everyLaw(1);
    IncrementalProblem second = first;
    second.f *= -0.7;
    solver->solve(first, nullptr, result);
    const AllocationCounter counter;
    solver->solve(second, nullptr, result);
    EXPECT_EQ(counter.count(), 0) << name;
    EXPECT_EQ(result.status, SolverStatus::CONVERGED) << name;
    EXPECT_GT(result.iterations, 0) << name;
  }
}

TEST(DeterminismTest, TheSameInputGivesTheSameBits)
{
  for (const SolverEntry& entry : solverRegistry())
  {
    const std::unique_ptr<Solver> first = entry.create(), second = entry.create();
    first->setStopping(stopping(1e-8, 100));
    second->setStopping(stopping(1e-8, 100));
    first->solve(everyLaw(7));  // what it solved before must not matter
    EXPECT_EQ(first->solve(everyLaw(3)).solution.r, second->solve(everyLaw(3)).solution.r) << entry.name;
  }
}
