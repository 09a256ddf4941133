#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <regex>
#include <sstream>

#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "frictional_contact_sim/model/urdf_loader.h"

namespace frictional_contact_sim
{
namespace
{
/** Sum of all <mass value="..."/> outside comments: links only join, so no mass may be lost or counted twice. */
double massInText(const std::string& path)
{
  std::ifstream file(path);
  std::ostringstream content;
  content << file.rdbuf();
  std::string text = content.str();
  for (size_t begin = text.find("<!--"); begin != std::string::npos; begin = text.find("<!--"))
  {
    text.erase(begin, text.find("-->", begin) + 3 - begin);
  }
  double mass = 0.0;
  const std::regex element("<mass\\s+value\\s*=\\s*[\"']([^\"']*)");
  for (std::sregex_iterator match(text.begin(), text.end(), element), end; match != end; ++match)
  {
    mass += std::stod((*match)[1]);
  }
  return mass;
}

struct Robot
{
  const char* name;
  const char* path;
  int nq;
  int nv;
};

void PrintTo(const Robot& robot, std::ostream* os)
{
  *os << robot.name;
}

void checkLoads(const Robot& robot, const std::string& path)
{
  const LoadedModel loaded = loadUrdfFile(path, BaseType::AUTO);
  const MultibodyModel& model = loaded.model;
  EXPECT_EQ(model.nq, robot.nq);
  EXPECT_EQ(model.nv, robot.nv);
  EXPECT_NEAR(model.totalMass(), massInText(path), 1e-12 * model.totalMass());
  MultibodyData data(model);
  forwardKinematics(model, zeroPosition(model), data);
  computeMassMatrix(model, data);
  EXPECT_TRUE(factorizeMassMatrix(model, Eigen::VectorXd(), data));
  Eigen::VectorXd bias(model.nv);
  computeBiasForces(model, Eigen::VectorXd::Zero(model.nv), Eigen::Vector3d(0, 0, -9.81), data, bias);
  if (model.joints[0].type == JointType::FLOATING)
  {
    EXPECT_NEAR(bias[2], 9.81 * model.totalMass(), 1e-11 * model.totalMass());  // its weight
  }
  for (const std::string& warning : loaded.warnings)
  {
    EXPECT_THAT(warning, testing::Not(testing::HasSubstr("\n")));
  }
}

class OwnRobotTest : public testing::TestWithParam<Robot>
{
};
class PublishedRobotTest : public testing::TestWithParam<Robot>
{
};
}  // namespace

TEST_P(OwnRobotTest, LoadsWithoutAnyWarning)
{
  const std::string path = std::string(PROJECT_DIR "/urdf/") + GetParam().path;
  checkLoads(GetParam(), path);
  EXPECT_THAT(loadUrdfFile(path, BaseType::AUTO).warnings, testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Urdf, OwnRobotTest,
                         testing::Values(Robot{"block", "block.urdf", 7, 6}, Robot{"cube", "cube.urdf", 7, 6},
                                         Robot{"ball", "ball.urdf", 7, 6}, Robot{"cylinder", "cylinder.urdf", 7, 6},
                                         Robot{"double_pendulum", "double_pendulum.urdf", 2, 2},
                                         Robot{"gripper", "gripper.urdf", 9, 8},
                                         Robot{"gripper_mimic", "gripper_mimic.urdf", 9, 8},
                                         Robot{"quadruped", "quadruped.urdf", 19, 18}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(PublishedRobotTest, LoadsWithItsWholeMass)
{
  const std::string shared = PROJECT_DIR "/../shared/robots";
  if (!std::filesystem::exists(shared))
  {
    GTEST_SKIP() << shared << " is absent: published robots are not tested";
  }
  ::setenv("ROS_PACKAGE_PATH", shared.c_str(), 1);
  checkLoads(GetParam(), shared + "/example-robot-data/robots/" + GetParam().path);
}

INSTANTIATE_TEST_SUITE_P(
    ExampleRobotData, PublishedRobotTest,
    testing::Values(Robot{"anymal", "anymal_b_simple_description/robots/anymal.urdf", 19, 18},
                    Robot{"go1", "go1_description/urdf/go1.urdf", 19, 18},
                    Robot{"solo12", "solo_description/robots/solo12.urdf", 19, 18},
                    Robot{"panda", "panda_description/urdf/panda.urdf", 16, 15},
                    Robot{"panda_collision", "panda_description/urdf/panda_collision.urdf", 16, 15},
                    Robot{"allegro", "allegro_hand_description/urdf/allegro_right_hand.urdf", 23, 22},
                    Robot{"simple_humanoid", "simple_humanoid_description/urdf/simple_humanoid.urdf", 36, 35},
                    Robot{"double_pendulum", "double_pendulum_description/urdf/double_pendulum_simple.urdf", 9, 8}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(QuadrupedTest, StandsOnFourFeetUnderItsHipsInTheStatedPose)
{
  const MultibodyModel model = loadUrdfFile(PROJECT_DIR "/urdf/quadruped.urdf", BaseType::AUTO).model;
  Eigen::VectorXd q = zeroPosition(model);
  for (const std::string leg : {"LF", "RF", "LH", "RH"})
  {
    const double sign = leg[1] == 'F' ? 1.0 : -1.0;
    q[model.joints[model.findJoint(leg + "_HFE")].q_index] = 0.7 * sign;
    q[model.joints[model.findJoint(leg + "_KFE")].q_index] = -1.4 * sign;
  }
  MultibodyData data(model);
  forwardKinematics(model, q, data);
  for (const std::string leg : {"LF", "RF", "LH", "RH"})
  {
    const Eigen::Vector3d foot = framePose(model, data, model.findFrame(leg + "_FOOT")).translation();
    const Eigen::Vector3d hip = framePose(model, data, model.findFrame(leg + "_THIGH")).translation();
    const Eigen::Vector3d expected(hip.x(), hip.y(), -0.5 * std::cos(0.7));
    EXPECT_LT((foot - expected).norm(), 1e-15);
  }
  EXPECT_LT(centerOfMass(model, data).head<2>().norm(), 1e-15);  // mirror symmetric
}

}  // namespace frictional_contact_sim
