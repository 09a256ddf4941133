// Commands of a body's joints: what a servo moves, where a command wants it in a step, which commands there are.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/dynamics/body.h"

namespace frictional_contact_sim
{
namespace
{
[[noreturn]] void fail(const BodyModel& model, const std::string& message)
{
  throw std::invalid_argument("body '" + model.name + "': " + message);
}
}  // namespace

double servoInertia(const BodyModel& model, const MultibodyData& data, int joint)
{
  const MultibodyModel& tree = model.tree;
  const Joint& moved = tree.joints[joint];
  const double own = data.mass_matrix(moved.v_index, moved.v_index);
  if (tree.joints.front().type != JointType::FLOATING)
    return own;
  double subtree_mass = 0.0;
  double reach = 0.0;
  const Eigen::Vector3d origin = data.link_pose[joint].translation();
  for (size_t link = joint; link < tree.links.size(); ++link)
  {
    const std::vector<int>& chain = model.chains[link];
    if (!std::binary_search(chain.begin(), chain.end(), moved.v_index))
      continue;
    subtree_mass += tree.links[link].inertia.mass;
    const Eigen::Isometry3d& pose = data.link_pose[link];
    const Eigen::Vector3d center = pose * tree.links[link].inertia.center;
    reach = std::max({reach, (pose.translation() - origin).norm(), 2.0 * (center - origin).norm()});
  }
  const double rest = tree.totalMass() - subtree_mass;
  return moved.type == JointType::PRISMATIC ? own + rest : own + rest * reach * reach;
}

JointCommand commandAt(const Body& body, int joint, double middle)
{
  const JointDrive& drive = body.state.drives[joint];
  JointCommand command = drive.command;
  if (drive.is_scheduled)
  {
    command.target = body.model.schedules[joint].target(middle);
    command.rate = body.model.schedules[joint].rate(middle);
    if (command.mode == JointCommand::Mode::EFFORT)
      command.target = std::clamp(command.target, -drive.effort_limit, drive.effort_limit);
  }
  else if (!drive.trajectory.empty())
  {
    const Joint& moved = body.model.tree.joints[joint];
    const JointMotion desired = drive.trajectory.at(middle);
    command.target = reachableTarget(moved.limit, body.state.q[moved.q_index], desired.position);
    command.rate = reachableSpeed(moved.limit, desired.velocity);
  }
  return command;
}

double reachableTarget(const JointLimit& limit, double position, double target)
{
  // A joint beyond its limits may still be sent back to them.
  const double lower = std::min(std::max(limit.lower, position - MAX_TRAVEL), limit.upper);
  const double upper = std::max(std::min(limit.upper, position + MAX_TRAVEL), limit.lower);
  return std::clamp(target, lower, upper);
}

double reachableSpeed(const JointLimit& limit, double speed)
{
  const double largest = std::min(limit.velocity, MAX_SPEED);
  return std::clamp(speed, -largest, largest);
}

JointDrive makeDrive(const BodyModel& model, int joint, const JointCommand& command)
{
  const Joint& moved = model.tree.joints[joint];
  if (!model.isActuated(joint))
    fail(model, "joint '" + moved.name + "' takes no command: it " +
                    (moved.mimic.joint >= 0 ? "mimics another" : "has not exactly one coordinate"));
  const auto check = [&](const char* what, double value, bool ok)
  {
    if (!ok)
      fail(model, "command of joint '" + moved.name + "': " + what + " is " + std::to_string(value) +
                      ", expected a finite number" + (what[0] == 't' ? "" : " >= 0"));
  };
  check("target", command.target, std::isfinite(command.target));
  check("target's rate", command.rate, std::isfinite(command.rate));
  check("torque or force fed forward", command.feedforward, std::isfinite(command.feedforward));
  check("kp", command.kp, std::isnan(command.kp) || (std::isfinite(command.kp) && command.kp >= 0.0));
  check("kd", command.kd, std::isnan(command.kd) || (std::isfinite(command.kd) && command.kd >= 0.0));
  check("max_effort", command.max_effort, command.max_effort >= 0.0);
  JointDrive drive;
  drive.command = command;
  drive.effort_limit = std::min(moved.limit.effort, command.max_effort);
  if (command.mode == JointCommand::Mode::EFFORT)
  {
    drive.command.kp = 0.0;
    drive.command.kd = 0.0;
    drive.command.target = std::clamp(command.target, -drive.effort_limit, drive.effort_limit);
  }
  else
    fillDefaultGains(model.servo_inertia[joint], drive.command);
  return drive;
}

}  // namespace frictional_contact_sim
