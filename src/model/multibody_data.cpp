#include "frictional_contact_sim/model/multibody_data.h"

namespace frictional_contact_sim
{
MultibodyData::MultibodyData(const MultibodyModel& model)
  : base_pose(model.joints.empty() ? Eigen::Isometry3d::Identity() : model.joints.front().placement)
  , link_pose(model.links.size(), Eigen::Isometry3d::Identity())
  , motion_subspace(Matrix6Xd::Zero(6, model.nv))
  , link_inertia(model.links.size())
  , link_velocity(model.links.size(), Vector6d::Zero())
  , mass_matrix(Eigen::MatrixXd::Zero(model.nv, model.nv))
  , mass_factor(Eigen::MatrixXd::Zero(model.nv, model.nv))
  , factor_inverse(Eigen::VectorXd::Zero(model.nv))
  , factor_row(Eigen::VectorXd::Zero(model.nv))
  , composite_inertia(model.links.size())
  , link_acceleration(model.links.size(), Vector6d::Zero())
  , link_force(model.links.size(), Vector6d::Zero())
{
}

}  // namespace frictional_contact_sim
