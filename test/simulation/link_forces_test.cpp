#include "frictional_contact_sim/simulation/link_forces.h"

#include <gtest/gtest.h>

#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
/** A box of 10 kg, 0.2 m, with a plate of 2 kg behind a fixed joint on top. */
const char* const PLATED_BOX =
    "<robot name='plated'><link name='box'><inertial><origin xyz='0 0 0.1'/><mass value='10'/>"
    "<inertia ixx='0.05' ixy='0' ixz='0' iyy='0.06' iyz='0' izz='0.08'/></inertial>"
    "<collision><origin xyz='0 0 0.1'/><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link>"
    "<link name='plate'><inertial><origin xyz='0.03 0 0.01'/><mass value='2'/>"
    "<inertia ixx='0.01' ixy='0' ixz='0' iyy='0.02' iyz='0' izz='0.02'/></inertial></link>"
    "<joint name='mount' type='fixed'><parent link='box'/><child link='plate'/>"
    "<origin xyz='0 0 0.2' rpy='0 0 1.5707963267948966'/></joint></robot>";

TEST(LinkForcesTest, RestingBoxIsCarriedAtItsCentreOfMass)
{
  Scenario scenario = groundScene(0.5);
  addBody(scenario, "plated", PLATED_BOX, poseAt(1.0, 2.0, 0.0));
  Simulator simulator(scenario);
  for (int i = 0; i < 200; ++i)
    simulator.step();
  LinkForces forces(simulator);
  ASSERT_TRUE(forces.hasStep());
  const Vector6d contact = forces.contactWrench(0, 0);
  // The plate's centre is at y = 0.03 of the box.
  const Vector6d expected = (Vector6d() << 0, 0, 12 * GRAVITY, 0.03 * 2 * GRAVITY, 0, 0).finished();
  EXPECT_LT((contact - expected).norm(), 1e-9);
  const Vector6d mount = forces.jointWrench(0, 1);
  EXPECT_LT((mount - (Vector6d() << 0, 0, 2 * GRAVITY, 0, -0.03 * 2 * GRAVITY, 0).finished()).norm(), 1e-9);
  EXPECT_LT(forces.jointWrench(0, 0).norm(), 1e-9);  // nothing holds the root
  EXPECT_LT(forces.contactWrench(0, 1).norm(), 1e-12);  // nothing touches the plate
}

TEST(LinkForcesTest, BeforeAStepThereIsNone)
{
  Scenario scenario = groundScene(0.5);
  addBody(scenario, "plated", PLATED_BOX, poseAt(0.0, 0.0, 0.0));
  Simulator simulator(scenario);
  LinkForces forces(simulator);
  EXPECT_FALSE(forces.hasStep());
  simulator.step();
  EXPECT_TRUE(forces.hasStep());
  simulator.reset();
  EXPECT_FALSE(forces.hasStep());
}

TEST(LinkForcesTest, InFlightAJointTransmitsTheRateOfMomentumBeyond)
{
  Scenario scenario = groundScene(0.5);
  BodySpec& body = addBody(scenario, "plated", PLATED_BOX, poseAt(0.0, 0.0, 50.0));
  body.angular_velocity = {3.0, -2.0, 1.0};
  scenario.time_step = 1e-4;
  Simulator simulator(scenario);
  for (int i = 0; i < 100; ++i)
    simulator.step();
  const Frame& plate = simulator.model(0).frames[1];
  const auto center = [&]
  { return Eigen::Vector3d(framePose(simulator.model(0), simulator.data(0), 1) * plate.inertia.center); };
  const auto velocity = [&] { return Eigen::Vector3d(pointVelocity(simulator.data(0), 0, center()).head<3>()); };
  const Eigen::Vector3d before = velocity();
  const Eigen::Matrix3d axes_before = framePose(simulator.model(0), simulator.data(0), 1).linear();
  simulator.step();
  const Eigen::Matrix3d axes_after = framePose(simulator.model(0), simulator.data(0), 1).linear();
  const Eigen::Vector3d force = 2.0 * ((velocity() - before) / 1e-4 - simulator.scenario().gravity);
  LinkForces forces(simulator);
  const Vector6d mount = forces.jointWrench(0, 1);
  const Eigen::Vector3d found = 0.5 * (axes_before + axes_after) * mount.head<3>();
  EXPECT_GT(force.norm(), 1.0);
  EXPECT_LT((found - force).norm(), 1e-5 * force.norm());  // of second order in dt w = 4e-4
  EXPECT_LT(forces.jointWrench(0, 0).norm(), 1e-8);
}

TEST(LinkForcesTest, AWeldCountsAmongWhatActsOnALink)
{
  Scenario scenario = groundScene(0.5);
  addBody(scenario, "a", PLATED_BOX, poseAt(0.0, 0.0, 50.0)).angular_velocity = {3.0, -2.0, 1.0};
  addBody(scenario, "b", PLATED_BOX, poseAt(0.5, 0.1, 50.2));
  Simulator simulator(scenario);
  simulator.attach({0, "plate"}, {1, "box"});
  for (int i = 0; i < 50; ++i)
    simulator.step();
  LinkForces forces(simulator);
  EXPECT_GT(simulator.weldWrench(0).norm(), 0.5);
  for (const int body : {0, 1})
    EXPECT_LT(forces.jointWrench(body, 0).norm(),
              1e-6 * simulator.weldWrench(0).norm());  // nothing else holds the root
}

