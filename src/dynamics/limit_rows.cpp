#include "frictional_contact_sim/dynamics/limit_rows.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
namespace
{
constexpr double OVERLAP = 1e-9;  ///< [rad] or [m]: what an answer may go beyond a limit

double sign(int side)
{
  return side == 0 ? 1.0 : -1.0;
}
}  // namespace

LimitRows::LimitRows(const std::vector<Body>& bodies, RowMemory& memory)
  : bodies_(bodies), memory_(name(), 2, bodies, memory)
{
  for (size_t b = 0; b < bodies.size(); ++b)
  {
    const std::vector<Joint>& joints = bodies[b].model.tree.joints;
    first_.emplace_back(joints.size(), -1);
    for (int j = 0; j < static_cast<int>(joints.size()); ++j)
    {
      if (velocitySize(joints[j].type) != 1 ||
          !(std::isfinite(joints[j].limit.lower) || std::isfinite(joints[j].limit.upper)))
        continue;
      first_.back()[j] = static_cast<int>(sides_.size());
      sides_.push_back({static_cast<int>(b), j, 0});
      sides_.push_back({static_cast<int>(b), j, 1});
    }
  }
}

void LimitRows::begin(const StepContext&)
{
  for (Side& side : sides_)
    side.has_row = side.needed = false;
}

double LimitRows::gap(const StepContext& context, const Side& side) const
{
  const Body& body = bodies_[side.body];
  const Joint& joint = body.model.tree.joints[side.joint];
  const double position = (context.impact ? body.state.q : body.q_middle)[joint.q_index];
  return side.side == 0 ? position - joint.limit.lower : joint.limit.upper - position;
}

void LimitRows::addJointRows(const StepContext& context, int body_index, int joint_index, RowSink& sink)
{
  const int first = first_[body_index][joint_index];
  if (first < 0)
    return;
  const Body& body = bodies_[body_index];
  const int v_index = body.model.tree.joints[joint_index].v_index;
  for (int k = 0; k < 2; ++k)
  {
    Side& side = sides_[first + k];
    double* memory = memory_.at(body_index, joint_index, k);
    const double gap_now = gap(context, side);
    const double velocity = sign(k) * body.state.v[v_index];
    const double free_velocity = context.impact ? velocity : sign(k) * body.v_free[v_index];
    const double closes = CLOSING_MARGIN * context.dt * std::max(-velocity, -free_velocity);
    side.has_row = side.needed || *memory != 0.0 || gap_now <= std::max(CONTACT_GAP, closes);
    if (!side.has_row)
      continue;
    const NormalShift shift = context.impact ? impactShift(gap_now, velocity, {}, context.dt)
                                             : normalShift(context.normal_law, gap_now, velocity, {}, context.dt);
    // An answer that needs it has another velocity than the one that made an impact's row inactive.
    side.has_row = shift.active || side.needed;
    if (!side.has_row)
      continue;
    if (shift.closing)
      sink.noteClosing();
    sink.push(body.v_offset + v_index, sign(k));
    sink.endRow(shift.shift, {WorkAccount::JOINTS, 0.0, memory});
    sink.endLaw({LawType::UNILATERAL, 0.0}, jointUnit(body, joint_index));
  }
}

/** The gap at the next midpoint (impact: at the first one) is linear in the joint's velocity. */
Again LimitRows::lookAhead(const StepContext& context, const Solution& solution)
{
  Again again = Again::NO;
  if (context.normal_law.form == ContactLawForm::VELOCITY)
    return again;
  const double time = context.impact ? 0.5 * context.dt : context.dt;
  for (Side& side : sides_)
  {
    if (side.has_row)
      continue;
    const Body& body = bodies_[side.body];
    const double velocity = sign(side.side) * solution.v[body.v_offset + body.model.tree.joints[side.joint].v_index];
    if (gap(context, side) + time * velocity >= -OVERLAP)
      continue;
    side.needed = true;
    again = Again::FROM_ANSWER;
  }
  return again;
}

}  // namespace frictional_contact_sim
