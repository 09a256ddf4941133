// The default budget bounds the work of every method, inner iterations and factorizations counted; a flag ends a solve.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "frictional_contact_sim/solver/registry.h"
#include "support/thesis_problems.h"

using namespace frictional_contact_sim;
using namespace frictional_contact_sim::test_support;

namespace
{
/** Far more contacts than velocities, mu 10 and a w that no motion meets: nothing converges. */
IncrementalProblem hopeless(int contacts, int velocities, double friction, double scale, unsigned seed)
{
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const auto gaussian = [&](int rows, int columns)
  { return Eigen::MatrixXd::NullaryExpr(rows, columns, [&]() { return scale * normal(engine); }).eval(); };
  const Eigen::MatrixXd A = gaussian(velocities, velocities);
  Eigen::VectorXd w = gaussian(3 * contacts, 1);
  Eigen::MatrixXd H = gaussian(3 * contacts, velocities);
  H.bottomRows(3) = -H.topRows(3);  // opposite to the first contact, both approaching: infeasible
  w[0] = w[3 * contacts - 3] = -scale;
  return denseProblem(A * A.transpose() + scale * scale * 1e-6 * Eigen::MatrixXd::Identity(velocities, velocities),
                      gaussian(velocities, 1), H, w,
                      std::vector<Law>(static_cast<size_t>(contacts), {LawType::COULOMB_3D, friction}));
}

/** What one iteration may take beyond the limit before it is asked: some 30 factorizations of 3 n_c rows (the trials of
 *  lambda in fb_newton_smoothed), or the 1e6 entries of a tableau between two questions of lcp_lemke. */
double slack(const IncrementalProblem& problem)
{
  return 30.0 * problem.rows() / 3.0 + 1e6 / problem.rows();
}
}  // namespace

TEST(WorkBudgetTest, EveryMethodEndsWithinItOnProblemsThatNothingSolves)
{
  for (const double scale : {1.0, 1e6})
  {
    const IncrementalProblem problem = hopeless(40, 12, 10.0, scale, 7);
    for (const SolverEntry& entry : solverRegistry())
    {
      StoppingOptions stopping;
      stopping.work_per_iteration = 20.0;
      stopping.max_iterations = 500;
      const std::unique_ptr<Solver> solver = entry.create();
      solver->setStopping(stopping);
      const SolverResult result = solver->solve(problem);
      EXPECT_LE(result.iterations, stopping.max_iterations) << entry.name;
      EXPECT_LE(result.work, 500 * 20.0 + slack(problem)) << entry.name;
      EXPECT_NE(result.status, SolverStatus::TIME_LIMIT) << entry.name << ": there is no clock";
      EXPECT_NE(result.status, SolverStatus::NOT_RUN) << entry.name;
      EXPECT_TRUE(result.solution.v.allFinite() && result.solution.r.allFinite()) << entry.name;
    }
  }
}

/** Without the budget of work 1000 outer iterations of cadoux_fixed_point may take 2000 inner ones each. */
TEST(WorkBudgetTest, ExhaustedWorkIsSaidAndIsTheSameInEveryRun)
{
  const IncrementalProblem problem = hopeless(40, 12, 10.0, 1.0, 3);
  StoppingOptions stopping;
  stopping.work_per_iteration = 1.0;
  stopping.max_iterations = 200;
  const std::unique_ptr<Solver> solver = createSolver("cadoux_fixed_point");
  solver->setStopping(stopping);
  const SolverResult first = solver->solve(problem);
  EXPECT_EQ(first.status, SolverStatus::MAX_ITERATIONS);
  EXPECT_NE(first.message.find("work exhausted: more than 200 products"), std::string::npos) << first.message;
  const SolverResult second = solver->solve(problem);
  EXPECT_EQ(first.solution.r, second.solution.r);
  EXPECT_EQ(first.work, second.work);
}

/** The flag is set by another thread once the solve runs. Without it the budget would last for hours. */
TEST(WorkBudgetTest, AFlagEndsASolveOfEveryMethod)
{
  const IncrementalProblem problem = hopeless(60, 12, 10.0, 1.0, 5);
  for (const SolverEntry& entry : solverRegistry())
  {
    std::atomic<bool> stop{false};
    StoppingOptions stopping;
    stopping.tolerance = 1e-300;
    stopping.max_iterations = 1000000000;
    stopping.work_per_iteration = 1e6;
    stopping.stop = &stop;
    const std::unique_ptr<Solver> solver = entry.create();
    solver->setStopping(stopping);
    std::thread signal(
        [&stop]
        {
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
          stop = true;
        });
    const SolverResult result = solver->solve(problem);
    signal.join();
    // A method that gives up by itself first says so; what is asserted is that all come back, finite.
    EXPECT_NE(result.status, SolverStatus::CONVERGED) << entry.name;
    EXPECT_TRUE(result.solution.r.allFinite()) << entry.name;
    stop = true;
    const SolverResult stopped = solver->solve(problem);
    EXPECT_EQ(stopped.status, SolverStatus::STOPPED_BY_USER) << entry.name << ": " << stopped.message;
    EXPECT_EQ(stopped.message, "stopped from outside") << entry.name;
  }
}

/** One slot for every island: a hard island leaves the others their budget. */
TEST(WorkBudgetTest, AHardIslandDoesNotStarveTheOthers)
{
  const IncrementalProblem hard = hopeless(20, 6, 10.0, 1.0, 3);
  const Eigen::Index rows = hard.rows(), velocities = hard.velocities();
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(velocities + 3, velocities + 3);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(rows + 3, velocities + 3);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(velocities + 3), w = Eigen::VectorXd::Zero(rows + 3);
  M.topLeftCorner(velocities, velocities) = Eigen::MatrixXd(hard.M);
  H.topLeftCorner(rows, velocities) = Eigen::MatrixXd(hard.H);
  H.bottomRightCorner(3, 3).setIdentity();
  f.head(velocities) = hard.f;
  f.tail(3) << 1.0, 0.7, -0.2;  // falls and slides
  w.head(rows) = hard.w;
  std::vector<Law> laws = hard.laws;
  laws.push_back({LawType::COULOMB_3D, 0.5});
  const IncrementalProblem problem = denseProblem(M, f, H, w, laws);
  const std::unique_ptr<Solver> solver = createSolver("cadoux_fixed_point");
  StoppingOptions stopping;
  stopping.work_per_iteration = 2.0;
  solver->setStopping(stopping);
  const SolverResult result = solver->solve(problem);
  EXPECT_NE(result.status, SolverStatus::CONVERGED);
  // Closed form of the one contact: r_N = 1, friction 0.5 against the slip (-0.7, 0.2).
  EXPECT_NEAR(result.solution.r[rows], 1.0, 1e-7);
  EXPECT_NEAR(result.solution.r.tail(2).norm(), 0.5, 1e-7);
}
