// Commands over time: interpolation, what a joint does under them, state and reset, and mistakes by line.
#include "frictional_contact_sim/dynamics/command_schedule.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_archive.h"
#include "frictional_contact_sim/simulation/state_file.h"
#include "scene.h"
#include "support/dice.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::Dice;

constexpr double MASS = 2.0;

Scenario sliderScene()
{
  return railScene(10.0, 100.0);
}

Scenario scheduled(JointCommand::Mode mode, const CommandSchedule& schedule)
{
  Scenario scene = sliderScene();
  JointCommand command;
  command.mode = mode;
  command.target = schedule.targets.front();
  scene.bodies[0].commands["rail"] = command;
  scene.bodies[0].schedules["rail"] = schedule;
  return scene;
}

double integral(const CommandSchedule& schedule, double until, int pieces)
{
  double sum = 0.0;
  for (int k = 0; k < pieces; ++k)
    sum += schedule.target((k + 0.5) * until / pieces) * until / pieces;
  return sum;
}

std::string complaint(const std::string& command)
{
  const std::string text = "bodies:\n  - name: arm\n    urdf: " + std::string(PROJECT_DIR) +
                           "/urdf/double_pendulum.urdf\n    commands:\n      hip: " + command + "\n";
  try
  {
    loadScenario(text, "scene.yaml");
  }
  catch (const ScenarioError& error)
  {
    return error.what();
  }
  return "accepted";
}
}  // namespace

TEST(CommandScheduleTest, IsStraightBetweenTheTimesAndStaysOutside)
{
  Dice dice(21);
  for (int k = 0; k < 100; ++k)
  {
    CommandSchedule schedule;
    for (int i = dice.integer(1, 6); i > 0; --i)
    {
      schedule.times.push_back((schedule.times.empty() ? -1.0 : schedule.times.back()) + dice.uniform(0.01, 1.0));
      schedule.targets.push_back(dice.uniform(-2.0, 2.0));
    }
    schedule.validate();
    EXPECT_EQ(schedule.target(schedule.times.front() - 1.0), schedule.targets.front());
    EXPECT_EQ(schedule.target(schedule.times.back() + 1.0), schedule.targets.back());
    EXPECT_EQ(schedule.rate(schedule.times.back() + 1.0), 0.0);
    for (size_t i = 0; i < schedule.times.size(); ++i)
      EXPECT_DOUBLE_EQ(schedule.target(schedule.times[i]), schedule.targets[i]);
    for (size_t i = 1; i < schedule.times.size(); ++i)
    {
      const double middle = 0.5 * (schedule.times[i - 1] + schedule.times[i]);
      EXPECT_NEAR(schedule.target(middle), 0.5 * (schedule.targets[i - 1] + schedule.targets[i]), 1e-14);
      EXPECT_NEAR(schedule.target(middle + 1e-3 * (schedule.times[i] - middle)) - schedule.target(middle),
                  1e-3 * (schedule.times[i] - middle) * schedule.rate(middle), 1e-13);
    }
  }
  EXPECT_THROW((CommandSchedule{{0.0, 0.0}, {1.0, 2.0}}.validate()), std::invalid_argument);
  EXPECT_THROW((CommandSchedule{{0.0}, {1.0, 2.0}}.validate()), std::invalid_argument);
  EXPECT_THROW((CommandSchedule{{0.0}, {std::nan("")}}.validate()), std::invalid_argument);
}

TEST(CommandScheduleTest, EffortsGiveTheirImpulse)
{
  // Breaks at whole steps: the midpoint rule is exact on straight lines, so m v is the integral of the effort.
  const CommandSchedule schedule{{0.1, 0.3, 0.5}, {4.0, -2.0, 6.0}};
  Simulator simulator(scheduled(JointCommand::Mode::EFFORT, schedule));
  for (int step = 1; step <= 700; ++step)
  {
    ASSERT_TRUE(simulator.step().converged());
    if (step % 100 == 0)
    {
      EXPECT_NEAR(MASS * simulator.velocity(0)[0], integral(schedule, 0.001 * step, step), 1e-12) << step;
      EXPECT_NEAR(simulator.effort(0, simulator.model(0).findJoint("rail")), schedule.target(0.001 * (step - 0.5)),
                  1e-12);
    }
  }
}

TEST(CommandScheduleTest, AnEffortBeyondTheLimitIsCut)
{
  Scenario scene = scheduled(JointCommand::Mode::EFFORT, {{0.0, 1.0}, {0.0, 10.0}});
  scene.bodies[0].commands["rail"].max_effort = 3.0;
  Simulator simulator(scene);
  const int rail = simulator.model(0).findJoint("rail");
  for (int step = 1; step <= 1000; ++step)
  {
    simulator.step();
    ASSERT_NEAR(simulator.effort(0, rail), std::min(3.0, 0.01 * (step - 0.5)), 1e-12);
  }
}

TEST(CommandScheduleTest, PositionsAreFollowed)
{
  const CommandSchedule schedule{{0.0, 1.0, 1.5, 2.5}, {0.0, 0.5, 0.5, -0.3}};
  Simulator simulator(scheduled(JointCommand::Mode::POSITION, schedule));
  for (int step = 1; step <= 3500; ++step)
  {
    ASSERT_TRUE(simulator.step().converged());
    const double time = 0.001 * step;
    // A critically damped servo of w = 40 rad/s answers a change of speed dv by an error dv t exp(-w t), at most
    // dv/(e w), gone after 0.4 s; on a ramp none stays, since the damper knows the target's speed.
    EXPECT_NEAR(simulator.position(0)[0], schedule.target(time), 1.05 * 0.8 / (std::exp(1.0) * 40.0)) << time;
    const bool settled = (time > 0.5 && time <= 1.0) || (time > 1.9 + 0.1 && time <= 2.5) || time > 3.0;
    if (settled)
    {
      EXPECT_NEAR(simulator.position(0)[0], schedule.target(time), 1e-6) << time;
    }
  }
}

