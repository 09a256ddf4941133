#include "frictional_contact_sim/simulation/root_motion.h"

#include "frictional_contact_sim/model/kinematics.h"

namespace frictional_contact_sim
{
Eigen::Isometry3d rootPose(const Simulator& simulator, int body)
{
  return simulator.data(body).link_pose.front();
}

Vector6d rootVelocity(const Simulator& simulator, int body)
{
  return pointVelocity(simulator.data(body), 0, rootPose(simulator, body).translation());
}

}  // namespace frictional_contact_sim
