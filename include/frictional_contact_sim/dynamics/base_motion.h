#pragma once
/**
 * @file base_motion.h
 * @brief Prescribed motion of a fixed base, and of surfaces of links that stay in place.
 */
#include <Eigen/Geometry>
#include <vector>

namespace frictional_contact_sim
{
/** @brief Of a rigid base: velocity of its root link's origin and about it, world axes. */
struct BaseVelocity
{
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< [rad/s]
};

/** @brief Where a fixed base is at which time of the scenario's clock. */
struct BaseMotion
{
  enum class Type
  {
    CONSTANT,  ///< velocities
    SINE,  ///< displacement amplitude sin(2 pi frequency t + phase) along an axis
    TABLE  ///< displacements and turns over time, linear between; before and after it stands still
  };
  Type type = Type::CONSTANT;
  bool active = false;
  BaseVelocity velocity;  ///< CONSTANT
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< SINE, world axes, of length 1
  double amplitude = 0.0;  ///< [m]
  double frequency = 0.0;  ///< [Hz]
  double phase = 0.0;  ///< [rad]
  std::vector<double> times;  ///< TABLE, ascending [s]
  std::vector<Eigen::Vector3d> displacements;  ///< one a time, world axes [m]
  std::vector<Eigen::Quaterniond> turns;  ///< one a time, of the base about its own origin, world axes; or none
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  ///< SINE, TABLE: where displacement and turn are none

  BaseMotion() = default;
  /** @brief CONSTANT. */
  BaseMotion(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) : active(true), velocity{linear, angular} {}

  bool isProgram() const { return active && type != Type::CONSTANT; }
};

/** @brief Pose of a SINE or TABLE at a time [s]. */
Eigen::Isometry3d programPose(const BaseMotion& motion, double time);

/** @brief The rotation vector that turns `from` into `to`, world axes. */
Eigen::Vector3d rotationBetween(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to);

/**
 * @brief T with T arm = (exp(dt [angular]x) - 1) arm / dt: mean velocity over dt of a point that turns with `angular`
 * and is at `arm` now. What sticks to it stays on its circle; angular x arm would leave it along the tangent.
 */
Eigen::Matrix3d chordTurn(const Eigen::Vector3d& angular, double dt);
/** @brief T arm = angular x arm: at an instant. */
Eigen::Matrix3d instantTurn(const Eigen::Vector3d& angular);

/** @brief A link whose surface moves while it stays (conveyor, track, turntable), in the axes of the URDF link. */
struct SurfaceMotion
{
  int frame = -1;  ///< URDF link in the body's model
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< about the link's origin [rad/s]
};

}  // namespace frictional_contact_sim
