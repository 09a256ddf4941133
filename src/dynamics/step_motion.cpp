#include "frictional_contact_sim/dynamics/step_motion.h"

#include "frictional_contact_sim/model/dynamics_algorithms.h"

namespace frictional_contact_sim
{
namespace
{
/**
 * A free link's columns are about its centre of mass (free_link.h): the centre has the rate of its velocity as
 * acceleration, the origin turns round it.
 */
void setFreeLinkMotion(const Body& body, const Eigen::VectorXd& mean, const Eigen::VectorXd& rate, MultibodyData& data)
{
  const Eigen::Matrix3d axes = data.base_pose.linear();
  const Eigen::Vector3d arm = data.link_pose.front().linear() * body.model.tree.links.front().inertia.center;
  const Eigen::Vector3d velocity = axes * mean.head<3>();
  const Eigen::Vector3d angular = axes * mean.tail<3>();
  const Eigen::Vector3d angular_rate = axes * rate.tail<3>();
  const Eigen::Vector3d center = axes * rate.head<3>() + angular_rate.cross(arm);
  const Eigen::Vector3d origin = center - angular_rate.cross(arm) - angular.cross(angular.cross(arm));
  data.link_velocity.front() << velocity, angular;
  data.link_acceleration.front() << origin - angular.cross(velocity), angular_rate;
}

/** A base that moves evenly on a straight line changes no force; a turning one carries what has no joints. */
void addBaseMotion(const Body& body, MultibodyData& data)
{
  data.link_velocity.front() << body.base.linear, body.base.angular;
  data.link_acceleration.front() << body.base_rate.linear - body.base.angular.cross(body.base.linear),
      body.base_rate.angular;
}
}  // namespace

void computeStepMotion(const Body& body, const VectorIn& v_end, double dt, MultibodyData& data)
{
  const MultibodyModel& tree = body.model.tree;
  data.base_pose = body.middle.base_pose;
  forwardKinematics(tree, body.q_middle, data);
  const Eigen::VectorXd mean = 0.5 * (body.v_start + v_end);
  const Eigen::VectorXd rate = (v_end - body.v_start) / dt;
  if (body.model.free_link)
    setFreeLinkMotion(body, mean, rate, data);
  else
    computeLinkAccelerations(tree, mean, rate, data);
  if (body.model.base_motion.active && tree.nv == 0)
    addBaseMotion(body, data);
}

void addExternalWrenches(const Body& body, const MultibodyData& data, double middle, std::vector<Vector6d>& applied)
{
  for (const ExternalWrench& wrench : body.state.wrenches)
  {
    if (middle < wrench.from || middle >= wrench.until)
      continue;
    const Eigen::Isometry3d pose = framePose(body.model.tree, data, wrench.frame);
    const Eigen::Matrix3d axes = wrench.world_frame ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : pose.linear();
    const Eigen::Vector3d force = axes * wrench.force;
    applied[wrench.frame].head<3>() += force;
    applied[wrench.frame].tail<3>() += axes * wrench.torque + (pose * wrench.point - data.reference).cross(force);
  }
}

}  // namespace frictional_contact_sim
