// What a failed step leaves behind under each policy, and what is tried before it is given up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <stdexcept>

#include "frictional_contact_sim/problem/energy_check.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/solver/registry.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
using testing::HasSubstr;
namespace fs = std::filesystem;

/** A method made of a function, to fail in ways that ours do not. */
class FakeSolver : public Solver
{
public:
  using Method = std::function<void(const DelassusProblem&, const SolveContext&, SolverResult&)>;
  explicit FakeSolver(Method method) : Solver("fake"), method_(std::move(method)) {}

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override
  {
    method_(problem, context, result);
  }

private:
  Method method_;
};

/** Two boxes that slide; one has an expiring wrench, so that a step has something to forget. */
Scenario slidingScene()
{
  Scenario scene = groundScene(0.5, 0.3);
  scene.stopping.tolerance = 1e-10;
  scene.stopping.split_islands = false;  // an island whose warm start is its answer would not even be shown to a fake
  BodySpec& box = addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.1));
  box.linear_velocity = {1.0, 0.3, 0.0};
  ExternalWrench wrench;
  wrench.link = "body";
  wrench.force = {1.0, 0.0, 0.0};
  wrench.until = 0.0101;  // over in the middle of the 11th step
  box.wrenches.push_back(wrench);
  addBody(scene, "ball", sphereUrdf(0.1, 0.5), poseAt(1.0, 0.0, 0.1)).linear_velocity = {-0.5, 0.0, 0.0};
  return scene;
}

/** A motor that cannot reach its target: its servo is far beyond its limit of 0.5 N m, on a base that rises. */
Scenario motorScene(double max_effort = 0.5)
{
  Scenario scene = groundScene(0.5);
  scene.stopping.tolerance = 1e-10;
  scene.stopping.split_islands = false;
  BodySpec arm;
  arm.name = "arm";
  arm.urdf_xml =
      "<robot name='arm'><link name='base'/><link name='rod'><inertial><origin xyz='0.3 0 0'/><mass value='1'/>"
      "<inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link><joint name='hinge' "
      "type='revolute'><parent link='base'/><child link='rod'/><axis xyz='0 1 0'/>"
      "<limit lower='-3' upper='3' effort='100' velocity='9'/><dynamics friction='0.01'/></joint></robot>";
  arm.base = BaseType::FIXED;
  arm.pose = poseAt(0.0, 0.0, 2.0);
  arm.motion.emplace(Eigen::Vector3d(0.0, 0.0, 0.5), Eigen::Vector3d::Zero());
  JointCommand command;
  command.mode = JointCommand::Mode::POSITION;
  command.target = 1.0;
  command.kp = 1e3;
  command.kd = 1.0;
  command.max_effort = max_effort;
  arm.commands["hinge"] = command;
  arm.joints["hinge"] = {0.2, 0.7};
  scene.bodies.push_back(arm);
  return scene;
}

/** Every kind of failure: what it does to a simulator that runs. */
struct Failure
{
  const char* name;
  SolverStatus status;
  std::function<void(Simulator&)> cause;
};

void fake(Simulator& simulator, const FakeSolver::Method& method)
{
  simulator.setSolver(std::make_unique<FakeSolver>(method));
}

std::vector<Failure> failures()
{
  const double nan = std::nan("");
  return {
      {"a solver that throws", SolverStatus::NUMERICAL_FAILURE,
       [](Simulator& simulator)
       { fake(simulator, [](auto&, auto&, auto&) { throw std::runtime_error("out of ideas"); }); }},
      {"not a number", SolverStatus::NUMERICAL_FAILURE,
       [nan](Simulator& simulator)
       { fake(simulator, [nan](auto&, auto&, SolverResult& result) { result.solution.r.setConstant(nan); }); }},
      {"forces of 1e20 N s", SolverStatus::NUMERICAL_FAILURE,
       [](Simulator& simulator)
       { fake(simulator, [](auto&, auto&, SolverResult& result) { result.solution.r.setConstant(1e20); }); }},
      {"no answer within the budget", SolverStatus::MAX_ITERATIONS,
       [](Simulator& simulator)
       {
         fake(simulator,
              [](auto&, auto&, SolverResult& result)
              {
                result.solution.r.setZero();
                result.status = SolverStatus::MAX_ITERATIONS;
                result.message = "sweeps exhausted";
              });
       }},
      {"a claim that the residual does not confirm", SolverStatus::STAGNATED,
       [](Simulator& simulator)
       {
         fake(simulator,
              [](auto&, auto&, SolverResult& result)
              {
                result.solution.r.setZero();
                result.status = SolverStatus::CONVERGED;
              });
       }},
      {"no time", SolverStatus::TIME_LIMIT,
       [](Simulator& simulator)
       {
         FailureOptions options = simulator.scenario().failure;
         options.time_limit = 1e-12;
         simulator.setFailureOptions(options);
       }},
  };
}

