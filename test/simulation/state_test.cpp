// State as one value: save and load, reset, clocks, many simulations of one world.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <thread>

#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_archive.h"
#include "frictional_contact_sim/simulation/state_file.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
const char* const SCENARIOS[] = {"quadruped", "grasp", "rolling_wheel", "bouncing_ball", "resting_box"};

Scenario shipped(const std::string& name)
{
  return loadScenarioFile(std::string(PROJECT_DIR) + "/config/scenarios/" + name + ".yaml");
}

void run(Simulator& simulator, int steps)
{
  for (int i = 0; i < steps; ++i)
    simulator.step();
}

/** Random commands and pushes, the same for the same seed. */
void disturb(Simulator& simulator, std::mt19937& random)
{
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const MultibodyModel& tree = simulator.model(body);
    for (int joint = 0; joint < static_cast<int>(tree.joints.size()); ++joint)
    {
      if (velocitySize(tree.joints[joint].type) != 1 || tree.joints[joint].mimic.joint >= 0 || number(random) < 0.0)
        continue;
      JointCommand command;
      command.mode = number(random) < 0.0 ? JointCommand::Mode::POSITION : JointCommand::Mode::EFFORT;
      command.target = number(random);
      simulator.setCommand(body, joint, command);
    }
    ExternalWrench push;
    push.link = tree.frames.front().name;
    push.force = 5.0 * Eigen::Vector3d(number(random), number(random), number(random));
    push.from = simulator.time();
    push.until = push.from + 0.05 * std::abs(number(random));
    simulator.addWrench(body, push);
  }
}

class StateFileTest : public testing::Test
{
protected:
  StateFileTest()
    : path_((std::filesystem::temp_directory_path() / ("state_test_" + std::to_string(getpid()))).string())
  {
  }
  ~StateFileTest() override { std::filesystem::remove(path_); }
  std::string read() const
  {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  std::string path_;
};

TEST_F(StateFileTest, SavedAndLoadedGoesOnWithTheSameBits)
{
  for (const char* name : SCENARIOS)
    for (const unsigned seed : {1u, 2u})
    {
      std::mt19937 random(seed);
      Simulator whole(shipped(name));
      run(whole, 37);
      disturb(whole, random);
      run(whole, 150);
      saveState(whole, path_);
      run(whole, 200);

      Simulator second(shipped(name));
      run(second, 11);  // whatever it did before
      loadState(second, path_);
      run(second, 200);
      EXPECT_EQ(firstDifference(whole.state(), second.state()), "") << name;
      EXPECT_EQ(whole.stateHash(), second.stateHash()) << name;
      EXPECT_EQ(whole.time(), second.time());
    }
}

TEST_F(StateFileTest, WhatWasSetWhileItRanComesAlong)
{
  for (const char* name : SCENARIOS)
    for (const unsigned seed : {1u, 2u, 3u})
    {
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> share(0.5, 1.0);
      Simulator whole(shipped(name));
      run(whole, 37);
      StoppingOptions stopping = whole.scenario().stopping;
      stopping.tolerance *= share(random);
      whole.setTimeStep(whole.scenario().time_step * share(random));
      whole.setGravity(whole.scenario().gravity * share(random));
      whole.setDefaultFriction(share(random));
      whole.setFriction(whole.bodyName(0), whole.bodyName(0), share(random));
      whole.setSolver("ac_newton");
      whole.setStopping(stopping);
      run(whole, 100);
      saveState(whole, path_);
      run(whole, 100);

      Simulator second(shipped(name));
      loadState(second, path_);
      run(second, 100);
      EXPECT_EQ(firstDifference(whole.state(), second.state()), "") << name;
      EXPECT_EQ(second.scenario().solver, "ac_newton");
      EXPECT_EQ(second.scenario().stopping.tolerance, stopping.tolerance);
      EXPECT_EQ(second.scenario().gravity, whole.scenario().gravity);

      // What the saved run had from its scenario stays as it is in this one.
      Simulator plain(shipped(name));
      saveState(plain, path_);
      const Eigen::Vector3d gravity = second.scenario().gravity;
      loadState(second, path_);
      EXPECT_EQ(second.scenario().gravity, gravity);
    }
}

TEST_F(StateFileTest, SettingsThatCannotBeTakenChangeNothing)
{
  Simulator simulator(shipped("grasp"));
  run(simulator, 20);
  const SimulationState state = simulator.state();
  const std::uint64_t before = simulator.stateHash();
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<RunSettings> all(6);
  all[0].time_step = -1.0;
  all[1].gravity = Eigen::Vector3d(0.0, infinite, 0.0);
  all[2].solver = "newton";
  all[3].tolerance = 0.0;
  all[4].default_friction = -1.0;
  all[5].friction = {{{"", simulator.bodyName(0), ""}, {"ground", "", ""}, -0.1, std::nullopt}};
  for (RunSettings& settings : all)
  {
    if (!settings.time_step)
      settings.time_step = 0.5 * simulator.scenario().time_step;
    EXPECT_THROW(simulator.setState(state, settings), std::invalid_argument);
    EXPECT_EQ(simulator.stateHash(), before);
    EXPECT_EQ(simulator.scenario().time_step, state.dt);
    EXPECT_FALSE(simulator.settings().time_step);
  }
}

TEST_F(StateFileTest, AnyCutOrChangedFileIsOneClearLineAndChangesNothing)
{
  Simulator simulator(shipped("grasp"));
  run(simulator, 300);
  saveState(simulator, path_);
  const std::string whole = read();
  run(simulator, 5);
  const std::uint64_t before = simulator.stateHash();
  const auto refused = [&](const std::string& bytes)
  {
    write(bytes);
    try
    {
      loadState(simulator, path_);
      ADD_FAILURE() << "a wrong file was taken";
    }
    catch (const StateError& error)
    {
      const std::string line = error.what();
      EXPECT_EQ(line.find(path_ + ": "), 0u) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos);
    }
    EXPECT_EQ(simulator.stateHash(), before);
  };
  std::mt19937 random(3);
  for (int draw = 0; draw < 60; ++draw)
    refused(whole.substr(0, random() % whole.size()));
  for (int draw = 0; draw < 200; ++draw)
  {
    std::string changed = whole;
    changed[random() % changed.size()] ^= static_cast<char>(1 + random() % 255);
    refused(changed);
  }
  refused(whole + "x");
  refused("");
  write(whole);
  EXPECT_TRUE(loadState(simulator, path_).converged());
  EXPECT_NE(simulator.stateHash(), before);
}

