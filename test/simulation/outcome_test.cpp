// What a step, a reset and a set say when they fail: no exception, no silence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_archive.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
namespace fs = std::filesystem;

/** A box thrown at the ground it stands on; the solver may do nothing. */
Scenario hopelessScene()
{
  Scenario scene = groundScene(0.5);
  scene.stopping.max_iterations = 0;
  addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.1)).linear_velocity = {0.3, 0.0, -1.0};
  return scene;
}

TEST(StepOutcomeTest, AFailedImpactAtTheStartIsSeenAndDumped)
{
  const fs::path folder = fs::temp_directory_path() / ("outcome_test_" + std::to_string(getpid()));
  fs::create_directories(folder);
  Simulator simulator(hopelessScene());
  EXPECT_EQ(simulator.outcome().status, SolverStatus::MAX_ITERATIONS);
  EXPECT_FALSE(simulator.outcome().message.empty());
  simulator.setDumpFolder(folder.string());
  ASSERT_TRUE(fs::exists(simulator.outcome().fclib_file)) << simulator.outcome().fclib_file;
  EXPECT_GT(readFclib(simulator.outcome().fclib_file).global.rows(), 0);
  EXPECT_FALSE(simulator.reset().converged()) << "a reset goes back to the same failed start, and says so";
  simulator.velocity(0)[2] = -2.0;
  EXPECT_FALSE(simulator.stateChanged().converged());

  // Another simulator with the same name and folder writes beside it.
  Simulator twin(hopelessScene());
  twin.setDumpFolder(folder.string());
  EXPECT_TRUE(fs::exists(twin.outcome().fclib_file));
  EXPECT_NE(twin.outcome().fclib_file, simulator.outcome().fclib_file);
  fs::remove_all(folder);
}

TEST(StepOutcomeTest, DumpsOfARunEndAtTheirNumber)
{
  const fs::path folder = fs::temp_directory_path() / ("outcome_test_many_" + std::to_string(getpid()));
  fs::create_directories(folder);
  Scenario scene = hopelessScene();
  scene.failure.policy = FailurePolicy::HOLD;  // under stop the same step fails again, into the same file
  Simulator simulator(scene);
  simulator.setDumpFolder(folder.string(), 3);
  for (int i = 0; i < 10; ++i)
    simulator.step();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 3);
  EXPECT_EQ(simulator.outcome().fclib_file, "");
  fs::remove_all(folder);
}

/**
 * Two massless gimbal links and a rotor: at the angle 0 of the second joint, the first moves no inertia. Loading gives
 * it some; it is taken away again.
 */
std::shared_ptr<const WorldModel> gimbalWorld()
{
  const std::string massless =
      "<inertial><mass value='0'/><inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial>";
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child,
                        const std::string& axis, const std::string& limit)
  {
    return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child +
           "'/><axis xyz='" + axis + "'/><limit lower='" + limit + "' upper='3' effort='9' velocity='9'/></joint>";
  };
  Scenario scene = groundScene(0.5);
  scene.ground.reset();
  scene.gravity.setZero();
  BodySpec body;
  body.name = "gimbal";
  // The rotor turns about its own z only; with the second joint at 0 that axis is the first joint's.
  body.urdf_xml = "<robot name='gimbal'><link name='world'/><link name='l1'>" + massless + "</link><link name='l2'>" +
                  massless +
                  "</link><link name='l3'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' "
                  "iyz='0' izz='0.01'/></inertial></link>" +
                  joint("j1", "world", "l1", "0 0 1", "-3") + joint("j2", "l1", "l2", "0 1 0", "0") +
                  joint("j3", "l2", "l3", "0 0 1", "-3") + "</robot>";
  body.joints["j2"] = {0.5, -1.0};
  scene.bodies.push_back(body);
  auto world = std::make_shared<WorldModel>(*loadWorldModel(scene));
  world->bodies[0].tree.armature.setZero();
  return world;
}