/** Runs to the step before the wrench expires, so that the failed step would forget it. */
void runUntilTheWrenchEnds(Simulator& simulator)
{
  for (int i = 0; i < 10; ++i)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  ASSERT_EQ(simulator.state().bodies[0].wrenches.size(), 1u);
}

TEST(FailurePolicyTest, StopAndPauseLeaveStateAndTimeAsTheyWereToTheBit)
{
  for (const FailurePolicy policy : {FailurePolicy::STOP, FailurePolicy::PAUSE})
    for (const Failure& failure : failures())
    {
      SCOPED_TRACE(std::string(toString(policy)) + ", " + failure.name);
      Scenario scene = slidingScene();
      scene.failure.policy = policy;
      scene.failure.fallback = false;
      Simulator simulator(scene);
      runUntilTheWrenchEnds(simulator);
      const std::uint64_t hash = simulator.stateHash();
      const SimulationState before = simulator.state();
      failure.cause(simulator);
      for (int attempt = 0; attempt < 3; ++attempt)
      {
        const StepOutcome& outcome = simulator.step();
        EXPECT_EQ(outcome.status, failure.status) << outcome.message;
        EXPECT_FALSE(outcome.taken);
        EXPECT_FALSE(outcome.message.empty());
        EXPECT_EQ(simulator.stateHash(), hash) << firstDifference(simulator.state(), before);
        EXPECT_EQ(simulator.time(), before.time());
        EXPECT_EQ(simulator.report().step, before.step + 1) << "the report is of the step that was not taken";
        EXPECT_EQ(simulator.report().status, failure.status);
      }
      // The cause gone, it goes on as if nothing had been.
      simulator.setSolver("portfolio");
      simulator.setFailureOptions({});
      Simulator untouched(scene);
      for (int i = 0; i < 10; ++i)
        untouched.step();
      for (int i = 0; i < 20; ++i)
      {
        EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
        untouched.step();
      }
      EXPECT_EQ(simulator.stateHash(), untouched.stateHash());
      EXPECT_TRUE(simulator.state().bodies[0].wrenches.empty());
    }
}

/** The joint rows' memory, the servo's effort, the rising base. */
TEST(FailurePolicyTest, StopLeavesDrivesAndMemoriesOfAMachineAsTheyWere)
{
  Simulator simulator(motorScene());
  for (int i = 0; i < 20; ++i)
    ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  ASSERT_NEAR(std::abs(simulator.effort(0, simulator.model(0).findJoint("hinge"))), 0.5, 1e-12);
  const SimulationState before = simulator.state();
  simulator.setFailureOptions({FailurePolicy::STOP, false, 0.0});
  fake(simulator, [](auto&, auto&, auto&) { throw std::runtime_error("out of ideas"); });
  EXPECT_FALSE(simulator.step().taken);
  EXPECT_EQ(firstDifference(simulator.state(), before), "");
}

/** The kinetic energy that hold takes is booked: the ledger sums up as before the failure, to round-off. */
TEST(FailurePolicyTest, HoldStopsEverythingAndBooksTheEnergyTaken)
{
  for (const Failure& failure : failures())
  {
    SCOPED_TRACE(failure.name);
    Scenario scene = slidingScene();
    scene.failure.policy = FailurePolicy::HOLD;
    scene.failure.fallback = false;
    Simulator simulator(scene);
    runUntilTheWrenchEnds(simulator);
    const SimulationState before = simulator.state();
    const double energy = before.energy.kinetic;
    ASSERT_GT(energy, 0.1);
    failure.cause(simulator);
    const StepOutcome& outcome = simulator.step();
    EXPECT_EQ(outcome.status, failure.status) << outcome.message;
    EXPECT_TRUE(outcome.taken);
    EXPECT_EQ(simulator.state().step, before.step + 1);
    EXPECT_EQ(simulator.time(), before.clock.time(before.dt) + before.dt);
    for (int body = 0; body < 2; ++body)
    {
      EXPECT_EQ(simulator.position(body), before.bodies[body].q);
      EXPECT_EQ(simulator.velocity(body).norm(), 0.0);
    }
    const EnergyLedger& ledger = simulator.report().energy;
    EXPECT_EQ(ledger.kinetic, 0.0);
    EXPECT_NEAR(ledger.impact - before.energy.impact, energy, 1e-15);  // of 1 J: round-off
    EXPECT_NEAR(ledger.balance_error, before.energy.balance_error, 1e-14);  // of sums of some 10 J
    EXPECT_TRUE(simulator.state().bodies[0].wrenches.empty()) << "clocks go on: the wrench is over";
  }
}

