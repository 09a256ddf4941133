#include "frictional_contact_sim/dynamics/servo_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/model/dynamics_algorithms.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double BOUNDED_FRACTION = 0.9;  ///< of its effort limit: from here on a servo is solved as a row
constexpr double SPEED_TOLERANCE = 1e-9;  ///< relative overshoot of a velocity limit that is round-off
constexpr double EFFORT_TOLERANCE = 1e-9;  ///< relative overshoot of an effort limit that is round-off
}  // namespace

ServoRows::ServoRows(std::vector<Body>& bodies, RowMemory& memory)
  : bodies_(bodies), memory_(name(), 1, bodies, memory), first_{0}
{
  int most_velocities = 0;
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
    followers_.push_back(findFollowers(model.tree, servo_of_.back()));
    most_velocities = std::max(most_velocities, model.tree.nv);
  }
  gravity_.resize(most_velocities);
}

/** Mimic joints by the joint that has the servo, chains of them too (circles are refused when a model is loaded). */
std::vector<ServoRows::Follower> ServoRows::findFollowers(const MultibodyModel& tree, const std::vector<int>& servo_of)
{
  std::vector<Follower> followers;
  for (const Joint& joint : tree.joints)
  {
    double multiplier = 1.0;
    int followed = -1;
    for (const Joint* link = &joint; link->mimic.joint >= 0; link = &tree.joints[followed])
    {
      multiplier *= link->mimic.multiplier;
      followed = link->mimic.joint;
    }
    if (followed >= 0 && servo_of[followed] >= 0)
      followers.push_back({servo_of[followed], joint.v_index, multiplier});
  }
  return followers;
}

double ServoRows::effort(const Servo& servo, double velocity, double dt)
{
  return (servo.impulse.offset - servo.impulse.stiffness * velocity) / dt;
}

/** [rad/s] or [m/s]; a URDF's velocity="0" means that nobody filled it in. */
double ServoRows::velocityLimit(const Servo& servo) const
{
  const double limit = bodies_[servo.body].model.tree.joints[servo.joint].limit.velocity;
  return limit > 0.0 ? limit : std::numeric_limits<double>::infinity();
}

/** Whether a drive pushes its joint beyond its velocity limit. @param most then, see Servo */
bool ServoRows::limitSpeed(const Servo& servo, const Body& body, double velocity, double dt, double& most) const
{
  const double limit = velocityLimit(servo);
  if (!(std::abs(velocity) > limit * (1.0 + SPEED_TOLERANCE)))
    return false;
  const double sign = velocity > 0.0 ? 1.0 : -1.0;
  const double wanted = servo.impulse.offset - servo.impulse.stiffness * sign * limit;
  most = sign * std::clamp(sign * wanted, 0.0, dt * body.state.drives[servo.joint].effort_limit);
  return most != 0.0;
}

void ServoRows::clear()
{
  for (Servo& servo : servos_)
  {
    servo.impulse = {};
    servo.bounded = false;
    servo.most = 0.0;
  }
}

void ServoRows::begin(const StepContext& context)
{
  for (Servo& servo : servos_)
  {
    const Body& body = bodies_[servo.body];
    const JointDrive& drive = body.state.drives[servo.joint];
    const int q_index = body.model.tree.joints[servo.joint].q_index;
    servo.impulse = servoImpulse(commandAt(body, servo.joint, context.middle), body.state.q[q_index],
                                 body.state.v[servo.v_index], context.dt);
    servo.most = 0.0;
    servo.bounded = servo.impulse.stiffness > 0.0 && std::isfinite(drive.effort_limit) &&
                    std::abs(drive.effort) >= BOUNDED_FRACTION * drive.effort_limit;
  }
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (bodies_[b].model.gravity_compensation)
      addGravity(context, static_cast<int>(b));
  for (Servo& servo : servos_)
    if (servo.impulse.stiffness == 0.0)  // no row bounds what no velocity changes
    {
      const double most = context.dt * bodies_[servo.body].state.drives[servo.joint].effort_limit;
      servo.impulse.offset = std::clamp(servo.impulse.offset, -most, most);
    }
}

