#include "frictional_contact_sim/dynamics/joint_springs.h"

namespace frictional_contact_sim
{
void JointSprings::addMomentum(const StepContext& context, int body_index, VectorOut momentum)
{
  Body& body = bodies_[static_cast<size_t>(body_index)];
  for (const JointSpring& spring : body.model.springs)
  {
    const Joint& joint = body.model.tree.joints[static_cast<size_t>(spring.joint)];
    const double stretch = body.state.q[joint.q_index] - spring.rest;
    const double velocity = body.state.v[joint.v_index];
    momentum[joint.v_index] -= context.dt * spring.stiffness * (stretch + 0.25 * context.dt * velocity);
    body.implicit[joint.v_index] += 0.25 * context.dt * context.dt * spring.stiffness;
  }
}

}  // namespace frictional_contact_sim