TEST(FailurePolicyTest, HoldLetsBasesGoOnAndKeepsServosWithinTheirLimits)
{
  for (const double limit : {0.5, std::numeric_limits<double>::infinity()})
  {
    Scenario scene = motorScene(limit);
    scene.failure = {FailurePolicy::HOLD, false, 0.0};
    Simulator simulator(scene);
    for (int i = 0; i < 5; ++i)
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
    const int hinge = simulator.model(0).findJoint("hinge");
    const double height = simulator.data(0).link_pose.front().translation().z();
    const double balance = simulator.report().energy.balance_error;
    fake(simulator, [](auto&, auto&, auto&) { throw std::runtime_error("out of ideas"); });
    for (int i = 0; i < 10; ++i)
      EXPECT_FALSE(simulator.step().converged());
    // The base, at 0.5 m/s, for 10 ms.
    EXPECT_NEAR(simulator.data(0).link_pose.front().translation().z(), height + 0.005, 1e-12);
    EXPECT_TRUE(std::isfinite(simulator.effort(0, hinge)));
    EXPECT_LE(std::abs(simulator.effort(0, hinge)), std::min(limit, 100.0));
    EXPECT_NEAR(simulator.report().energy.balance_error, balance, 1e-13);  // of the rod's 20 J
  }
}

TEST(FailurePolicyTest, AcceptTakesTheBestIterateWhereItsEnergyCheckHoldsElseHolds)
{
  const auto impulse = [](double factor)
  {
    return [factor](const DelassusProblem& problem, const SolveContext&, SolverResult& result)
    {
      // Normal impulses along the normals at once: factor 1 about stops the fall of gravity, far more throws the
      // bodies.
      for (int i = 0; i < problem.W.blocks(); ++i)
        result.solution.r.segment<3>(problem.W.offset(i)) = Eigen::Vector3d(factor * 0.0025, 0.0, 0.0);
      result.status = SolverStatus::MAX_ITERATIONS;
      result.message = "given up";
    };
  };
  for (const bool holds : {true, false})
  {
    Scenario scene = slidingScene();
    scene.failure = {FailurePolicy::ACCEPT, false, 0.0};
    Simulator simulator(scene);
    runUntilTheWrenchEnds(simulator);
    const double speed = simulator.velocity(0)[0];
    const Eigen::VectorXd q = simulator.position(0);
    fake(simulator, impulse(holds ? 0.5 : 1e4));
    EXPECT_EQ(simulator.step().status, SolverStatus::MAX_ITERATIONS);
    EXPECT_TRUE(simulator.outcome().taken);
    EXPECT_EQ(simulator.solution().r.size() > 0, true);
    if (holds)
    {
      // No friction in that iterate: the box goes on with its speed, and sinks a little faster than it should.
      EXPECT_NEAR(simulator.velocity(0)[0], speed, 1e-12);
      EXPECT_LT(simulator.velocity(0)[2], -1e-4);
    }
    else
    {
      EXPECT_EQ(simulator.velocity(0).norm(), 0.0);
      EXPECT_EQ(simulator.position(0), q);
    }
  }
}

/** A box between two walls that it does not touch, and a method that presses both walls with 1 kN s: within a loose
 *  tolerance of the law row by row, but of impossible energy. */
