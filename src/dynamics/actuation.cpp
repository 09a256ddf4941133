#include "frictional_contact_sim/dynamics/actuation.h"

#include <cmath>

namespace frictional_contact_sim
{
ServoImpulse servoImpulse(const JointCommand& command, double q, double v, double dt)
{
  switch (command.mode)
  {
    case JointCommand::Mode::EFFORT:
      return {dt * command.target, 0.0};
    case JointCommand::Mode::POSITION:
      return {dt * command.kp * (command.target - q - 0.25 * dt * v) + dt * command.kd * command.rate +
                  dt * command.feedforward,
              0.25 * dt * dt * command.kp + dt * command.kd};
    case JointCommand::Mode::VELOCITY:
      return {dt * command.kd * command.target + dt * command.feedforward, dt * command.kd};
  }
  return {};
}

void fillDefaultGains(double inertia, JointCommand& command)
{
  const double frequency = DEFAULT_SERVO_FREQUENCY;
  const bool position = command.mode == JointCommand::Mode::POSITION;
  if (std::isnan(command.kp))
    command.kp = position ? inertia * frequency * frequency : 0.0;
  if (std::isnan(command.kd))
    command.kd = (position ? 2.0 : 1.0) * inertia * frequency;
}

}  // namespace frictional_contact_sim
