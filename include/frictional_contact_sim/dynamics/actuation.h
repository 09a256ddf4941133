#pragma once
/**
 * @file actuation.h
 * @brief Joint commands and external wrenches, and the impulse a servo gives over one time step.
 *
 * A servo with stiffness kp and damping kd pulls the joint to target position q_d (or velocity v_d):
 *
 *     tau = kp (q_d - q') + kd (v_d - v_k+1) + tau_ff,      q' = q_k + dt/4 (v_k + v_k+1)
 *
 * stiffness at the midpoint, damping at the end of the step (docs/architecture.md). Over the step this is linear
 * in the unknown velocity:  dt tau = c - K v_k+1  with
 *
 *     K = dt^2/4 kp + dt kd   [kg] or [kg m^2],        c = dt (kp (q_d - q_k - dt/4 v_k) + kd v_d + tau_ff)   [N s] or
 * [N m s]
 *
 * so K goes to the diagonal of M and c to the right-hand side: symmetric, stable for any gain. Beyond dt sqrt(kp/m) = 2
 * the spring is resolved no more: the joint still goes to its target without overshoot growing, but its oscillation
 * takes place at the time step's rate instead of the spring's.
 */
#include <Eigen/Core>
#include <limits>
#include <string>

namespace frictional_contact_sim
{
/** @brief Servo or effort on one joint. Unset gains (NaN) are derived from the joint's inertia, see defaultGains. */
struct JointCommand
{
  enum class Mode
  {
    EFFORT,  ///< constant effort `target`
    POSITION,  ///< kp, kd towards position `target` at rest
    VELOCITY  ///< kd towards velocity `target`
  };
  Mode mode = Mode::EFFORT;
  double target = 0.0;  ///< [N m] / [rad] / [rad/s], or [N] / [m] / [m/s]
  double rate = 0.0;  ///< POSITION: velocity v_d of the target [rad/s] or [m/s]
  double feedforward = 0.0;  ///< POSITION, VELOCITY: tau_ff, within the effort limit too [N m] or [N]
  double kp = std::numeric_limits<double>::quiet_NaN();  ///< stiffness [N m/rad] or [N/m], >= 0
  double kd = std::numeric_limits<double>::quiet_NaN();  ///< damping [N m s/rad] or [N s/m], >= 0
  double max_effort = std::numeric_limits<double>::infinity();  ///< [N m] or [N], besides the URDF's effort limit
};

/** @brief A wrench on a link during [from, until) of the scenario's clock, which starts at 0 again at every reset. */
struct ExternalWrench
{
  std::string link;
  int frame = -1;  ///< index of `link` in the model, set when the wrench is added
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< where the force acts, in the link frame [m]
  bool world_frame = true;  ///< axes of force and torque: world, else the link's
  bool is_replaceable = false;  ///< by the next such wrench on this frame; one of a body's list at most
  double from = 0.0;  ///< [s]
  double until = std::numeric_limits<double>::infinity();
};

/** @brief dt tau = offset - stiffness v_k+1. */
struct ServoImpulse
{
  double offset = 0.0;  ///< c [N s] or [N m s]
  double stiffness = 0.0;  ///< K [kg] or [kg m^2], zero for a constant effort
};

/** @brief The impulse of a command over one step of length dt at joint position q and velocity v (gains set). */
ServoImpulse servoImpulse(const JointCommand& command, double q, double v, double dt);

/**
 * @brief Fills unset gains for a joint that moves `inertia`: a critically damped servo of DEFAULT_SERVO_FREQUENCY,
 * kp = inertia w^2, kd = 2 inertia w (POSITION), kd = inertia w (VELOCITY).
 * @param inertia [kg] or [kg m^2] > 0
 */
void fillDefaultGains(double inertia, JointCommand& command);

// What no command goes beyond, whatever the URDF says: a number that is finite but absurd leaves no problem to solve.
constexpr double MAX_TRAVEL = 50.0;  ///< of a target from where the joint is [rad] or [m]
constexpr double MAX_SPEED = 1e3;  ///< [rad/s] or [m/s]
constexpr double MAX_EFFORT = 1e9;  ///< [N m] or [N]

constexpr double DEFAULT_SERVO_FREQUENCY = 40.0;  ///< [rad/s]: settles in a tenth of a second, resolved at dt = 1e-3 s

}  // namespace frictional_contact_sim