TEST(FailurePolicyTest, AnAnswerThatCreatesEnergyIsNotConverged)
{
  Scenario scene = groundScene(0.0);
  scene.stopping.tolerance = 1e-3;
  constexpr double GAP = 1e-9;  // u_N = gap/dt = 1e-6 m/s, less than 1e-3 of g dt
  addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.1));
  for (const double side : {-1.0, 1.0})
  {
    BodySpec& wall = addBody(scene, side < 0.0 ? "left" : "right", boxUrdf({0.2, 0.2, 0.2}, 1.0),
                             poseAt(side * (0.2 + GAP), 0.0, 0.1));
    wall.base = BaseType::FIXED;
  }
  scene.failure = {FailurePolicy::STOP, false, 0.0};
  Simulator simulator(scene);
  ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  fake(simulator,
       [](const DelassusProblem& problem, const SolveContext&, SolverResult& result)
       {
         const SolverResult honest = createSolver("portfolio")->solve(problem);
         result.solution.r = honest.solution.r;
         for (int i = 0; i < problem.W.blocks(); ++i)
           if (const int row = problem.W.offset(i); problem.q[row] > 1e-7 && problem.q[row] < 1e-5)
             result.solution.r[row] += 1e3;
         result.status = SolverStatus::CONVERGED;
       });
  const std::uint64_t hash = simulator.stateHash();
  const StepOutcome& outcome = simulator.step();
  EXPECT_EQ(outcome.status, SolverStatus::STAGNATED);
  EXPECT_LE(outcome.residual, 1e-3) << "the residual does not see it";
  EXPECT_THAT(outcome.message, HasSubstr("creates energy"));
  EXPECT_THAT(outcome.message, HasSubstr("expected at most"));
  EXPECT_EQ(simulator.stateHash(), hash);
  simulator.setFailurePolicy(FailurePolicy::ACCEPT);
  simulator.step();
  EXPECT_EQ(simulator.velocity(0).norm(), 0.0) << "accept falls back to hold";
  // With fallback another method's answer is taken.
  simulator.setFailureOptions({FailurePolicy::STOP, true, 0.0});
  EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
}

TEST(FailurePolicyTest, FallbackNamesWhoAnsweredAndAllThatWereTried)
{
  Scenario scene = slidingScene();
  Simulator simulator(scene);
  Simulator untouched(scene);
  runUntilTheWrenchEnds(simulator);
  runUntilTheWrenchEnds(untouched);
  fake(simulator, [](auto&, auto&, auto&) { throw std::runtime_error("out of ideas"); });
  EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  untouched.step();
  EXPECT_NE(simulator.report().solver, "fake");
  EXPECT_NO_THROW(createSolver(simulator.report().solver)) << simulator.report().solver;
  EXPECT_EQ(simulator.report().solvers_tried.rfind("fake,", 0), 0u) << simulator.report().solvers_tried;
  EXPECT_THAT(simulator.report().solvers_tried, HasSubstr(simulator.report().solver));
  // The same step, within the solver's tolerance of 1e-10 of g dt and m/s.
  EXPECT_LT((simulator.velocity(0) - untouched.velocity(0)).norm(), 1e-9);
  EXPECT_LT((simulator.velocity(1) - untouched.velocity(1)).norm(), 1e-9);
}

TEST(FailurePolicyTest, FallbackIsNotTriedWhereItIsSwitchedOff)
{
  Scenario scene = slidingScene();
  scene.failure.fallback = false;
  Simulator simulator(scene);
  fake(simulator, [](auto&, auto&, auto&) { throw std::runtime_error("out of ideas"); });
  EXPECT_EQ(simulator.step().message, "out of ideas");
  EXPECT_EQ(simulator.report().solvers_tried, "fake");
}

TEST(FailurePolicyTest, ASignalEndsASolveWithoutFallbackDumpOrStep)
{
  const fs::path folder = fs::temp_directory_path() / ("failure_policy_test_" + std::to_string(getpid()));
  fs::create_directories(folder);
  for (const FailurePolicy policy : {FailurePolicy::STOP, FailurePolicy::HOLD, FailurePolicy::ACCEPT})
  {
    Scenario scene = slidingScene();
    scene.failure.policy = policy;
    Simulator simulator(scene);
    simulator.setDumpFolder(folder.string());
    runUntilTheWrenchEnds(simulator);
    std::atomic<bool> stop{false};
    simulator.setStop(&stop);
    const std::uint64_t hash = simulator.stateHash();
    // The signal comes during the solve; the method sees it where it would see a time limit.
    fake(simulator,
         [&stop](const DelassusProblem&, const SolveContext& context, SolverResult& result)
         {
           EXPECT_FALSE(context.timeIsUp());
           stop = true;
           EXPECT_TRUE(context.timeIsUp());
           result.solution.r.setZero();
           result.status = SolverStatus::TIME_LIMIT;
         });
    EXPECT_EQ(simulator.step().status, SolverStatus::STOPPED_BY_USER);
    EXPECT_FALSE(simulator.outcome().taken);
    EXPECT_EQ(simulator.stateHash(), hash);
    EXPECT_EQ(simulator.report().solvers_tried, "fake");
    EXPECT_TRUE(fs::is_empty(folder));
    simulator.setStop(nullptr);
    simulator.setSolver("portfolio");
    EXPECT_TRUE(simulator.step().converged());
  }
  fs::remove_all(folder);
}

