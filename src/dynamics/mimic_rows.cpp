#include "frictional_contact_sim/dynamics/mimic_rows.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
MimicRows::MimicRows(const std::vector<Body>& bodies, RowMemory& memory)
  : bodies_(bodies), memory_(name(), 1, bodies, memory)
{
}

void MimicRows::addRows(const StepContext&, RowSink&)
{
  violation_ = 0.0;
}

void MimicRows::addJointRows(const StepContext& context, int body_index, int joint_index, RowSink& sink)
{
  const Body& body = bodies_[body_index];
  const Joint& joint = body.model.tree.joints[joint_index];
  if (joint.mimic.joint < 0)
    return;
  const Joint& followed = body.model.tree.joints[joint.mimic.joint];
  std::pair<int, double> entries[2] = {{body.v_offset + joint.v_index, 1.0},
                                       {body.v_offset + followed.v_index, -joint.mimic.multiplier}};
  if (entries[0].first > entries[1].first)
    std::swap(entries[0], entries[1]);
  for (const auto& [column, value] : entries)
    sink.pushBilateral(column, value);
  const double error =
      body.q_middle[joint.q_index] - joint.mimic.multiplier * body.q_middle[followed.q_index] - joint.mimic.offset;
  const double b = error / context.dt;
  violation_ = std::max(violation_, std::abs(b) * context.dt);
  sink.endBilateral(b, {WorkAccount::JOINTS, 0.0, memory_.at(body_index, joint_index)}, jointUnit(body, joint_index));
}

}  // namespace frictional_contact_sim
