#include "frictional_contact_sim/ros/state_services.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/config/number_range.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/ros/conversions.h"
#include "frictional_contact_sim/ros/services.h"
#include "request_fields.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LIMIT_ROUNDING = 1e-6;  // a position that was read off a joint at its limit [rad] or [m]
constexpr double VISIBLE_OVERLAP = 1e-6;  // [m]

/** q and v have been written: the impact solve, or the state as it was and the reason. @return what is worth saying */
std::string takeWritten(Simulator& simulator)
{
  const StepOutcome& outcome = simulator.stateChanged();
  if (!outcome.taken)
    throw RequestError("the impact of the new state has no answer: " + outcome.message);
  if (!outcome.converged())
    return "the impact of the new state has no answer, held by ~on_failure: " + outcome.message;
  const double overlap = simulator.report().max_penetration;
  return overlap > VISIBLE_OVERLAP ? "bodies overlap by " + numberText(overlap) + " m: they are pushed out slowly" : "";
}

/** Mimic joints take position and velocity of what they follow, which may follow another one. */
void followMimics(const MultibodyModel& model, Eigen::VectorXd& q, Eigen::VectorXd& v)
{
  for (size_t round = 0; round < model.joints.size(); ++round)
    for (const Joint& joint : model.joints)
      if (joint.mimic.joint >= 0)
      {
        const Joint& followed = model.joints[joint.mimic.joint];
        q[joint.q_index] = joint.mimic.multiplier * q[followed.q_index] + joint.mimic.offset;
        v[joint.v_index] = joint.mimic.multiplier * v[followed.v_index];
      }
}

/** Index into names.joints of a joint that can be set. */
int requireJoint(const NameTable& names, int body, const std::string& name)
{
  const int index = findJoint(names, names.bodies[body] + "/" + name);
  const int found = index >= 0 ? index : findJoint(names, name);
  if (found < 0 || names.joints[found].body != body)
  {
    std::vector<std::string> known;
    for (const JointHandle& joint : names.joints)
      if (joint.body == body && !joint.mimic)
        known.push_back(joint.name);
    throw RequestError("names: found '" + inOneLine(name) + "', " + didYouMean(name, known) + "expected joints of '" +
                       names.bodies[body] + "': " + inOneLine(joinNames(known)));
  }
  if (names.joints[found].mimic)
    throw RequestError("names: joint '" + name + "' mimics another one, expected that one");
  return found;
}

struct JointState
{
  const Joint& joint;
  double position = 0.0;
  double velocity = 0.0;
};

std::vector<JointState> readJoints(const SetJointPositions::Request& request, const NameTable& names, int body,
                                   const MultibodyModel& model)
{
  if (request.names.empty())
    throw RequestError("names: found none, expected at least one joint");
  if (request.positions.size() != request.names.size())
    throw RequestError("positions: found " + std::to_string(request.positions.size()) + " numbers, expected " +
                       std::to_string(request.names.size()) + ", one a name");
  if (!request.velocities.empty() && request.velocities.size() != request.names.size())
    throw RequestError("velocities: found " + std::to_string(request.velocities.size()) + " numbers, expected " +
                       std::to_string(request.names.size()) + ", one a name, or none");
  std::set<int> seen;
  std::vector<JointState> joints;
  for (size_t i = 0; i < request.names.size(); ++i)
  {
    const std::string& name = request.names[i];
    const int index = requireJoint(names, body, name);
    if (!seen.insert(index).second)
      throw RequestError("names: joint '" + name + "' is there twice");
    const Joint& joint = model.joints[names.joints[index].joint];
    const double position = request.positions[i];
    const double velocity = request.velocities.empty() ? 0.0 : request.velocities[i];
    requireWithin("positions: joint '" + name + "'", position, LARGEST_SPEED, "rad or m");
    requireWithin("velocities: joint '" + name + "'", velocity, LARGEST_SPEED, "rad/s or m/s");
    if (position < joint.limit.lower - LIMIT_ROUNDING || position > joint.limit.upper + LIMIT_ROUNDING)
      throw RequestError("positions: joint '" + name + "': found " + numberText(position) +
                         ", expected within its limits " + numberText(joint.limit.lower) + " to " +
                         numberText(joint.limit.upper));
    joints.push_back({joint, position, velocity});
  }
  return joints;
}
}  // namespace

void storeState(const SaveState::Request& request, const Simulator& simulator, StateSlot& slot,
                SaveState::Response& response)
{
  if (request.file.empty())
    slot = SavedState{simulator.state(), simulator.settings()};
  else
    saveState(simulator, request.file);
  response.stamp = toStamp(simulator.time());
}