/** A box thrown at the ground that it stands on: an impact at the start, given up at once. */
Scenario failedStart(FailurePolicy policy)
{
  Scenario scene = groundScene(0.5);
  scene.stopping.max_iterations = 0;
  addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.1)).linear_velocity = {0.3, 0.0, -1.0};
  scene.failure.policy = policy;
  return scene;
}

TEST(FailurePolicyTest, AFailedImpactAtTheStartLeavesWhatThePolicySays)
{
  for (const FailurePolicy policy : {FailurePolicy::STOP, FailurePolicy::PAUSE})
  {
    Simulator simulator(failedStart(policy));
    EXPECT_FALSE(simulator.outcome().converged());
    EXPECT_FALSE(simulator.outcome().taken);
    EXPECT_EQ(simulator.velocity(0)[2], -1.0) << "as given";
    EXPECT_NEAR(simulator.state().energy_start, 0.5 * 1.09 + 9.81 * 0.1, 1e-15);
  }
  Simulator held(failedStart(FailurePolicy::HOLD));
  EXPECT_FALSE(held.outcome().converged());
  EXPECT_EQ(held.velocity(0).norm(), 0.0);
  EXPECT_NEAR(held.state().energy.impact, 0.5 * 1.09, 1e-15);
}

TEST(FailurePolicyTest, AStateFromOutsideThatFailsGoesBackToTheLastGoodOne)
{
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (const FailurePolicy policy :
         {FailurePolicy::STOP, FailurePolicy::PAUSE, FailurePolicy::HOLD, FailurePolicy::ACCEPT})
    {
      Scenario scene = slidingScene();
      scene.failure.policy = policy;
      Simulator simulator(scene);
      runUntilTheWrenchEnds(simulator);
      const SimulationState before = simulator.state();
      simulator.position(1)[2] = bad;
      simulator.velocity(0)[0] = 3.0;
      EXPECT_EQ(simulator.stateChanged().status, SolverStatus::NUMERICAL_FAILURE);
      EXPECT_THAT(simulator.outcome().message, HasSubstr("ball"));
      EXPECT_EQ(firstDifference(simulator.state(), before), "");
      EXPECT_TRUE(simulator.step().converged());
    }
  // Finite, but its impact is not solved: back as well, under stop.
  Simulator simulator(slidingScene());
  runUntilTheWrenchEnds(simulator);
  const SimulationState before = simulator.state();
  simulator.setFailureOptions({FailurePolicy::STOP, false, 0.0});
  fake(simulator, [](auto&, auto&, auto&) { throw std::runtime_error("out of ideas"); });
  simulator.velocity(0)[2] = -1.0;
  EXPECT_EQ(simulator.stateChanged().status, SolverStatus::NUMERICAL_FAILURE);
  EXPECT_EQ(firstDifference(simulator.state(), before), "");
}

TEST(FailurePolicyTest, ScenarioFilesSayThePolicy)
{
  const std::string body = "bodies: [{name: block, urdf: " + std::string(PROJECT_DIR) + "/urdf/block.urdf}]\n";
  const std::string file = std::string(PROJECT_DIR) + "/scene.yaml";
  const FailureOptions defaults = loadScenario(body, file).failure;
  EXPECT_EQ(defaults.policy, FailurePolicy::STOP);
  EXPECT_TRUE(defaults.fallback);
  EXPECT_EQ(defaults.time_limit, 0.0);
  for (const FailurePolicy policy :
       {FailurePolicy::STOP, FailurePolicy::PAUSE, FailurePolicy::HOLD, FailurePolicy::ACCEPT})
  {
    const std::string lines =
        "failure: {policy: " + std::string(toString(policy)) + ", fallback: false, time_limit: 0.25}\n";
    const Scenario scenario = loadScenario(lines + body, file);
    EXPECT_EQ(scenario.failure.policy, policy);
    EXPECT_FALSE(scenario.failure.fallback);
    EXPECT_EQ(scenario.failure.time_limit, 0.25);
    EXPECT_EQ(Simulator(scenario).failurePolicy(), policy);
  }
}
}  // namespace
}  // namespace frictional_contact_sim
