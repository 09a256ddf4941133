#include "frictional_contact_sim/dynamics/limit_rows.h"

#include <cmath>

namespace frictional_contact_sim
{
LimitRows::LimitRows(const std::vector<Body>& bodies, RowMemory& memory)
  : bodies_(bodies), memory_(name(), 2, bodies, memory)
{
}

void LimitRows::addJointRows(const StepContext& context, int body_index, int joint_index, RowSink& sink)
{
  const Body& body = bodies_[body_index];
  const Joint& joint = body.model.tree.joints[joint_index];
  const double position = (context.impact ? body.state.q : body.q_middle)[joint.q_index];
  const double velocity = body.state.v[joint.v_index];
  const double gaps[2] = {position - joint.limit.lower, joint.limit.upper - position};
  // Limits enter as contacts do, within a look-ahead: here a hundredth of a radian (metre) beyond two steps' travel.
  const double margin = context.impact ? CONTACT_GAP : 0.01 + 2.0 * context.dt * std::abs(velocity);
  for (int side = 0; side < 2; ++side)
  {
    if (!(gaps[side] <= margin))
      continue;
    const double sign = side == 0 ? 1.0 : -1.0;
    const NormalShift shift = context.impact
                                  ? impactShift(gaps[side], sign * velocity, 0.0)
                                  : normalShift(context.normal_law, gaps[side], sign * velocity, 0.0, context.dt);
    if (!shift.active)
      continue;
    if (shift.closing)
      sink.noteClosing();
    sink.push(body.v_offset + joint.v_index, sign);
    sink.endRow(shift.shift, {WorkAccount::JOINTS, 0.0, memory_.at(body_index, joint_index, side)});
    sink.endLaw({LawType::UNILATERAL, 0.0}, jointUnit(body, joint_index));
  }
}

}  // namespace frictional_contact_sim
