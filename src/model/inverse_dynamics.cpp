#include "frictional_contact_sim/model/inverse_dynamics.h"

#include "frictional_contact_sim/model/kinematics.h"
#include "spatial.h"

namespace frictional_contact_sim
{
void computeJointWrenches(const MultibodyModel& model, const MultibodyData& data, const Eigen::Vector3d& gravity,
                          const std::vector<Vector6d>& applied, std::vector<Vector6d>& wrenches)
{
  const int frames = static_cast<int>(model.frames.size());
  wrenches.resize(frames);
  WorldInertia inertia;
  for (int i = 0; i < frames; ++i)
  {
    const int link = model.frames[i].link;
    moveInertia(model.frames[i].inertia, framePose(model, data, i), data.reference, inertia);
    Vector6d acceleration = data.link_acceleration[link];
    acceleration.head<3>() -= gravity;
    const Vector6d& velocity = data.link_velocity[link];
    wrenches[i] = multiply(inertia, acceleration) + crossForce(velocity, multiply(inertia, velocity)) - applied[i];
  }
  for (int i = frames - 1; i >= 0; --i)
    if (model.frames[i].parent >= 0)
      wrenches[model.frames[i].parent] += wrenches[i];
}

Vector6d localWrench(const MultibodyData& data, const Eigen::Isometry3d& pose, const Vector6d& wrench)
{
  const Eigen::Vector3d force = wrench.head<3>();
  const Eigen::Vector3d arm = pose.translation() - data.reference;
  Vector6d local;
  local.head<3>() = pose.linear().transpose() * force;
  local.tail<3>() = pose.linear().transpose() * (wrench.tail<3>() - arm.cross(force));
  return local;
}

Eigen::Vector3d pointAcceleration(const MultibodyData& data, int link, const Eigen::Vector3d& point)
{
  const Vector6d& acceleration = data.link_acceleration[link];
  const Eigen::Vector3d angular_velocity = data.link_velocity[link].tail<3>();
  const Eigen::Vector3d angular = acceleration.tail<3>();
  const Eigen::Vector3d velocity = pointVelocity(data, link, point).head<3>();
  return acceleration.head<3>() + angular.cross(point - data.reference) + angular_velocity.cross(velocity);
}

}  // namespace frictional_contact_sim
