#pragma once
/**
 * @file sensor_publisher.h
 * @brief Sensors of the bodies: sensor_msgs/Imu and geometry_msgs/WrenchStamped of the steps that are due.
 */
#include <ros/node_handle.h>
#include <sensor_msgs/Imu.h>

#include <vector>

#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/names.h"
#include "frictional_contact_sim/ros/step_divider.h"
#include "frictional_contact_sim/simulation/link_forces.h"

namespace frictional_contact_sim
{
/**
 * @brief What an inertial measurement unit says of the last step, errors included: orientation and angular velocity at
 * its end, specific force as its mean, all of the sensor's axes. Needs forces.hasStep().
 * @param seed beside the sensor's own. @param sample number of the step since the start or the last reset
 */
void fillImu(const Simulator& simulator, LinkForces& forces, int body, const SensorSpec& sensor, int seed,
             std::uint64_t sample, const ros::Time& stamp, sensor_msgs::Imu& message);

class SensorPublisher
{
public:
  /** @param seed beside those of the sensors */
  SensorPublisher(ros::NodeHandle& node, ros::NodeHandle& private_node, const Simulator& simulator,
                  const NameTable& names, LinkForces& forces, int seed);

  /** @brief Those that are due and heard, after a step. */
  void publish(const ros::Time& stamp);
  /** @brief Rates stay, in simulated time. @param time_step [s] */
  void setTimeStep(double time_step);
  const std::vector<ros::Publisher>& publishers() const;
  /** @brief Frames of sensors that have a pose of their own: link to sensor, without a stamp. */
  std::vector<geometry_msgs::TransformStamped> transforms() const;

private:
  struct Sensor
  {
    int body;
    int frame;
    const SensorSpec* spec;
    std::string frame_id;
    StepDivider divider;
  };

  void send(const Sensor& sensor, const ros::Publisher& publisher, std::uint64_t sample, const ros::Time& stamp);

  const Simulator& simulator_;
  const NameTable& names_;
  LinkForces& forces_;
  int seed_;
  std::vector<Sensor> sensors_;
  std::vector<ros::Publisher> publishers_;  // by sensor
  sensor_msgs::Imu imu_;  // kept for its storage
  geometry_msgs::WrenchStamped wrench_;
};

}  // namespace frictional_contact_sim