void restoreState(const LoadState::Request& request, const StateSlot& slot, Simulator& simulator,
                  LoadState::Response& response)
{
  if (request.file.empty() && !slot)
    throw RequestError("file: found '', and nothing was saved in memory yet");
  SavedState saved = request.file.empty() ? *slot : readState(simulator, request.file);
  SimulationState& state = saved.state;
  const ros::Time stamp = toStamp(state.time());
  state.step = std::max(state.step, simulator.state().step);
  if (state.time() < simulator.time())
    state.clock.restart(simulator.time());
  simulator.setState(state, saved.settings);
  response.stamp = stamp;
}

void placeLink(const SetLinkState::Request& request, const NameTable& names, FrameResolver& frames,
               Simulator& simulator, SetLinkState::Response& response)
{
  const LinkHandle link = requireLinkOrRoot(simulator, names, request.body, request.link);
  const MultibodyModel& model = simulator.model(link.body);
  if (model.joints.front().type != JointType::FLOATING)
    throw RequestError("body: '" + names.bodies[link.body] + "' has a fixed base, expected a floating one");
  const Eigen::Isometry3d frame = frames.pose("frame_id", request.frame_id);
  const Eigen::Isometry3d pose = frame * readPose("pose", request.pose);
  const Eigen::Vector3d linear =
      frame.linear() * readVector("twist.linear", request.twist.linear, LARGEST_SPEED, "m/s");
  const Eigen::Vector3d angular =
      frame.linear() * readVector("twist.angular", request.twist.angular, LARGEST_SPEED, "rad/s");

  // The base where the link's pose in it, which the joints say, gives the link its pose.
  const Eigen::Isometry3d root = simulator.data(link.body).link_pose.front();
  const Eigen::Isometry3d new_root = pose * linkPose(simulator, link).inverse() * root;
  Eigen::VectorXd q = simulator.position(link.body);
  q.head<3>() = new_root.translation();
  q.segment<4>(3) = Eigen::Quaterniond(new_root.linear()).normalized().coeffs();
  // The velocity that the joints alone give the link; the base adds the rest.
  Eigen::VectorXd v = simulator.velocity(link.body);
  v.head<6>().setZero();
  MultibodyData data(model);
  forwardKinematics(model, q, data);
  forwardVelocities(model, v, data);
  const Vector6d by_joints = pointVelocity(data, model.frames[link.frame].link, pose.translation());
  const Eigen::Vector3d turn = angular - by_joints.tail<3>();
  v.head<3>() = linear - by_joints.head<3>() - turn.cross(pose.translation() - new_root.translation());
  v.segment<3>(3) = turn;

  simulator.position(link.body) = q;
  simulator.velocity(link.body) = v;
  response.message = takeWritten(simulator);
}

void readLinkState(const GetLinkState::Request& request, const NameTable& names, FrameResolver& frames,
                   const Simulator& simulator, GetLinkState::Response& response)
{
  const LinkHandle link = requireLinkOrRoot(simulator, names, request.body, request.link);
  const Eigen::Isometry3d frame = frames.pose("frame_id", request.frame_id);
  const Eigen::Isometry3d pose = linkPose(simulator, link);
  const Vector6d twist =
      pointVelocity(simulator.data(link.body), simulator.model(link.body).frames[link.frame].link, pose.translation());
  response.header.stamp = std::max(ros::TIME_MIN, toStamp(simulator.time()));
  response.header.frame_id = request.frame_id.empty() ? WORLD_FRAME : request.frame_id;
  response.pose = toMessage(frame.inverse() * pose);
  response.twist =
      toMessage(frame.linear().transpose() * twist.head<3>(), frame.linear().transpose() * twist.tail<3>());
}

void setJointPositions(const SetJointPositions::Request& request, const NameTable& names, Simulator& simulator,
                       SetJointPositions::Response& response)
{
  const int body = requireBody(names, request.body);
  const MultibodyModel& model = simulator.model(body);
  Eigen::VectorXd q = simulator.position(body);
  Eigen::VectorXd v = simulator.velocity(body);
  for (const JointState& set : readJoints(request, names, body, model))
  {
    q[set.joint.q_index] = set.position;
    v[set.joint.v_index] = set.velocity;
  }
  followMimics(model, q, v);
  simulator.position(body) = q;
  simulator.velocity(body) = v;
  response.message = takeWritten(simulator);
}

}  // namespace frictional_contact_sim