TEST(StepOutcomeTest, AMassMatrixThatBecomesSingularOnTheWayIsAFailedStepAndNoException)
{
  for (const FailurePolicy policy : {FailurePolicy::HOLD, FailurePolicy::ACCEPT, FailurePolicy::STOP})
  {
    Simulator simulator(gimbalWorld());
    simulator.setFailurePolicy(policy);
    int failed = 0;
    for (int i = 0; i < 1500; ++i)
    {
      const StepOutcome* outcome = nullptr;
      ASSERT_NO_THROW(outcome = &simulator.step());
      if (!outcome->converged())
      {
        ++failed;
        EXPECT_FALSE(outcome->message.empty());
        EXPECT_EQ(simulator.report().status, outcome->status);
      }
      ASSERT_TRUE(simulator.position(0).allFinite() && simulator.velocity(0).allFinite());
    }
    EXPECT_GT(failed, 0) << "the scene is meant to pass the singular angle";
  }
}

/** The first simulation's state is whole after every failure: it can be saved, set and gone on from. */
TEST(StepOutcomeTest, AfterAFailureTheSimulatorStillWorks)
{
  Simulator simulator(gimbalWorld());
  const SimulationState start = simulator.state();
  for (int i = 0; i < 1500; ++i)
    simulator.step();
  simulator.setState(start);
  EXPECT_TRUE(simulator.step().converged());
}

/** An impact at the singular angle: an outcome, and the next steps are steps again, with gravity. */
TEST(StepOutcomeTest, ASetStateWithASingularMassMatrixIsAFailedOutcomeAndLaterStepsAreWhole)
{
  Simulator simulator(gimbalWorld());
  const SimulationState start = simulator.state();
  const int j2 = simulator.model(0).joints[simulator.model(0).findJoint("j2")].v_index;
  simulator.position(0)[j2] = 0.0;
  simulator.velocity(0)[j2] = -1.0;
  const StepOutcome* outcome = nullptr;
  ASSERT_NO_THROW(outcome = &simulator.stateChanged());
  EXPECT_FALSE(outcome->converged());
  EXPECT_FALSE(outcome->message.empty());
  simulator.setState(start);
  Simulator fresh(gimbalWorld());
  for (int i = 0; i < 100; ++i)
  {
    simulator.step();
    fresh.step();
  }
  EXPECT_EQ(simulator.stateHash(), fresh.stateHash());
}

TEST(StepOutcomeTest, StatesThatAreNotNumbersAreSaidAndRefused)
{
  Scenario scene = groundScene(0.5);
  addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.1));
  Simulator simulator(scene);
  for (int i = 0; i < 20; ++i)
    simulator.step();
  const SimulationState good = simulator.state();
  SimulationState bad = good;
  bad.bodies[0].v[1] = std::nan("");
  EXPECT_THROW(simulator.setState(bad), StateError);
  bad = good;
  bad.dt = 0.0;
  EXPECT_THROW(simulator.setState(bad), StateError);
  bad = good;
  bad.rows.contacts.front().shape_b = 99;
  EXPECT_THROW(simulator.setState(bad), StateError);
  EXPECT_EQ(simulator.stateHash(), hashOf(good)) << "a refused state changes nothing";
  simulator.position(0)[2] = std::nan("");
  EXPECT_EQ(simulator.stateChanged().status, SolverStatus::NUMERICAL_FAILURE);
  EXPECT_THAT(simulator.outcome().message, testing::HasSubstr("box"));
  EXPECT_TRUE(simulator.setState(good).converged());
  EXPECT_TRUE(simulator.step().converged());
}

/** The report before the next step is of no step: nothing of the run before is left in it. */
TEST(StepOutcomeTest, ReportsAfterAResetAreNotThoseOfTheStepBefore)
{
  Scenario scene = groundScene(0.5);
  addBody(scene, "box", boxUrdf({0.2, 0.2, 0.2}, 1.0), poseAt(0.0, 0.0, 0.15));
  Simulator simulator(scene);
  for (int i = 0; i < 200; ++i)
    simulator.step();
  ASSERT_EQ(simulator.report().contacts, 4);
  simulator.reset();
  EXPECT_EQ(simulator.report().contacts, 0);
  EXPECT_EQ(simulator.report().status, SolverStatus::NOT_RUN);
  EXPECT_EQ(simulator.report().time, simulator.time());
  EXPECT_EQ(simulator.report().step, 200u);
}
}  // namespace
}  // namespace frictional_contact_sim