TEST(CommandScheduleTest, VelocitiesAreFollowed)
{
  const CommandSchedule schedule{{0.0, 1.0}, {0.0, 0.5}};
  Simulator simulator(scheduled(JointCommand::Mode::VELOCITY, schedule));
  for (int step = 1; step <= 2000; ++step)
    ASSERT_TRUE(simulator.step().converged());
  EXPECT_NEAR(simulator.velocity(0)[0], 0.5, 1e-12);
}

TEST(CommandScheduleTest, ResetSaveAndLoadGoOnToTheBit)
{
  const Scenario scene = scheduled(JointCommand::Mode::POSITION, {{0.05, 0.15, 0.4}, {0.1, 0.5, -0.2}});
  const std::string path = testing::TempDir() + "command_schedule_state";
  Simulator whole(scene);
  std::vector<std::uint64_t> hashes;
  for (int step = 0; step < 300; ++step)
  {
    if (step == 120)
      saveState(whole, path);
    whole.step();
    hashes.push_back(whole.stateHash());
  }
  Simulator half(scene);
  loadState(half, path);
  for (int step = 120; step < 300; ++step)
  {
    half.step();
    ASSERT_EQ(half.stateHash(), hashes[static_cast<size_t>(step)]) << step;
  }
  const double end = whole.position(0)[0];
  whole.reset();
  for (int step = 0; step < 300; ++step)
    whole.step();
  EXPECT_EQ(whole.position(0)[0], end);
  Simulator other(sliderScene());
  EXPECT_THROW(loadState(other, path), StateError);
}

TEST(CommandScheduleTest, AnotherCommandEndsIt)
{
  Simulator simulator(scheduled(JointCommand::Mode::EFFORT, {{0.0, 1.0}, {1.0, 2.0}}));
  const int rail = simulator.model(0).findJoint("rail");
  simulator.step();
  JointCommand command;
  command.target = -5.0;
  simulator.setCommand(0, rail, command);
  simulator.step();
  EXPECT_EQ(simulator.effort(0, rail), -5.0);
  simulator.reset();
  simulator.step();
  EXPECT_NEAR(simulator.effort(0, rail), 1.0005, 1e-12);
}

TEST(CommandScheduleTest, IsReadFromAScenario)
{
  const std::string text =
      "bodies:\n  - name: arm\n    urdf: " + std::string(PROJECT_DIR) +
      "/urdf/double_pendulum.urdf\n    commands:\n      hip: {times: [0, 1, 2], positions: [0, 0.5, 0.1], kp: "
      "80}\n      knee: {times: [0, 1], efforts: [1, 2]}\n";
  const BodySpec body = loadScenario(text, "scene.yaml").bodies.at(0);
  EXPECT_EQ(body.commands.at("hip").mode, JointCommand::Mode::POSITION);
  EXPECT_EQ(body.commands.at("hip").kp, 80.0);
  EXPECT_EQ(body.schedules.at("hip").times, (std::vector<double>{0.0, 1.0, 2.0}));
  EXPECT_EQ(body.schedules.at("hip").targets, (std::vector<double>{0.0, 0.5, 0.1}));
  EXPECT_EQ(body.commands.at("knee").mode, JointCommand::Mode::EFFORT);
}

TEST(CommandScheduleTest, MistakesAreNamedByLine)
{
  const std::string place = "scene.yaml:5: key 'bodies[0].commands.hip";
  EXPECT_EQ(complaint("{times: [0, 1], positions: [0, 1]}"), "accepted");
  EXPECT_EQ(complaint("{times: [0, 1], positions: [0, 1, 2]}"),
            place + ".positions': found a list of 3, expected as many entries as times, 2");
  EXPECT_EQ(complaint("{times: [0, 1, 1], positions: [0, 1, 2]}"),
            place + ".times[2]': found '1', expected more than the time before, 1");
  EXPECT_EQ(complaint("{positions: [0, 1]}"), place + ".times': found nothing, expected at least one time [s]");
  EXPECT_EQ(complaint("{times: [], positions: []}"),
            place + ".times': found a list of 0, expected at least one time [s]");
  EXPECT_EQ(complaint("{times: [0, 1], position: 1}"),
            place + ".times': found a list of 2, expected none without efforts, positions or velocities");
  EXPECT_EQ(complaint("{times: [0, .nan], efforts: [0, 1]}"),
            place + ".times[1]': found '.nan', expected a finite number");
  EXPECT_EQ(complaint("{position: 1, rate: 2, feedforward: 3}"), "accepted");
  EXPECT_EQ(complaint("{velocity: 1, rate: 2}"), place + ".rate': found '2', expected none without position");
  EXPECT_EQ(complaint("{effort: 1, feedforward: 2}"),
            place + ".feedforward': found '2', expected none beside an effort");
  EXPECT_NE(complaint("{times: [0], positions: [0], efforts: [1]}").find("exactly one of"), std::string::npos);
  EXPECT_NE(complaint("{times: [0], postions: [0]}").find("did you mean 'positions'?"), std::string::npos);
}

}  // namespace frictional_contact_sim
