#include "frictional_contact_sim/dynamics/servo_rows.h"

#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr double BOUNDED_FRACTION = 0.9;  ///< of its effort limit: from here on a servo is solved as a row
constexpr double EFFORT_TOLERANCE = 1e-9;  ///< relative overshoot of an effort limit that is round-off
}  // namespace

ServoRows::ServoRows(std::vector<Body>& bodies, RowMemory& memory)
  : bodies_(bodies), memory_(name(), 1, bodies, memory), first_{0}
{
  for (size_t b = 0; b < bodies.size(); ++b)
  {
    const BodyModel& model = bodies[b].model;
    servo_of_.emplace_back(model.tree.joints.size(), -1);
    for (int j = 0; j < static_cast<int>(model.tree.joints.size()); ++j)
    {
      if (!model.isActuated(j))
        continue;
      servo_of_.back()[j] = static_cast<int>(servos_.size());
      servos_.push_back({static_cast<int>(b), j, model.velocityIndex(j), {}});
    }
    first_.push_back(static_cast<int>(servos_.size()));
  }
}

double ServoRows::effort(const Servo& servo, double velocity, double dt)
{
  return (servo.impulse.offset - servo.impulse.stiffness * velocity) / dt;
}

void ServoRows::clear()
{
  for (Servo& servo : servos_)
  {
    servo.impulse = {};
    servo.bounded = false;
  }
}

void ServoRows::begin(const StepContext& context)
{
  for (Servo& servo : servos_)
  {
    const Body& body = bodies_[servo.body];
    const JointDrive& drive = body.state.drives[servo.joint];
    const int q_index = body.model.tree.joints[servo.joint].q_index;
    servo.impulse =
        servoImpulse(commandAt(body, servo.joint, context.middle), body.state.q[q_index], body.state.v[servo.v_index],
                     context.dt, commandRate(body, servo.joint, context.middle));
    servo.bounded = servo.impulse.stiffness > 0.0 && std::isfinite(drive.effort_limit) &&
                    std::abs(drive.effort) >= BOUNDED_FRACTION * drive.effort_limit;
  }
}

void ServoRows::addJointRows(const StepContext& context, int body, int joint, RowSink& sink)
{
  const int index = servo_of_[body][joint];
  if (context.impact || index < 0 || !servos_[index].bounded)
    return;
  Servo& servo = servos_[index];
  servo.row = sink.rows();
  sink.push(bodies_[body].v_offset + servo.v_index, 1.0);
  sink.push(sink.addAuxiliary(servo.impulse.stiffness), -1.0);
  sink.endRow(-servo.impulse.offset / servo.impulse.stiffness, {WorkAccount::ACTUATORS, 0.0, memory_.at(body, joint)});
  sink.endLaw({LawType::DRY_FRICTION, context.dt * bodies_[body].state.drives[joint].effort_limit},
              {VelocityUnit::SLACK, jointUnit(bodies_[body], joint).reach});
}

void ServoRows::addMomentum(const StepContext&, int body, VectorOut momentum)
{
  for (int k = first_[body]; k < first_[body + 1]; ++k)
  {
    const Servo& servo = servos_[k];
    if (servo.bounded)
      continue;
    bodies_[body].implicit[servo.v_index] += servo.impulse.stiffness;
    momentum[servo.v_index] += servo.impulse.offset;
  }
}

Again ServoRows::again(const StepContext& context, const Solution& solution, bool)
{
  Again again = Again::NO;
  for (Servo& servo : servos_)
  {
    if (servo.bounded || servo.impulse.stiffness == 0.0)
      continue;
    const Body& body = bodies_[servo.body];
    const double limit = body.state.drives[servo.joint].effort_limit;
    if (std::abs(effort(servo, solution.v[body.v_offset + servo.v_index], context.dt)) >
        limit * (1.0 + EFFORT_TOLERANCE))
    {
      servo.bounded = true;
      again = Again::FROM_GUESS;
    }
  }
  return again;
}

void ServoRows::accept(const StepContext& context, const StepAnswer& answer)
{
  for (const Servo& servo : servos_)
  {
    Body& body = bodies_[servo.body];
    JointDrive& drive = body.state.drives[servo.joint];
    if (!context.impact)
      drive.command.target = commandAt(body, servo.joint, context.middle).target;
    drive.effort = servo.bounded ? answer.solution.r[servo.row] / context.dt
                                 : effort(servo, answer.solution.v[body.v_offset + servo.v_index], context.dt);
    // Of an answer beyond its round-off (1e-9) already; of a step that is held, or accepted without an answer, far.
    if (servo.impulse.stiffness > 0.0 && std::abs(drive.effort) > drive.effort_limit * (1.0 + EFFORT_TOLERANCE))
      drive.effort = std::copysign(drive.effort_limit, drive.effort);
    if (!std::isfinite(drive.effort))
      drive.effort = 0.0;
  }
}

void ServoRows::book(const StepContext&, int body, const Solution& solution, EnergyLedger& ledger) const
{
  for (int k = first_[body]; k < first_[body + 1]; ++k)
  {
    const Servo& servo = servos_[k];
    if (servo.bounded)
      continue;
    const double velocity = solution.v[bodies_[body].v_offset + servo.v_index];
    ledger.actuators +=
        (servo.impulse.offset - servo.impulse.stiffness * velocity) * bodies_[body].v_middle[servo.v_index];
  }
}

}  // namespace frictional_contact_sim
