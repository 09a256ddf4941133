#include "frictional_contact_sim/ros/conversions.h"

#include <cmath>

#include "frictional_contact_sim/simulation/root_motion.h"

namespace frictional_contact_sim
{
const char* const WORLD_FRAME = "world";

void fillVector(const Eigen::Vector3d& source, geometry_msgs::Vector3& target)
{
  target.x = source.x();
  target.y = source.y();
  target.z = source.z();
}

geometry_msgs::Point toPoint(const Eigen::Vector3d& source)
{
  geometry_msgs::Point point;
  point.x = source.x();
  point.y = source.y();
  point.z = source.z();
  return point;
}

namespace
{
void fillPoint(const Eigen::Vector3d& source, geometry_msgs::Point& target)
{
  target.x = source.x();
  target.y = source.y();
  target.z = source.z();
}

void fillQuaternion(const Eigen::Matrix3d& rotation, geometry_msgs::Quaternion& target)
{
  const Eigen::Quaterniond quaternion(rotation);
  target.x = quaternion.x();
  target.y = quaternion.y();
  target.z = quaternion.z();
  target.w = quaternion.w();
}

void fillHeader(const ros::Time& stamp, std_msgs::Header& header)
{
  header.stamp = stamp;
  header.frame_id = WORLD_FRAME;
}

void fillSide(const ShapeInfo& shape, const NameTable& names, std::string& body, std::string& link,
              std::string& collision)
{
  if (shape.body >= 0)
    body = names.bodies[shape.body];
  else
    body.clear();
  link = shape.link_name;
  collision = shape.name;
}

std::uint8_t toMessage(ContactMode mode)
{
  switch (mode)
  {
    case ContactMode::STICKING:
      return Contact::STICKING;
    case ContactMode::SLIDING:
      return Contact::SLIDING;
    case ContactMode::IMPACT:
      return Contact::IMPACT;
    case ContactMode::OPEN:
      break;
  }
  return Contact::OPEN;
}

/** @param swapped side b comes first */
void fillContact(const Simulator& simulator, const NameTable& names, const ContactState& source, bool swapped,
                 Contact& target)
{
  const double sign = swapped ? -1.0 : 1.0;
  const double dt = impulseTime(simulator);
  const ShapeInfo& first = simulator.shape(swapped ? source.shape_b : source.shape_a);
  const ShapeInfo& second = simulator.shape(swapped ? source.shape_a : source.shape_b);
  target.id = source.id.number();
  fillSide(first, names, target.body_a, target.link_a, target.collision_a);
  fillSide(second, names, target.body_b, target.link_b, target.collision_b);
  fillPoint(source.position, target.position);
  fillVector(sign * source.normal, target.normal);
  target.gap = source.gap;
  target.friction = source.friction;
  target.restitution = source.restitution;
  fillVector(sign * source.impulse / dt, target.force);
  fillVector(sign * source.impulse, target.impulse);
  fillVector(sign * source.velocity, target.relative_velocity);
  target.mode = toMessage(source.mode);
  target.residual = source.residual;
  target.cone_margin = source.cone_margin;
}

std::uint8_t toMessage(SolverStatus status)
{
  switch (status)
  {
    case SolverStatus::CONVERGED:
      return StepReport::CONVERGED;
    case SolverStatus::MAX_ITERATIONS:
      return StepReport::MAX_ITERATIONS;
    case SolverStatus::TIME_LIMIT:
      return StepReport::TIME_LIMIT;
    case SolverStatus::STAGNATED:
      return StepReport::STAGNATED;
    case SolverStatus::NUMERICAL_FAILURE:
      return StepReport::NUMERICAL_FAILURE;
    case SolverStatus::STOPPED_BY_USER:
      return StepReport::STOPPED_BY_USER;
    case SolverStatus::NOT_RUN:
      break;
  }
  return StepReport::NOT_RUN;
}

}  // namespace

std::uint8_t toMessage(Existence existence)
{
  switch (existence)
  {
    case Existence::CERTIFIED:
      return StepReport::CERTIFIED;
    case Existence::REFUTED:
      return StepReport::REFUTED;
    case Existence::UNDECIDED:
      break;
  }
  return StepReport::UNDECIDED;
}

std::uint8_t toMessage(Uniqueness uniqueness)
{
  switch (uniqueness)
  {
    case Uniqueness::UNIQUE_V:
      return StepReport::CERTIFIED;
    case Uniqueness::MULTIPLE:
      return StepReport::REFUTED;
    case Uniqueness::UNKNOWN:
      break;
  }
  return StepReport::UNDECIDED;
}

double impulseTime(const Simulator& simulator)
{
  const double dt = simulator.report().dt;
  return dt > 0.0 ? dt : simulator.scenario().time_step;
}

ros::Time toStamp(double seconds)
{
  ros::Time stamp;
  stamp.fromNSec(static_cast<std::uint64_t>(std::llround(seconds * 1e9)));
  return stamp;
}

void fillJointState(const Simulator& simulator, const NameTable& names, const ros::Time& stamp,
                    sensor_msgs::JointState& message)
{
  message.header.stamp = stamp;  // no frame: joint coordinates have none
  const size_t count = names.joints.size();
  if (message.name.size() != count)
  {
    message.name.resize(count);
    message.position.resize(count);
    message.velocity.resize(count);
    message.effort.resize(count);
    for (size_t i = 0; i < count; ++i)
      message.name[i] = names.joints[i].name;
  }
  for (size_t i = 0; i < count; ++i)
  {
    const JointHandle& joint = names.joints[i];
    message.position[i] = simulator.position(joint.body)[joint.q_index];
    message.velocity[i] = simulator.velocity(joint.body)[joint.v_index];
    message.effort[i] = simulator.effort(joint.body, joint.joint);
  }
}

void fillContacts(const Simulator& simulator, const NameTable& names, const ros::Time& stamp, ContactArray& message)
{
  fillHeader(stamp, message.header);
  const std::vector<ContactState>& contacts = simulator.contacts();
  message.contacts.resize(contacts.size());
  for (size_t i = 0; i < contacts.size(); ++i)
    fillContact(simulator, names, contacts[i], false, message.contacts[i]);
}

void fillPose(const Eigen::Isometry3d& pose, geometry_msgs::Pose& message)
{
  fillPoint(pose.translation(), message.position);
  fillQuaternion(pose.linear(), message.orientation);
}

void fillLinkContacts(const Simulator& simulator, const NameTable& names, int body, int frame, const ros::Time& stamp,
                      ContactArray& message)
{
  fillHeader(stamp, message.header);
  const auto is_link = [&](int handle)
  { return simulator.shape(handle).body == body && simulator.shape(handle).frame == frame; };
  size_t count = 0;
  for (const ContactState& contact : simulator.contacts())
  {
    const bool swapped = is_link(contact.shape_b);
    if (!swapped && !is_link(contact.shape_a))
      continue;
    if (message.contacts.size() == count)
      message.contacts.emplace_back();
    fillContact(simulator, names, contact, swapped, message.contacts[count++]);
  }
  message.contacts.resize(count);
}

void fillWrench(const Vector6d& wrench, const std::string& frame_id, const ros::Time& stamp,
                geometry_msgs::WrenchStamped& message)
{
  message.header.stamp = stamp;
  message.header.frame_id = frame_id;
  fillVector(wrench.head<3>(), message.wrench.force);
  fillVector(wrench.tail<3>(), message.wrench.torque);
}

void fillStepReport(const StepSummary& summary, double real_time_factor, const ros::Time& stamp, StepReport& message)
{
  fillHeader(stamp, message.header);
  message.step = summary.step;
  message.dt = summary.dt;
  message.real_time_factor = real_time_factor;
  message.contacts = static_cast<std::uint32_t>(summary.contacts);
  message.contact_rounds = static_cast<std::uint32_t>(summary.contact_rounds);
  message.velocities = static_cast<std::uint32_t>(summary.velocities);
  message.bilaterals = static_cast<std::uint32_t>(summary.bilaterals);
  message.islands = static_cast<std::uint32_t>(summary.islands);
  message.solver = summary.solver;
  message.solvers_tried = summary.solvers_tried;
  message.status = toMessage(summary.status);
  message.iterations = summary.iterations;
  message.residual = summary.residual;
  message.solve_time = summary.solve_time;
  message.bilateral_violation = summary.bilateral_violation;
  message.max_penetration = summary.max_penetration;
  const StepCertificate& certificate = summary.certificate;
  message.existence = StepReport::NOT_CHECKED;
  message.uniqueness = StepReport::NOT_CHECKED;
  message.existence_margin = 0.0;
  if (certificate.checked)
  {
    message.existence = toMessage(certificate.existence);
    message.existence_margin = certificate.margin;
    message.uniqueness = toMessage(certificate.uniqueness);
  }
  message.kinetic = summary.energy.kinetic;
  message.potential = summary.energy.potential;
  message.actuators = summary.energy.actuators;
  message.friction = summary.energy.friction;
  message.impact = summary.energy.impact;
  message.joints = summary.energy.joints;
  message.balance_error = summary.energy.balance_error;
  message.fclib_file = summary.fclib_file;
}

void fillOdometry(const Simulator& simulator, const NameTable& names, int body, const ros::Time& stamp,
                  nav_msgs::Odometry& message)
{
  fillHeader(stamp, message.header);
  message.child_frame_id = names.roots[body];
  const Eigen::Isometry3d pose = rootPose(simulator, body);
  fillPoint(pose.translation(), message.pose.pose.position);
  fillQuaternion(pose.linear(), message.pose.pose.orientation);
  const Vector6d velocity = rootVelocity(simulator, body);
  fillVector(pose.linear().transpose() * velocity.head<3>(), message.twist.twist.linear);
  fillVector(pose.linear().transpose() * velocity.tail<3>(), message.twist.twist.angular);
}

void fillTransform(const Eigen::Isometry3d& pose, geometry_msgs::Transform& message)
{
  fillVector(pose.translation(), message.translation);
  fillQuaternion(pose.linear(), message.rotation);
}

}  // namespace frictional_contact_sim
