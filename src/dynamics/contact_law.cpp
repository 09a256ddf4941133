#include "frictional_contact_sim/dynamics/contact_law.h"

#include <algorithm>

namespace frictional_contact_sim
{
NormalShift normalShift(const NormalLaw& law, double gap, double old_velocity, const Restitution& restitution,
                        double dt)
{
  NormalShift result;
  gap = law.gapToMend(gap);
  const bool approaching = old_velocity < -law.closing_speed;
  if (law.form == ContactLawForm::VELOCITY)
  {
    result.active = gap <= 0.0;
    result.closing = result.active && approaching;
    result.shift = result.closing ? restitution.normal * old_velocity : 0.0;
    result.tangential = result.closing ? restitution.tangential : 0.0;
    return result;
  }
  result.closing = approaching && gap + dt * old_velocity <= 0.0;
  if (result.closing && restitution.bounces())
  {
    result.shift = restitution.normal * old_velocity;
    result.tangential = restitution.tangential;
  }
  else
    result.shift = gap >= 0.0 ? gap / dt : -std::min(-gap / dt, law.recovery_speed);
  return result;
}

NormalShift impactShift(double gap, double old_velocity, const Restitution& restitution, double dt)
{
  NormalShift result;
  result.active = gap <= CONTACT_GAP || gap + 0.5 * dt * old_velocity < 0.0;
  result.closing = result.active && old_velocity < 0.0;
  result.tangential = result.closing ? restitution.tangential : 0.0;
  if (restitution.bounces() || gap <= CONTACT_GAP)
    result.shift = restitution.normal * std::min(old_velocity, 0.0);
  else
    result.shift = 2.0 * gap / dt;
  return result;
}

}  // namespace frictional_contact_sim
