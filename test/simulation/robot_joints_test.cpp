// Published robots (../shared/robots): joints with all that their files say of them, limp and under servos.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "linkage.h"
#include "scene.h"

namespace frictional_contact_sim
{
namespace
{
const std::string SHARED_ROBOTS = std::string(PROJECT_DIR) + "/../shared/robots";
const std::string ALLEGRO =
    SHARED_ROBOTS + "/example-robot-data/robots/allegro_hand_description/urdf/allegro_right_hand.urdf";

std::string readText(const std::string& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string number(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

/** The Allegro hand without damping, every joint with one dry friction [N m], fixed in the air, limp. */
Scenario allegroScene(double friction)
{
  setenv("ROS_PACKAGE_PATH", SHARED_ROBOTS.c_str(), 1);
  Scenario scenario = groundScene(0.5);
  scenario.ground.reset();
  scenario.stopping.tolerance = 1e-12;
  BodySpec body;
  body.name = "hand";
  body.urdf_xml = std::regex_replace(readText(ALLEGRO), std::regex("damping=\"[^\"]*\" friction=\"[^\"]*\""),
                                     "damping=\"0\" friction=\"" + number(friction) + "\"");
  body.base = BaseType::FIXED;
  body.pose = poseAt(0.0, 0.0, 1.0);
  body.pose->linear() = Eigen::AngleAxisd(0.9, Eigen::Vector3d(0.3, 1.0, 0.2).normalized()).toRotationMatrix();
  for (const char* joint : {"joint_1.0", "joint_5.0", "joint_9.0", "joint_2.0", "joint_6.0"})
    body.joints[joint] = {0.4, 0.0};
  body.self_collision = false;
  scenario.bodies.push_back(body);
  return scenario;
}

/** Fastest joint after a tenth of a second [rad/s]. */
double fastestJoint(double friction)
{
  Simulator simulator(allegroScene(friction));
  for (int step = 0; step < 100; ++step)
    EXPECT_TRUE(simulator.step().converged()) << simulator.outcome().message;
  return simulator.velocity(0).cwiseAbs().maxCoeff();
}

TEST(AllegroTest, HoldsItselfWithTheFrictionOfItsLargestGravityMomentAndMovesBelow)
{
  if (!std::filesystem::exists(ALLEGRO))
    GTEST_SKIP() << "no " << ALLEGRO << ": published robots are tested only where ../shared is there";
  // tau_c = max |tau_gravity| over the joints that the weight pushes away from no limit, by virtual work: the change of
  // potential energy with each joint, by central differences.
  Simulator still(allegroScene(1.0));
  const MultibodyModel& model = still.model(0);
  MultibodyData data = still.data(0);
  const Eigen::VectorXd start = still.position(0);
  const auto potential = [&](const Eigen::VectorXd& q)
  {
    forwardKinematics(model, q, data);
    return model.totalMass() * GRAVITY * centerOfMass(model, data).z();
  };
  double largest = 0.0;
  for (const Joint& joint : model.joints)
  {
    if (joint.type != JointType::REVOLUTE)
      continue;
    Eigen::VectorXd q = start;
    const double step = 1e-4;
    q[joint.q_index] += step;
    const double ahead = potential(q);
    q[joint.q_index] -= 2.0 * step;
    const double moment = -(ahead - potential(q)) / (2.0 * step);
    const double position = start[joint.q_index];
    if ((moment < 0.0 && position > joint.limit.lower + 1e-6) || (moment > 0.0 && position < joint.limit.upper - 1e-6))
      largest = std::max(largest, std::abs(moment));
  }
  ASSERT_GT(largest, 1e-3);
  double moves = 0.5 * largest;
  double holds = 2.0 * largest;
  ASSERT_GT(fastestJoint(moves), 1e-9);
  ASSERT_LT(fastestJoint(holds), 1e-12);
  while (holds - moves > 2e-7 * largest)
  {
    const double middle = 0.5 * (holds + moves);
    (fastestJoint(middle) > 1e-9 ? moves : holds) = middle;
  }
  // Central differences of a sine miss by step^2/6 = 2e-9 of it.
  EXPECT_NEAR(holds, largest, 1e-6 * largest);
  EXPECT_NEAR(moves, largest, 1e-6 * largest);
}

std::vector<std::string> publishedRobots()
{
  std::vector<std::string> robots;
  if (std::filesystem::exists(SHARED_ROBOTS))
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SHARED_ROBOTS))
      if (entry.path().extension() == ".urdf")
        robots.push_back(entry.path().string());
  std::sort(robots.begin(), robots.end());
  return robots;
}

/** Whether a line of loading says of something that is read that it is not: "<mimic> in <joint> is not used". */
bool isAboutASupportedTag(const std::string& warning)
{
  static const std::regex tags(
      "(<(limit|dynamics|mimic|axis|parent|child|origin)> in <joint>|attribute "
      "'(lower|upper|effort|velocity|damping|friction|joint|multiplier|offset|xyz|rpy)' of <[a-z]+>) is not used");
  return std::regex_search(warning, tags);
}

class PublishedJointsTest : public testing::TestWithParam<bool>
{
};

TEST_P(PublishedJointsTest, KeepLimitsMimicsAndEffortsAndHaveNoWarningOfASupportedTag)
{
  const bool is_held = GetParam();
  const std::vector<std::string> robots = publishedRobots();
  if (robots.empty())
    GTEST_SKIP() << "no " << SHARED_ROBOTS;
  setenv("ROS_PACKAGE_PATH", SHARED_ROBOTS.c_str(), 1);
  for (const std::string& path : robots)
  {
    SCOPED_TRACE(path);
    Scenario scenario = groundScene(0.5);
    scenario.ground.reset();
    scenario.stopping.tolerance = 1e-8;
    BodySpec body;
    body.name = "robot";
    body.urdf_path = path;
    body.base = BaseType::FIXED;
    body.self_collision = false;
    body.hold_initial_position = is_held;
    scenario.bodies.push_back(body);
    Simulator simulator(scenario);
    for (const std::string& warning : simulator.warnings())
      EXPECT_FALSE(isAboutASupportedTag(warning)) << warning;
    const MultibodyModel& model = simulator.model(0);
    const Eigen::VectorXd start = simulator.position(0);
    double energy = energyOf(simulator);
    for (int step = 0; step < 200; ++step)
    {
      ASSERT_TRUE(simulator.step().converged()) << step << " " << simulator.outcome().message;
      for (size_t j = 0; j < model.joints.size(); ++j)
      {
        const Joint& joint = model.joints[j];
        if (joint.type != JointType::REVOLUTE && joint.type != JointType::PRISMATIC)
          continue;
        const double q = simulator.position(0)[joint.q_index];
        ASSERT_GE(q, std::min(joint.limit.lower, start[joint.q_index]) - 1e-9) << joint.name;
        ASSERT_LE(q, std::max(joint.limit.upper, start[joint.q_index]) + 1e-9) << joint.name;
        if (joint.mimic.joint >= 0)
        {
          const double followed = simulator.position(0)[model.joints[joint.mimic.joint].q_index];
          ASSERT_NEAR(q, joint.mimic.multiplier * followed + joint.mimic.offset, 1e-9) << joint.name;
        }
        ASSERT_LE(std::abs(simulator.effort(0, static_cast<int>(j))), joint.limit.effort * (1.0 + 1e-9)) << joint.name;
      }
      if (!is_held)
      {
        const double now = energyOf(simulator);
        ASSERT_LE(now, energy + 1e-6 * (1.0 + simulator.report().energy.kinetic)) << step;
        energy = now;
      }
    }
    EXPECT_LT(simulator.report().bilateral_violation, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, PublishedJointsTest, testing::Bool(),
                         [](const testing::TestParamInfo<bool>& info) { return info.param ? "servos" : "limp"; });

}  // namespace
}  // namespace frictional_contact_sim
