#include "frictional_contact_sim/dynamics/dry_friction_rows.h"

namespace frictional_contact_sim
{
DryFrictionRows::DryFrictionRows(const std::vector<Body>& bodies, RowMemory& memory)
  : bodies_(bodies), memory_(name(), 1, bodies, memory)
{
}

void DryFrictionRows::addJointRows(const StepContext& context, int body_index, int joint_index, RowSink& sink)
{
  const Body& body = bodies_[body_index];
  const Joint& joint = body.model.tree.joints[joint_index];
  if (context.impact || !(joint.dry_friction > 0.0))
    return;
  sink.push(body.v_offset + joint.v_index, 1.0);
  sink.endRow(0.0, {WorkAccount::JOINTS, 0.0, memory_.at(body_index, joint_index)});
  sink.endLaw({LawType::DRY_FRICTION, context.dt * joint.dry_friction}, jointUnit(body, joint_index));
}

}  // namespace frictional_contact_sim
