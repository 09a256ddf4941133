#pragma once
/**
 * @file sensor.h
 * @brief Sensors of a body: where they are and how badly they measure.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
/** @brief Standard deviation of each sample, the same for the three axes, and what is added to all of them. */
struct SensorError
{
  double noise = 0.0;  ///< >= 0
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
};

struct SensorSpec
{
  enum class Type
  {
    IMU,  ///< angular velocity and specific force at a place of a link
    FORCE_TORQUE  ///< what a joint transmits to its child link
  };
  Type type = Type::IMU;
  std::string name;  ///< letters, digits, _
  std::string link;  ///< of an IMU
  std::string joint;  ///< of a force-torque sensor, fixed ones too
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of an IMU in the frame of the link
  std::string topic;  ///< empty: one made from the name
  std::string frame;  ///< frame_id; empty: the link's, or the name where an IMU has a pose of its own
  double rate = 0.0;  ///< [1/s simulated]; 0 = every step
  int seed = 0;
  SensorError linear;  ///< specific force [m/s^2], or force [N]
  SensorError angular;  ///< angular velocity [rad/s], or torque [N m]
};

/** @brief Frame of the model that a sensor sits on, -1 when there is none. */
int sensorFrame(const MultibodyModel& model, const SensorSpec& sensor);

/** @throws std::invalid_argument in one line for a link or joint that the model does not have */
void checkSensors(const MultibodyModel& model, const std::vector<SensorSpec>& sensors);

/**
 * @brief Adds bias and normally distributed noise. The noise is a function of its arguments alone: no run, no
 * subscriber and no clock changes it.
 * @param sample number of the step since the start or the last reset
 */
void addSensorError(const SensorSpec& sensor, int seed, std::uint64_t sample, Eigen::Vector3d& linear,
                    Eigen::Vector3d& angular);

}  // namespace frictional_contact_sim