TEST_F(StateFileTest, AnotherRobotsStateIsRefusedByName)
{
  Simulator box(shipped("resting_box"));
  saveState(box, path_);
  Simulator ball(shipped("bouncing_ball"));
  EXPECT_THAT([&] { loadState(ball, path_); },
              testing::ThrowsMessage<StateError>(testing::HasSubstr("name of body 0 is 'box', expected 'ball'")));
}

TEST_F(StateFileTest, ResetRepeatsTheRunWhateverWasCommandedBefore)
{
  for (const char* name : SCENARIOS)
  {
    Simulator simulator(shipped(name));
    std::vector<std::uint64_t> first;
    for (int i = 0; i < 150; ++i)
    {
      simulator.step();
      SimulationState state = simulator.state();
      state.step = 0;
      state.clock = StepClock{};
      first.push_back(hashOf(state));
    }
    std::mt19937 random(7);
    disturb(simulator, random);
    run(simulator, 90);
    const double time = simulator.time();
    EXPECT_TRUE(simulator.reset().converged());
    EXPECT_EQ(simulator.time(), time) << "stamps go on";
    for (int i = 0; i < 150; ++i)
    {
      simulator.step();
      SimulationState state = simulator.state();
      state.step = 0;
      state.clock = StepClock{};
      ASSERT_EQ(hashOf(state), first[i]) << name << " step " << i;
    }
  }
}

TEST(ClockTest, TimeIsStartPlusStepsTimesDt)
{
  Scenario scene = groundScene(0.5);
  addBody(scene, "ball", sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 0.1));
  scene.time_step = 0.001;
  Simulator simulator(scene);
  run(simulator, 10000);
  EXPECT_EQ(simulator.time(), 10000 * 0.001);
  simulator.setTimeStep(0.0003);
  EXPECT_EQ(simulator.time(), 10000 * 0.001);
  run(simulator, 1000);
  EXPECT_EQ(simulator.time(), 10000 * 0.001 + 1000 * 0.0003);
  EXPECT_EQ(simulator.report().dt, 0.0003);
  simulator.resetTime();
  EXPECT_EQ(simulator.time(), 0.0);
  EXPECT_THROW(simulator.setTimeStep(-1.0), std::invalid_argument);
}

