#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
void addPointJacobianRow(const MultibodyModel& model, const MultibodyData& data, int link, const Eigen::Vector3d& point,
                         const Eigen::Vector3d& direction, double sign, VectorOut row)
{
  if (link < 0)
    return;
  // The row is S^T of a unit force along `direction` acting at `point`.
  Vector6d force;
  force.head<3>() = sign * direction;
  force.tail<3>() = (point - data.reference).cross(force.head<3>());
  for (int k = model.link_dof[link]; k >= 0; k = model.dof_parent[k])
    row[k] += data.motion_subspace.col(k).dot(force);
}

void pointJacobian(const MultibodyModel& model, const MultibodyData& data, int link, const Eigen::Vector3d& point,
                   Eigen::Ref<Matrix6Xd> jacobian)
{
  jacobian.setZero();
  if (link < 0)
    return;
  const Eigen::Vector3d arm = point - data.reference;
  for (int k = model.link_dof[link]; k >= 0; k = model.dof_parent[k])
  {
    const Eigen::Vector3d angular = data.motion_subspace.col(k).tail<3>();
    jacobian.col(k).head<3>() = data.motion_subspace.col(k).head<3>() + angular.cross(arm);
    jacobian.col(k).tail<3>() = angular;
  }
}

Vector6d pointVelocity(const MultibodyData& data, int link, const Eigen::Vector3d& point)
{
  if (link < 0)
    return Vector6d::Zero();
  Vector6d velocity = data.link_velocity[link];
  const Eigen::Vector3d angular = velocity.tail<3>();
  velocity.head<3>() += angular.cross(point - data.reference);
  return velocity;
}

}  // namespace frictional_contact_sim
