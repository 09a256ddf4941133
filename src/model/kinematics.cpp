#include "frictional_contact_sim/model/kinematics.h"

#include <cmath>

#include "spatial.h"

namespace frictional_contact_sim
{
namespace
{
/** Rotation by `angle` about the unit vector `axis` (Rodrigues). */
Eigen::Matrix3d rotation(const Eigen::Vector3d& axis, double angle)
{
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  const Eigen::Vector3d scaled = (1.0 - cosine) * axis;
  Eigen::Matrix3d matrix;
  matrix << scaled.x() * axis.x() + cosine, scaled.x() * axis.y() - sine * axis.z(),
      scaled.x() * axis.z() + sine * axis.y(), scaled.y() * axis.x() + sine * axis.z(), scaled.y() * axis.y() + cosine,
      scaled.y() * axis.z() - sine * axis.x(), scaled.z() * axis.x() - sine * axis.y(),
      scaled.z() * axis.y() + sine * axis.x(), scaled.z() * axis.z() + cosine;
  return matrix;
}

/** Column of a rotation about `axis` through the point at `arm` from the reference. */
void setAngular(Matrix6Xd& subspace, int column, const Eigen::Vector3d& arm, const Eigen::Vector3d& axis)
{
  subspace.col(column).head<3>() = arm.cross(axis);
  subspace.col(column).tail<3>() = axis;
}

void setLinear(Matrix6Xd& subspace, int column, const Eigen::Vector3d& direction)
{
  subspace.col(column).head<3>() = direction;
  subspace.col(column).tail<3>().setZero();
}

/** Pose of the child link from the joint frame in the world; WITH_MOTION: its columns of the motion subspace as well.
 */
template <bool WITH_MOTION>
void moveJoint(const Joint& joint, const Eigen::Matrix3d& frame, const Eigen::Vector3d& origin, const double* q,
               MultibodyData& data, Eigen::Isometry3d& pose)
{
  [[maybe_unused]] Matrix6Xd& subspace = data.motion_subspace;
  [[maybe_unused]] const int v = joint.v_index;
  switch (joint.type)
  {
    case JointType::REVOLUTE:
    case JointType::CONTINUOUS:
      pose.linear().noalias() = frame * rotation(joint.axis, q[0]);
      pose.translation() = origin;
      if constexpr (WITH_MOTION)
        setAngular(subspace, v, origin - data.reference, frame * joint.axis);
      break;
    case JointType::PRISMATIC:
    {
      const Eigen::Vector3d axis = frame * joint.axis;
      pose.linear() = frame;
      pose.translation() = origin + q[0] * axis;
      if constexpr (WITH_MOTION)
        setLinear(subspace, v, axis);
      break;
    }
    case JointType::PLANAR:
    {
      const Eigen::Matrix<double, 3, 2> axes = frame * planarAxes(joint.axis);
      pose.linear().noalias() = frame * rotation(joint.axis, q[2]);
      pose.translation() = origin + q[0] * axes.col(0) + q[1] * axes.col(1);
      if constexpr (WITH_MOTION)
      {
        setLinear(subspace, v, axes.col(0));
        setLinear(subspace, v + 1, axes.col(1));
        setAngular(subspace, v + 2, pose.translation() - data.reference, frame * joint.axis);
      }
      break;
    }
    case JointType::FLOATING:
    {
      const Eigen::Map<const Eigen::Vector3d> position(q);
      const Eigen::Map<const Eigen::Quaterniond> orientation(q + 3);
      pose.linear().noalias() = frame * orientation.toRotationMatrix();
      pose.translation() = origin + frame * position;
      if constexpr (WITH_MOTION)
      {
        const Eigen::Vector3d arm = pose.translation() - data.reference;
        for (int k = 0; k < 3; ++k)
        {
          setLinear(subspace, v + k, frame.col(k));
          setAngular(subspace, v + 3 + k, arm, frame.col(k));
        }
      }
      break;
    }
    case JointType::FIXED:
      pose.linear() = frame;
      pose.translation() = origin;
      break;
  }
}

/** Quaternion of the rotation vector, by a series where sin(x)/x would divide by almost zero. */
Eigen::Quaterniond exponential(const Eigen::Vector3d& rotation_vector)
{
  const Eigen::Vector3d half = 0.5 * rotation_vector;
  const double square = half.squaredNorm();
  // Below 1e-5 the neglected terms of the series are x^4/120 < 1e-22.
  const bool small = square < 1e-10;
  const double angle = std::sqrt(square);
  const double factor = small ? 1.0 - square / 6.0 : std::sin(angle) / angle;
  Eigen::Quaterniond quaternion;
  quaternion.w() = small ? 1.0 - 0.5 * square : std::cos(angle);
  quaternion.vec() = factor * half;
  return quaternion;
}
template <bool WITH_MOTION>
void moveLinks(const MultibodyModel& model, const VectorIn& q, MultibodyData& data)
{
  if (model.links.empty())
    return;
  const Joint& root = model.joints[0];
  // The root's own joint decides where the reference is before any lever arm is taken about it.
  data.reference = data.base_pose.translation();
  if (root.type == JointType::FLOATING)
    data.reference += data.base_pose.linear() * q.segment<3>(root.q_index);
  for (size_t i = 0; i < model.links.size(); ++i)
  {
    const Joint& joint = model.joints[i];
    const Eigen::Isometry3d& placement = i == 0 ? data.base_pose : joint.placement;
    Eigen::Matrix3d frame = placement.linear();
    Eigen::Vector3d origin = placement.translation();
    if (joint.parent >= 0)
    {
      const Eigen::Isometry3d& parent = data.link_pose[joint.parent];
      frame = parent.linear() * frame;
      origin = parent.linear() * origin + parent.translation();
    }
    moveJoint<WITH_MOTION>(joint, frame, origin, q.data() + joint.q_index, data, data.link_pose[i]);
    if constexpr (WITH_MOTION)
      moveInertia(model.links[i].inertia, data.link_pose[i], data.reference, data.link_inertia[i]);
  }
}
}  // namespace

void moveInertia(const RigidInertia& inertia, const Eigen::Isometry3d& pose, const Eigen::Vector3d& reference,
                 WorldInertia& world)
{
  const Eigen::Matrix3d axes = pose.linear();
  const Eigen::Vector3d arm = axes * inertia.center + pose.translation() - reference;
  world.mass = inertia.mass;
  world.moment = inertia.mass * arm;
  const Eigen::Matrix3d half = axes * inertia.rotational;
  world.rotational.noalias() = half * axes.transpose();
  world.rotational.noalias() -= world.moment * arm.transpose();
  world.rotational.diagonal().array() += world.moment.dot(arm);
}

Eigen::VectorXd zeroPosition(const MultibodyModel& model)
{
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.nq);
  for (const Joint& joint : model.joints)
    if (joint.type == JointType::FLOATING)
      q[joint.q_index + 6] = 1.0;
  return q;
}