void ServoRows::addGravity(const StepContext& context, int body)
{
  Body& held = bodies_[body];
  computeGravityForces(held.model.tree, context.gravity, held.middle, gravity_.head(held.model.tree.nv));
  const auto add = [&](Servo& servo, double force)
  {
    if (held.state.drives[servo.joint].command.mode != JointCommand::Mode::EFFORT)
      servo.impulse.offset += context.dt * force;
  };
  for (int k = first_[body]; k < first_[body + 1]; ++k)
    add(servos_[k], gravity_[servos_[k].v_index]);
  for (const Follower& follower : followers_[body])
    add(servos_[follower.servo], follower.multiplier * gravity_[follower.v_index]);
}

void ServoRows::addJointRows(const StepContext& context, int body, int joint, RowSink& sink)
{
  const int index = servo_of_[body][joint];
  if (context.impact || index < 0 || (!servos_[index].bounded && servos_[index].most == 0.0))
    return;
  Servo& servo = servos_[index];
  if (servo.most != 0.0)
  {
    servo.row = sink.rows();
    sink.push(bodies_[body].v_offset + servo.v_index, 1.0);
    sink.endRow(-std::copysign(velocityLimit(servo), servo.most),
                {WorkAccount::ACTUATORS, 0.0, memory_.at(body, joint)});
    sink.endLaw({LawType::DRY_FRICTION, 0.5 * std::abs(servo.most)}, jointUnit(bodies_[body], joint));
    countAsForce(context, bodies_[body], servo);
    return;
  }
  servo.row = sink.rows();
  sink.push(bodies_[body].v_offset + servo.v_index, 1.0);
  sink.push(sink.addAuxiliary(servo.impulse.stiffness), -1.0);
  sink.endRow(-servo.impulse.offset / servo.impulse.stiffness, {WorkAccount::ACTUATORS, 0.0, memory_.at(body, joint)});
  sink.endLaw({LawType::DRY_FRICTION, context.dt * bodies_[body].state.drives[joint].effort_limit},
              {VelocityUnit::SLACK, jointUnit(bodies_[body], joint).reach});
  countAsForce(context, bodies_[body], servo);
}

/**
 * A row or not, the servo is a smooth force, of at most its limit: speeds that the residual is measured with know it.
 * A robot that rests in its servos has no other, and 1e-12 m/s is no measure for a motion at full effort.
 */
void ServoRows::countAsForce(const StepContext& context, Body& body, const Servo& servo)
{
  body.change.setZero();
  body.change[servo.v_index] = context.dt * body.state.drives[servo.joint].effort_limit;
  solveMassMatrix(body.model.tree, body.middle, body.change);
  const double speed = pointSpeed(body, body.change);
  body.speed_change = std::max(body.speed_change, speed);
  body.speed = std::max(body.speed, speed);
}

void ServoRows::addMomentum(const StepContext&, int body, VectorOut momentum)
{
  for (int k = first_[body]; k < first_[body + 1]; ++k)
  {
    const Servo& servo = servos_[k];
    if (servo.most != 0.0)
      momentum[servo.v_index] += 0.5 * servo.most;
    if (servo.bounded || servo.most != 0.0)
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
    if (servo.most != 0.0)
      continue;
    const Body& body = bodies_[servo.body];
    if (limitSpeed(servo, body, solution.v[body.v_offset + servo.v_index], context.dt, servo.most))
    {
      again = Again::FROM_GUESS;
      continue;
    }
    if (servo.bounded || servo.impulse.stiffness == 0.0)
      continue;
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
    if (servo.most != 0.0)
      drive.effort = (0.5 * servo.most + answer.solution.r[servo.row]) / context.dt;
    else
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
    if (servo.most != 0.0)
      ledger.actuators += 0.5 * servo.most * bodies_[body].v_middle[servo.v_index];
    if (servo.bounded || servo.most != 0.0)
      continue;
    const double velocity = solution.v[bodies_[body].v_offset + servo.v_index];
    ledger.actuators +=
        (servo.impulse.offset - servo.impulse.stiffness * velocity) * bodies_[body].v_middle[servo.v_index];
  }
}

}  // namespace frictional_contact_sim
