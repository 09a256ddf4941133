#include "sensor_keys.h"

#include <regex>
#include <set>

#include "frictional_contact_sim/simulation/scenario_keys.h"

namespace frictional_contact_sim
{
namespace
{
using Type = SensorSpec::Type;

std::string readMatching(const ConfigNode& node, const char* pattern, const char* expected)
{
  const std::string text = node.text();
  if (!std::regex_match(text, std::regex(pattern)))
    node.failExpecting(expected);
  return text;
}

/** {LINEAR: standard deviation, ANGULAR: standard deviation} by the sensor's own words. */
ConfigKeys errorKeys(SensorSpec& sensor)
{
  const bool imu = sensor.type == Type::IMU;
  const char* linear = imu ? "accel" : "force";
  const char* angular = imu ? "gyro" : "torque";
  return {key("noise",
              [&sensor, linear, angular](const ConfigNode& noise)
              {
                noise.readMap({key(linear, sensor.linear.noise, notNegative()),
                               key(angular, sensor.angular.noise, notNegative())});
              }),
          key("bias",
              [&sensor, linear, angular](const ConfigNode& bias) {
                bias.readMap({key(linear, sensor.linear.bias), key(angular, sensor.angular.bias)});
              })};
}

SensorSpec readSensor(const ConfigNode& node)
{
  SensorSpec sensor;
  const ConfigNode type = node.at("type");
  if (!node.isMap() || !type.isThere())
    node.failExpecting("a map with type: imu or force_torque");
  sensor.type = type.choice(Choices<Type>{{"imu", Type::IMU}, {"force_torque", Type::FORCE_TORQUE}});
  const bool imu = sensor.type == Type::IMU;
  ConfigKeys keys = {
      key("type", [](const ConfigNode&) {}),
      required(key(imu ? "link" : "joint",
                   [&](const ConfigNode& place) { (imu ? sensor.link : sensor.joint) = place.text(); })),
      key("name", [&](const ConfigNode& name)
          { sensor.name = readMatching(name, "[A-Za-z][A-Za-z0-9_]*", "letters, digits and _, a letter first"); }),
      key("topic", [&](const ConfigNode& topic)
          { sensor.topic = readMatching(topic, "(~|/)?[A-Za-z][A-Za-z0-9_/]*", "the name of a topic"); }),
      key("frame", [&](const ConfigNode& frame) { sensor.frame = frame.text(); }),
      key("rate", sensor.rate, notNegative()),
      key("seed", sensor.seed, 0)};
  if (imu)
    keys.push_back(key("pose", [&](const ConfigNode& pose) { sensor.pose = readPose(pose); }));
  node.readMap(keys + errorKeys(sensor));
  if (sensor.name.empty())
    sensor.name = std::regex_replace((imu ? "imu_" + sensor.link : "force_torque_" + sensor.joint),
                                     std::regex("[^A-Za-z0-9_]"), "_");
  return sensor;
}
}  // namespace

std::vector<SensorSpec> readSensors(const ConfigNode& node)
{
  std::vector<SensorSpec> sensors;
  std::set<std::string> names;
  for (const ConfigNode& one : node.items("sensors"))
  {
    sensors.push_back(readSensor(one));
    if (!names.insert(sensors.back().name).second)
      one.fail("found the name '" + sensors.back().name + "' twice, expected different names");
  }
  return sensors;
}

}  // namespace frictional_contact_sim
