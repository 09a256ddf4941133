#include "frictional_contact_sim/simulation/sensor.h"

#include <random>
#include <stdexcept>

#include "frictional_contact_sim/config/nearest_name.h"

namespace frictional_contact_sim
{
int sensorFrame(const MultibodyModel& model, const SensorSpec& sensor)
{
  if (sensor.type == SensorSpec::Type::IMU)
    return model.findFrame(sensor.link);
  for (size_t i = 0; i < model.frames.size(); ++i)
    if (!model.frames[i].joint.empty() && model.frames[i].joint == sensor.joint)
      return static_cast<int>(i);
  return -1;
}

void checkSensors(const MultibodyModel& model, const std::vector<SensorSpec>& sensors)
{
  for (const SensorSpec& sensor : sensors)
  {
    if (sensorFrame(model, sensor) >= 0)
      continue;
    const bool imu = sensor.type == SensorSpec::Type::IMU;
    std::vector<std::string> names;
    for (const Frame& frame : model.frames)
      names.push_back(imu ? frame.name : frame.joint);
    const std::string& found = imu ? sensor.link : sensor.joint;
    const std::string nearest = nearestName(found, names);
    throw std::invalid_argument("body '" + model.name + "': sensor '" + sensor.name + "' names an unknown " +
                                (imu ? "link" : "joint") + " '" + found + "'" +
                                (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
  }
}

void addSensorError(const SensorSpec& sensor, int seed, std::uint64_t sample, Eigen::Vector3d& linear,
                    Eigen::Vector3d& angular)
{
  linear += sensor.linear.bias;
  angular += sensor.angular.bias;
  if (sensor.linear.noise <= 0.0 && sensor.angular.noise <= 0.0)
    return;
  std::vector<std::uint32_t> key = {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(sensor.seed),
                                    static_cast<std::uint32_t>(sample), static_cast<std::uint32_t>(sample >> 32U)};
  key.insert(key.end(), sensor.name.begin(), sensor.name.end());  // two sensors of one seed differ
  std::seed_seq seeds(key.begin(), key.end());
  std::mt19937 generator(seeds);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 3; ++i)
    linear[i] += sensor.linear.noise * normal(generator);
  for (int i = 0; i < 3; ++i)
    angular[i] += sensor.angular.noise * normal(generator);
}

}  // namespace frictional_contact_sim