/** Wrench windows are on the scenario's clock: the push comes again after a reset, and not after a reset of time. */
TEST(ClockTest, WrenchWindowsSeeStepsSinceReset)
{
  Scenario scene = groundScene(0.0);
  scene.gravity.setZero();
  scene.ground.reset();
  BodySpec& ball = addBody(scene, "ball", sphereUrdf(0.1, 1.0), poseAt(0.0, 0.0, 1.0));
  ExternalWrench push;
  push.link = "body";
  push.force = Eigen::Vector3d(3.0, 0.0, 0.0);
  push.from = 0.01;
  push.until = 0.03;
  ball.wrenches.push_back(push);
  Simulator simulator(scene);
  for (int round = 0; round < 2; ++round)
  {
    run(simulator, 100);
    EXPECT_NEAR(simulator.velocity(0)[0], 3.0 * 0.02, 1e-14);
    simulator.resetTime();
    run(simulator, 100);
    EXPECT_NEAR(simulator.velocity(0)[0], 3.0 * 0.02, 1e-14);
    EXPECT_TRUE(simulator.state().bodies[0].wrenches.empty()) << "expired wrenches are removed";
    simulator.reset();
    EXPECT_EQ(simulator.state().bodies[0].wrenches.size(), 1u);
  }
}

TEST(StateTest, ASetStateIsThatStateAndAForeignOneIsRefused)
{
  Simulator simulator(shipped("quadruped"));
  run(simulator, 100);
  const SimulationState state = simulator.state();
  run(simulator, 100);
  const std::uint64_t end = simulator.stateHash();
  EXPECT_TRUE(simulator.setState(state).converged());
  EXPECT_EQ(firstDifference(simulator.state(), state), "");
  EXPECT_EQ(simulator.report().time, state.time());
  run(simulator, 100);
  EXPECT_EQ(simulator.stateHash(), end);

  Simulator other(shipped("resting_box"));
  const std::uint64_t before = other.stateHash();
  EXPECT_THROW(other.setState(state), StateError);
  EXPECT_EQ(other.stateHash(), before);
}

TEST(StateTest, EveryEntryCountsInTheHash)
{
  Simulator simulator(shipped("grasp"));
  run(simulator, 300);
  const SimulationState state = simulator.state();
  SimulationState changed = state;
  changed.bodies.back().base_pose.translation().x() = 1e-300;
  EXPECT_NE(hashOf(changed), hashOf(state));
  EXPECT_THAT(firstDifference(changed, state), testing::HasSubstr("base_pose"));
  changed = state;
  changed.rows.memory.back().impulses.back() += 1e-12;
  EXPECT_NE(hashOf(changed), hashOf(state));
  changed = state;
  ASSERT_FALSE(changed.rows.contacts.empty());
  changed.rows.contacts[0].tangent_1.x() += 1e-16;
  EXPECT_NE(hashOf(changed), hashOf(state));
}

/** Eight simulations of one world, two at a time: the bits of one after the other. */
TEST(ManySimulationsTest, TwoThreadsOfOneWorldGiveTheSameBits)
{
  for (const char* name : SCENARIOS)
  {
    const std::shared_ptr<const WorldModel> world = loadWorldModel(shipped(name));
    const auto simulate = [&](unsigned seed)
    {
      std::mt19937 random(seed);
      Simulator simulator(world);
      run(simulator, 20);
      disturb(simulator, random);
      run(simulator, 100);
      return simulator.stateHash();
    };
    std::uint64_t apart[8];
    std::uint64_t together[8];
    for (unsigned i = 0; i < 8; ++i)
      apart[i] = simulate(i);
    std::thread other(
        [&]
        {
          for (unsigned i = 1; i < 8; i += 2)
            together[i] = simulate(i);
        });
    for (unsigned i = 0; i < 8; i += 2)
      together[i] = simulate(i);
    other.join();
    for (unsigned i = 0; i < 8; ++i)
      EXPECT_EQ(apart[i], together[i]) << name << " " << i;
    EXPECT_NE(apart[0], apart[1]);
  }
}
}  // namespace
}  // namespace frictional_contact_sim
