#include "frictional_contact_sim/simulation/sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frictional_contact_sim/config/config_error.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
namespace
{
SensorSpec noisySensor()
{
  SensorSpec sensor;
  sensor.name = "imu";
  sensor.linear.noise = 0.5;
  sensor.linear.bias = {0.1, -0.2, 0.3};
  sensor.angular.noise = 0.02;
  sensor.seed = 4;
  return sensor;
}

struct Sample
{
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
};

Sample errorOf(const SensorSpec& sensor, int seed, std::uint64_t step)
{
  Sample sample;
  addSensorError(sensor, seed, step, sample.linear, sample.angular);
  return sample;
}

TEST(SensorErrorTest, HasItsBiasAndDeviation)
{
  constexpr int COUNT = 20000;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  Eigen::Vector3d products = Eigen::Vector3d::Zero();
  double angular_squares = 0.0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  const SensorSpec sensor = noisySensor();
  for (int k = 0; k < COUNT; ++k)
  {
    const Sample sample = errorOf(sensor, 0, k);
    const Eigen::Vector3d noise = sample.linear - sensor.linear.bias;
    sum += noise;
    squares += noise.cwiseAbs2();
    products += noise.cwiseProduct(last);
    last = noise;
    angular_squares += sample.angular.squaredNorm() / 3.0;
  }
  // Standard errors: 0.5 / sqrt(N) = 0.0035 of a mean, 1 / sqrt(2 N) = 0.5 % of a deviation.
  EXPECT_LT((sum / COUNT).cwiseAbs().maxCoeff(), 0.018);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(0.5, std::sqrt(squares[i] / COUNT), 0.0125);
  EXPECT_LT((products / COUNT).cwiseAbs().maxCoeff(),
            5 * 0.25 / std::sqrt(COUNT));  // neighbours know nothing of each other
  EXPECT_NEAR(0.02, std::sqrt(angular_squares / COUNT), 0.0003);
}

TEST(SensorErrorTest, IsAFunctionOfSeedsNameAndStep)
{
  const SensorSpec sensor = noisySensor();
  EXPECT_EQ(errorOf(sensor, 1, 77).linear, errorOf(sensor, 1, 77).linear);
  EXPECT_NE(errorOf(sensor, 1, 77).linear, errorOf(sensor, 1, 78).linear);
  EXPECT_NE(errorOf(sensor, 1, 77).linear, errorOf(sensor, 2, 77).linear);
  EXPECT_NE(errorOf(sensor, 1, 77).linear, errorOf(sensor, 1, 77 + (std::uint64_t{1} << 32U)).linear);
  SensorSpec other = sensor;
  other.name = "imv";
  EXPECT_NE(errorOf(sensor, 1, 77).linear, errorOf(other, 1, 77).linear);
  other = sensor;
  other.linear.noise = other.angular.noise = 0.0;
  EXPECT_EQ(sensor.linear.bias, errorOf(other, 1, 77).linear);
}

std::string scenarioWith(const std::string& sensors)
{
  return "bodies: [{name: arm, urdf: " PROJECT_DIR "/urdf/double_pendulum.urdf, base: fixed, sensors: " + sensors +
         "}]";
}

TEST(SensorKeysTest, AreReadWithTheirDefaults)
{
  const Scenario scenario = loadScenario(
      scenarioWith(
          "[{type: imu, link: base-link, rate: 200, pose: {xyz: [0, 0, 1]}, noise: {gyro: 0.1, accel: 0.2},"
          " bias: {accel: [1, 2, 3]}}, {type: force_torque, joint: wrist, name: ft, topic: ~force, frame: tool,"
          " seed: 7, noise: {torque: 0.3}}]"),
      "test");
  const std::vector<SensorSpec>& sensors = scenario.bodies[0].sensors;
  ASSERT_EQ(2u, sensors.size());
  EXPECT_EQ("imu_base_link", sensors[0].name);
  EXPECT_EQ(200.0, sensors[0].rate);
  EXPECT_EQ(1.0, sensors[0].pose.translation().z());
  EXPECT_EQ(0.1, sensors[0].angular.noise);
  EXPECT_EQ(0.2, sensors[0].linear.noise);
  EXPECT_EQ(Eigen::Vector3d(1, 2, 3), sensors[0].linear.bias);
  EXPECT_EQ(SensorSpec::Type::FORCE_TORQUE, sensors[1].type);
  EXPECT_EQ("ft", sensors[1].name);
  EXPECT_EQ("~force", sensors[1].topic);
  EXPECT_EQ("tool", sensors[1].frame);
  EXPECT_EQ(7, sensors[1].seed);
  EXPECT_EQ(0.3, sensors[1].angular.noise);
}

TEST(SensorKeysTest, MistakesAreNamed)
{
  const auto messageOf = [](const std::string& sensors)
  {
    try
    {
      Simulator simulator(loadScenario(scenarioWith(sensors), "test"));
    }
    catch (const std::exception& error)
    {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const auto expectWords = [&](const std::string& sensors, const std::vector<std::string>& words)
  {
    for (const std::string& word : words)
      EXPECT_NE(std::string::npos, messageOf(sensors).find(word)) << messageOf(sensors) << " has no " << word;
  };
  expectWords("[{link: a}]", {"type", "imu or force_torque"});
  expectWords("[{type: sonar, link: a}]", {"type", "sonar", "imu"});
  expectWords("[{type: imu}]", {"link"});
  expectWords("[{type: imu, link: a, joint: b}]", {"joint"});
  expectWords("[{type: imu, link: a, noise: {force: 1}}]", {"noise", "force"});
  expectWords("[{type: imu, link: a, noise: {gyro: -1}}]", {"gyro", "-1"});
  expectWords("[{type: imu, link: a, rate: .nan}]", {"rate"});
  expectWords("[{type: imu, link: a, topic: 'a b'}]", {"topic", "a b"});
  expectWords("[{type: imu, link: a}, {type: imu, link: a}]", {"imu_a", "twice"});
  expectWords("[{type: imu, link: nowhere}]", {"unknown link", "nowhere"});
  expectWords("[{type: force_torque, joint: nowhere}]", {"unknown joint", "nowhere"});
}

}  // namespace
}  // namespace frictional_contact_sim