void forwardKinematics(const MultibodyModel& model, const VectorIn& q, MultibodyData& data)
{
  moveLinks<true>(model, q, data);
}

void computeLinkPoses(const MultibodyModel& model, const VectorIn& q, MultibodyData& data)
{
  moveLinks<false>(model, q, data);
}

void forwardVelocities(const MultibodyModel& model, const VectorIn& v, MultibodyData& data)
{
  for (size_t i = 0; i < model.links.size(); ++i)
  {
    const Joint& joint = model.joints[i];
    Vector6d velocity = Vector6d::Zero();
    if (joint.parent >= 0)
      velocity = data.link_velocity[joint.parent];
    const int end = joint.v_index + velocitySize(joint.type);
    for (int k = joint.v_index; k < end; ++k)
      velocity += v[k] * data.motion_subspace.col(k);
    data.link_velocity[i] = velocity;
  }
}

void integrate(const MultibodyModel& model, const VectorIn& q, const VectorIn& v, double dt, VectorOut q_out)
{
  for (const Joint& joint : model.joints)
  {
    const int plain = joint.type == JointType::FLOATING ? 3 : positionSize(joint.type);
    for (int k = 0; k < plain; ++k)
      q_out[joint.q_index + k] = q[joint.q_index + k] + dt * v[joint.v_index + k];
    if (joint.type == JointType::FLOATING)
    {
      const Eigen::Quaterniond orientation(q.data() + joint.q_index + 3);
      const Eigen::Vector3d turn = dt * v.segment<3>(joint.v_index + 3);
      const Eigen::Quaterniond turned = (exponential(turn) * orientation).normalized();
      q_out.segment<4>(joint.q_index + 3) = turned.coeffs();
    }
  }
}

Eigen::Isometry3d framePose(const MultibodyModel& model, const MultibodyData& data, int frame)
{
  return data.link_pose[model.frames[frame].link] * model.frames[frame].placement;
}

Eigen::Vector3d centerOfMass(const MultibodyModel& model, const MultibodyData& data)
{
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < model.links.size(); ++i)
  {
    mass += data.link_inertia[i].mass;
    moment += data.link_inertia[i].moment;
  }
  return mass > 0.0 ? Eigen::Vector3d(data.reference + moment / mass) : data.reference;
}

}  // namespace frictional_contact_sim
