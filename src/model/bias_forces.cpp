#include "frictional_contact_sim/model/dynamics_algorithms.h"
#include "spatial.h"

namespace frictional_contact_sim
{
namespace
{
/**
 * dS/dt v of one joint at the fixed point `reference`: the acceleration of the child relative to its parent when the
 * velocity coordinates are constant. A column fixed in a link of velocity V changes at the rate V x column; the axes of
 * a floating joint are fixed in the parent, but its rotations pass through the moving child origin.
 */
Vector6d velocityProduct(const Joint& joint, const VectorIn& v, const Vector6d& parent, const Vector6d& child,
                         const Eigen::Vector3d& child_arm, const Matrix6Xd& subspace)
{
  const int k = joint.v_index;
  switch (joint.type)
  {
    case JointType::REVOLUTE:
    case JointType::CONTINUOUS:
    case JointType::PRISMATIC:
      return crossMotion(parent, v[k] * subspace.col(k));
    case JointType::PLANAR:
      return crossMotion(parent, v[k] * subspace.col(k) + v[k + 1] * subspace.col(k + 1)) +
             crossMotion(child, v[k + 2] * subspace.col(k + 2));
    case JointType::FLOATING:
    {
      Eigen::Vector3d linear = Eigen::Vector3d::Zero();
      Eigen::Vector3d angular = Eigen::Vector3d::Zero();
      for (int i = 0; i < 3; ++i)
      {
        linear += v[k + i] * subspace.col(k + i).head<3>();
        angular += v[k + 3 + i] * subspace.col(k + 3 + i).tail<3>();
      }
      const Eigen::Vector3d parent_angular = parent.tail<3>();
      const Eigen::Vector3d child_angular = child.tail<3>();
      const Eigen::Vector3d origin_velocity = child.head<3>() + child_angular.cross(child_arm);
      Vector6d product;
      product.tail<3>() = parent_angular.cross(angular);
      product.head<3>() =
          parent_angular.cross(linear) + origin_velocity.cross(angular) + child_arm.cross(product.tail<3>());
      return product;
    }
    case JointType::FIXED:
      break;
  }
  return Vector6d::Zero();
}

/** Forces of the links (data.link_force) to generalized ones, leaves first; sums those of subtrees. */
void projectLinkForces(const MultibodyModel& model, MultibodyData& data, VectorOut forces)
{
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i)
  {
    const Joint& joint = model.joints[i];
    const int end = joint.v_index + velocitySize(joint.type);
    for (int k = joint.v_index; k < end; ++k)
      forces[k] = data.motion_subspace.col(k).dot(data.link_force[i]);
    if (joint.parent >= 0)
      data.link_force[joint.parent] += data.link_force[i];
  }
}
}  // namespace

void computeBiasForces(const MultibodyModel& model, const VectorIn& v, const Eigen::Vector3d& gravity,
                       MultibodyData& data, VectorOut bias)
{
  forwardVelocities(model, v, data);
  const int links = static_cast<int>(model.links.size());
  for (int i = 0; i < links; ++i)
  {
    const Joint& joint = model.joints[i];
    const Vector6d& velocity = data.link_velocity[i];
    Vector6d& acceleration = data.link_acceleration[i];
    Vector6d parent_velocity = Vector6d::Zero();
    if (joint.parent >= 0)
    {
      parent_velocity = data.link_velocity[joint.parent];
      acceleration = data.link_acceleration[joint.parent];
    }
    else
    {
      // Gravity is the acceleration of the world, turned round.
      acceleration << -gravity, Eigen::Vector3d::Zero();
    }
    const Eigen::Vector3d arm = data.link_pose[i].translation() - data.reference;
    acceleration += velocityProduct(joint, v, parent_velocity, velocity, arm, data.motion_subspace);
    const WorldInertia& inertia = data.link_inertia[i];
    data.link_force[i] = multiply(inertia, acceleration) + crossForce(velocity, multiply(inertia, velocity));
  }
  projectLinkForces(model, data, bias);
}

void computeGravityForces(const MultibodyModel& model, const Eigen::Vector3d& gravity, MultibodyData& data,
                          VectorOut forces)
{
  Vector6d acceleration;
  acceleration << -gravity, Eigen::Vector3d::Zero();
  for (size_t i = 0; i < model.links.size(); ++i)
    data.link_force[i] = multiply(data.link_inertia[i], acceleration);
  projectLinkForces(model, data, forces);
}

void computeLinkAccelerations(const MultibodyModel& model, const VectorIn& v, const VectorIn& rate, MultibodyData& data)
{
  forwardVelocities(model, v, data);
  for (size_t i = 0; i < model.links.size(); ++i)
  {
    const Joint& joint = model.joints[i];
    const bool is_root = joint.parent < 0;
    const Vector6d parent_velocity = is_root ? Vector6d(Vector6d::Zero()) : data.link_velocity[joint.parent];
    Vector6d& acceleration = data.link_acceleration[i];
    acceleration = is_root ? Vector6d(Vector6d::Zero()) : data.link_acceleration[joint.parent];
    const Eigen::Vector3d arm = data.link_pose[i].translation() - data.reference;
    acceleration += velocityProduct(joint, v, parent_velocity, data.link_velocity[i], arm, data.motion_subspace);
    const int end = joint.v_index + velocitySize(joint.type);
    for (int k = joint.v_index; k < end; ++k)
      acceleration += rate[k] * data.motion_subspace.col(k);
  }
}

void addWrench(const MultibodyModel& model, const MultibodyData& data, int link, const Eigen::Vector3d& point,
               const Eigen::Vector3d& force, const Eigen::Vector3d& torque, VectorOut tau)
{
  if (link < 0)
    return;
  Vector6d wrench;
  wrench.head<3>() = force;
  wrench.tail<3>() = torque + (point - data.reference).cross(force);
  for (int k = model.link_dof[link]; k >= 0; k = model.dof_parent[k])
    tau[k] += data.motion_subspace.col(k).dot(wrench);
}

double kineticEnergy(const MultibodyModel& model, const MultibodyData& data, const VectorIn& v)
{
  double energy = 0.5 * model.armature.dot(v.cwiseAbs2());
  for (size_t i = 0; i < model.links.size(); ++i)
    energy += 0.5 * data.link_velocity[i].dot(multiply(data.link_inertia[i], data.link_velocity[i]));
  return energy;
}

double potentialEnergy(const MultibodyModel& model, const MultibodyData& data, const Eigen::Vector3d& gravity)
{
  double energy = 0.0;
  for (size_t i = 0; i < model.links.size(); ++i)
  {
    const WorldInertia& inertia = data.link_inertia[i];
    energy -= gravity.dot(inertia.mass * data.reference + inertia.moment);
  }
  return energy;
}

}  // namespace frictional_contact_sim
