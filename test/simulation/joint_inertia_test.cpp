// Links without inertia (model/joint_inertia.h): random robots with the inertia of random links taken away.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/simulation/scenario_error.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "support/audited_simulator.h"
#include "support/massless_links.h"
#include "support/random_robot.h"

namespace frictional_contact_sim
{
namespace
{
using test_support::AuditedSimulator;
using test_support::Dice;
using test_support::MasslessLinks;

constexpr std::uint32_t SEEDS = 200;

bool mentions(const std::vector<std::string>& warnings, const std::string& text)
{
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

Eigen::VectorXd randomPosition(const MultibodyModel& model, Dice& dice)
{
  Eigen::VectorXd q = zeroPosition(model);
  for (const Joint& joint : model.joints)
    for (int k = joint.q_index; k < joint.q_index + positionSize(joint.type); ++k)
      q[k] += dice.uniform(-1.5, 1.5);
  for (const Joint& joint : model.joints)
    if (joint.type == JointType::FLOATING)
      q.segment<4>(joint.q_index + 3).normalize();
  return q;
}

/** The robot of a seed, some of its links without inertia. */
struct RandomCase
{
  explicit RandomCase(std::uint32_t seed)
    : dice(seed), robot(test_support::takeInertia(test_support::randomRobot(dice).xml, dice))
  {
    base = dice.chance(0.7) ? BaseType::FLOATING : BaseType::FIXED;
  }
  Dice dice;
  MasslessLinks robot;
  BaseType base = BaseType::FLOATING;
};

TEST(JointInertiaTest, MassMatrixIsPositiveDefiniteAtEveryPosition)
{
  int altered = 0;
  for (std::uint32_t seed = 0; seed < SEEDS; ++seed)
  {
    SCOPED_TRACE(seed);
    RandomCase random(seed);
    const LoadedModel loaded = loadUrdf(random.robot.xml, "random", random.base);
    altered += mentions(loaded.warnings, "moves no inertia");
    MultibodyData data(loaded.model);
    for (int k = 0; k < 20; ++k)
    {
      const Eigen::VectorXd q = k == 0 ? zeroPosition(loaded.model) : randomPosition(loaded.model, random.dice);
      forwardKinematics(loaded.model, q, data);
      computeMassMatrix(loaded.model, data);
      ASSERT_TRUE(factorizeMassMatrix(loaded.model, Eigen::VectorXd(), data));
      const Eigen::VectorXd x = Eigen::VectorXd::Ones(loaded.model.nv);
      Eigen::VectorXd solved = data.mass_matrix * x;
      const Eigen::VectorXd right = solved;
      solveMassMatrix(loaded.model, data, solved);
      EXPECT_LE((data.mass_matrix * solved - right).norm(), 1e-10 * (data.mass_matrix.norm() + right.norm()));
    }
  }
  EXPECT_GT(altered, static_cast<int>(SEEDS) / 4);
}

/** What is added is counted: with it nothing else changes, and links that have inertia are left alone. */
TEST(JointInertiaTest, OnlyJointsOfLinksWithoutInertiaGetAny)
{
  for (std::uint32_t seed = 0; seed < SEEDS; ++seed)
  {
    SCOPED_TRACE(seed);
    RandomCase random(seed);
    const MultibodyModel model = loadUrdf(random.robot.xml, "random", random.base).model;
    for (size_t i = 0; i < model.links.size(); ++i)
    {
      const Joint& joint = model.joints[i];
      bool is_taken = false;
      for (const Frame& frame : model.frames)
        is_taken = is_taken || (frame.link == static_cast<int>(i) && random.robot.links.count(frame.name) > 0);
      EXPECT_TRUE(is_taken || model.armature.segment(joint.v_index, velocitySize(joint.type)).isZero()) << joint.name;
    }
  }
}

/** Moves freely from random speeds; no shapes. */
Scenario freeScene(RandomCase& random, double gravity, double time_step)
{
  Scenario scene;
  scene.time_step = time_step;
  scene.gravity = Eigen::Vector3d(0.0, 0.0, -gravity);
  BodySpec body;
  body.name = "robot";
  body.urdf_xml = test_support::withoutCollisions(random.robot.xml);
  body.base = random.base;
  body.pose = Eigen::Isometry3d::Identity();
  if (random.base == BaseType::FLOATING)
  {
    body.linear_velocity = random.dice.vector(1.0);
    body.angular_velocity = random.dice.vector(1.0);
  }
  const MultibodyModel model = loadUrdf(body.urdf_xml, "random", body.base).model;
  for (const Joint& joint : model.joints)
  {
    if (velocitySize(joint.type) != 1 || joint.mimic.joint >= 0)
      continue;
    const double start = std::clamp(0.0, joint.limit.lower, joint.limit.upper);
    body.joints[joint.name] = {start, start == 0.0 ? random.dice.uniform(-0.5, 0.5) : 0.0};  // no impact at the start
  }
  scene.bodies.push_back(body);
  return scene;
}

TEST(JointInertiaTest, EveryStepIsSolvedAndKeepsEnergyAndMomentum)
{
  for (std::uint32_t seed = 0; seed < 60; ++seed)
  {
    SCOPED_TRACE(seed);
    RandomCase random(seed);
    AuditedSimulator simulator(freeScene(random, seed % 2 == 0 ? 0.0 : 9.81, 1e-3));
    for (int step = 0; step < 50; ++step)
      ASSERT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  }
}

/** The key of a scenario reaches the joint; what is not above zero is refused by name. */
TEST(JointInertiaTest, LeastInertiaIsAKeyOfABody)
{
  const std::string path = ::testing::TempDir() + "/joint_inertia_test.urdf";
  std::ofstream(path) << "<robot name='r'><link name='world'/><link name='cap'/><joint name='turn' type='continuous'>"
                         "<parent link='world'/><child link='cap'/></joint></robot>";
  const auto load = [&](const std::string& value)
  { return loadScenario("bodies: [{name: r, urdf: " + path + ", min_joint_inertia: " + value + "}]", "scene.yaml"); };
  EXPECT_EQ(Simulator(load("0.25")).model(0).armature, Eigen::VectorXd::Constant(1, 0.25));
  for (const std::string bad : {"0", "-1", "nan", "much"})
  {
    try
    {
      load(bad);
      FAIL() << bad;
    }
    catch (const ScenarioError& error)
    {
      const std::string message = error.what();
      for (const std::string& part : {std::string("scene.yaml:1"), std::string("min_joint_inertia"), "'" + bad + "'"})
        EXPECT_NE(message.find(part), std::string::npos) << message;
    }
  }
}

TEST(JointInertiaTest, HalfOfItChangesNoOtherLink)
{
  int compared = 0;
  for (std::uint32_t seed = 0; seed < 100; ++seed)
  {
    SCOPED_TRACE(seed);
    RandomCase random(seed);
    Scenario scene = freeScene(random, 9.81, 1e-3);
    scene.bodies[0].min_joint_inertia = DEFAULT_JOINT_INERTIA;
    Simulator whole(scene);
    if (!mentions(whole.warnings(), "moves no inertia"))
      continue;
    scene.bodies[0].min_joint_inertia = 0.5 * DEFAULT_JOINT_INERTIA;
    Simulator half(scene);
    for (int step = 0; step < 50; ++step)
    {
      whole.step();
      half.step();
    }
    const MultibodyModel& model = whole.model(0);
    for (const Frame& frame : model.frames)
    {
      if (random.robot.links.count(frame.name) > 0 || frame.link == 0)
        continue;
      ++compared;
      const Vector6d& a = whole.data(0).link_velocity[frame.link];
      const Vector6d& b = half.data(0).link_velocity[frame.link];
      EXPECT_LT((a - b).norm(), 1e-6 * (a.norm() + 0.1)) << frame.name;
      EXPECT_LT((whole.data(0).link_pose[frame.link].matrix() - half.data(0).link_pose[frame.link].matrix()).norm(),
                1e-6)
          << frame.name;
    }
  }
  EXPECT_GT(compared, 100);
}

}  // namespace
}  // namespace frictional_contact_sim