TEST(LinkForcesTest, AfterBodiesHaveComeThereIsNoStepYet)
{
  Scenario scenario = groundScene(0.5);
  BodySpec late = addBody(scenario, "late", PLATED_BOX, poseAt(1.0, 0.0, 0.0));
  scenario.bodies.pop_back();
  addBody(scenario, "plated", PLATED_BOX, poseAt(0.0, 0.0, 0.0));
  Simulator simulator(scenario);
  simulator.step();
  simulator.spawn(late);
  LinkForces forces(simulator);
  EXPECT_FALSE(forces.hasStep());
  simulator.step();
  forces.restart();
  ASSERT_TRUE(forces.hasStep());
  for (const int body : {0, 1})
    EXPECT_NEAR(forces.jointWrench(body, 1)[2], 2 * GRAVITY, 1e-8);
  simulator.remove("plated");
  EXPECT_FALSE(LinkForces(simulator).hasStep());
}

TEST(LinkForcesTest, AlongItsAxisAJointTransmitsItsDrive)
{
  Scenario scenario = loadScenario("bodies: [{name: arm, urdf: " PROJECT_DIR
                                   "/urdf/double_pendulum.urdf, base: fixed, pose: {xyz: [0, 0, 3]}}]",
                                   "test");
  Simulator simulator(scenario);
  LinkForces forces(simulator);
  const MultibodyModel& model = simulator.model(0);
  JointCommand command;
  for (int i = 0; i < 300; ++i)
  {
    for (size_t joint = 1; joint < model.joints.size(); ++joint)
    {
      command.target = (joint == 1 ? 2.0 : -0.7) * std::cos(0.02 * i);
      simulator.setCommand(0, static_cast<int>(joint), command);
    }
    ASSERT_TRUE(simulator.step().converged());
    forces.restart();
    for (size_t joint = 1; joint < model.joints.size(); ++joint)
    {
      const Joint& moved = model.joints[joint];
      const Vector6d wrench = forces.jointWrench(0, model.findFrame(model.links[joint].name));
      const double damping = moved.damping * simulator.velocity(0)[moved.v_index];
      EXPECT_NEAR(simulator.effort(0, static_cast<int>(joint)) - damping, moved.axis.dot(wrench.tail<3>()), 1e-8) << i;
    }
  }
}

TEST(LinkForcesTest, NothingButContactsAndWrenchesHoldsAFreeRobot)
{
  Scenario scenario = loadScenarioFile(PROJECT_DIR "/config/scenarios/quadruped.yaml");
  ExternalWrench push;
  Simulator simulator(scenario);
  push.link = simulator.model(0).frames.back().name;
  push.force = {3.0, -2.0, 1.0};
  push.torque = {0.1, 0.2, 0.3};
  push.point = {0.01, 0.02, 0.03};
  push.world_frame = false;
  push.from = 0.05;
  push.until = 0.15;
  simulator.addWrench(0, push);
  LinkForces forces(simulator);
  double worst = 0.0;
  double largest = 0.0;
  for (int i = 0; i < 300; ++i)
  {
    ASSERT_TRUE(simulator.step().converged());
    forces.restart();
    worst = std::max(worst, forces.jointWrench(0, 0).norm());
    for (size_t frame = 1; frame < simulator.model(0).frames.size(); ++frame)
      largest = std::max(largest, forces.jointWrench(0, static_cast<int>(frame)).norm());
  }
  EXPECT_GT(largest, 10.0);
  EXPECT_LT(worst, 1e-6 * largest);  // rows close to the solver's tolerance
}

TEST(LinkForcesTest, AccelerometerReadsGravityAtRestNothingInFallAndTheCentrePull)
{
  const Eigen::Isometry3d tilted(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  Scenario rest = groundScene(0.5);
  addBody(rest, "plated", PLATED_BOX, poseAt(0.0, 0.0, 0.0));
  Simulator resting(rest);
  for (int i = 0; i < 200; ++i)
    resting.step();
  LinkForces at_rest(resting);
  const Eigen::Vector3d up = tilted.linear().transpose() * Eigen::Vector3d(0, 0, GRAVITY);
  EXPECT_LT((at_rest.specificForce(0, 0, tilted) - up).norm(), 1e-9);

  Scenario fall = groundScene(0.5);
  addBody(fall, "plated", PLATED_BOX, poseAt(0.0, 0.0, 10.0));
  Simulator falling(fall);
  falling.step();
  LinkForces in_fall(falling);
  EXPECT_LT(in_fall.specificForce(0, 0, tilted).norm(), 1e-9);

  // A turntable: 2 rad/s, the sensor half a metre from its axis.
  Simulator turning(loadScenario("bodies: [{name: table, urdf: " PROJECT_DIR
                                 "/urdf/block.urdf, base: fixed, pose: {xyz: [0, 0, 1]},"
                                 " motion: {linear: [0.3, 0, 0], angular: [0, 0, 2]}}]",
                                 "test"));
  for (int i = 0; i < 10; ++i)
    turning.step();
  LinkForces on_table(turning);
  Eigen::Isometry3d rim = Eigen::Isometry3d::Identity();
  rim.translation().x() = 0.5;
  EXPECT_LT((on_table.specificForce(0, 0, rim) - Eigen::Vector3d(-0.5 * 4.0, 0, GRAVITY)).norm(), 1e-9);
}

}  // namespace
}  // namespace frictional_contact_sim
