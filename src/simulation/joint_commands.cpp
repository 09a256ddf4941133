// Commands of joints from outside, between steps.
#include "simulator_impl.h"

namespace frictional_contact_sim
{
namespace
{
/** A new command leaves the effort of the last step alone. */
void setDrive(JointDrive& drive, JointDrive next)
{
  next.effort = drive.effort;
  drive = std::move(next);
}
}  // namespace

void Simulator::setCommand(int body, int joint, const JointCommand& command)
{
  setDrive(impl_->state.bodies[body].drives[joint], makeDrive(impl_->bodies[body].model, joint, command));
}

const JointCommand& Simulator::command(int body, int joint) const
{
  return impl_->state.bodies[body].drives[joint].command;
}

void Simulator::followTrajectory(int body, int joint, const JointCommand& servo, double begin,
                                 const JointTrajectory& next)
{
  next.validate();
  const JointMotion rest = desiredMotion(body, joint);
  JointCommand command = servo;
  command.mode = JointCommand::Mode::POSITION;
  command.target = rest.position;
  JointDrive drive = makeDrive(impl_->bodies[body].model, joint, command);
  drive.trajectory = continued(trajectory(body, joint), rest, scenarioTime(), begin, next);
  setDrive(impl_->state.bodies[body].drives[joint], std::move(drive));
}

void Simulator::stopTrajectory(int body, int joint)
{
  JointDrive& drive = impl_->state.bodies[body].drives[joint];
  if (drive.trajectory.empty())
    return;
  drive.command.target = drive.trajectory.at(scenarioTime()).position;
  drive.trajectory.points.clear();
}

const JointTrajectory& Simulator::trajectory(int body, int joint) const
{
  return impl_->state.bodies[body].drives[joint].trajectory;
}

JointMotion Simulator::desiredMotion(int body, int joint) const
{
  const BodyModel& model = impl_->bodies[body].model;
  const BodyState& state = impl_->state.bodies[body];
  const JointDrive& drive = state.drives[joint];
  if (!drive.trajectory.empty())
    return drive.trajectory.at(scenarioTime());
  if (drive.command.mode != JointCommand::Mode::POSITION)
    return {state.q[model.tree.joints[joint].q_index], state.v[model.velocityIndex(joint)], 0.0};
  if (drive.is_scheduled)
    return {model.schedules[joint].target(scenarioTime()), model.schedules[joint].rate(scenarioTime()), 0.0};
  return {drive.command.target, 0.0, 0.0};
}

double Simulator::scenarioTime() const
{
  return impl_->state.scenario_clock.time(impl_->state.dt);
}

}  // namespace frictional_contact_sim
