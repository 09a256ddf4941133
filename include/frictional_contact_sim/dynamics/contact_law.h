#pragma once
/**
 * @file contact_law.h
 * @brief By which velocity the law of a contact is shifted over one time step.
 *
 * The law acts on u_N + shift >= 0. With the gap and old normal velocity u_old at the midpoint configuration:
 *
 *   closing, of a pair that bounces (u_old < -threshold and gap + dt u_old <= 0)  u_N >= -e u_old
 *   gap >= 0                                                                      u_N >= -gap/dt
 *   gap < 0                                                                       u_N >= min(-gap/dt, v_recover)
 *   -left_overlap <= gap < 0                                                      u_N >= 0
 *
 * A pair bounces when e or e_T is above zero. Coulomb's law of what closes then holds for u_T + e_T u_T,old as it does
 * for u_N + e u_old (Cadoux 2009, 1.1.5, "impacts tangentiels"): where the cone allows it the tangential velocity is
 * turned round, u_T = -e_T u_T,old; else friction is mu r_N against u_T + e_T u_T,old.
 *
 * The gap at the next midpoint is gap + dt u_N to second order, hence >= 0 (docs/architecture.md). The thesis's
 * plain velocity law (Cadoux 2009, 1.1.5 and 2.2: u_N + e u_old >= 0 where gap <= 0, nothing else) stays selectable.
 */
#include <algorithm>

namespace frictional_contact_sim
{
enum class ContactLawForm
{
  GAP,  ///< the rules above
  VELOCITY  ///< the thesis's plain law
};

struct NormalLaw
{
  ContactLawForm form = ContactLawForm::GAP;
  double closing_speed = 1e-6;  ///< threshold: slower approaches do not bounce [m/s] > 0
  double recovery_speed = 0.01;  ///< v_recover: fastest separation of an initial penetration [m/s] >= 0
  double left_overlap = 0.0;  ///< no separation is asked for up to this one [m] >= 0

  /** @brief What is to be separated of a gap below zero, <= 0; other gaps as they are [m]. */
  double gapToMend(double gap) const { return gap < 0.0 ? std::min(gap + left_overlap, 0.0) : gap; }
};

/** @brief Of a pair. */
struct Restitution
{
  double normal = 0.0;  ///< e [-] in [0, 1]
  double tangential = 0.0;  ///< e_T [-] in [0, 1]

  bool bounces() const { return normal > 0.0 || tangential > 0.0; }
};

struct NormalShift
{
  bool active = true;  ///< false: the contact takes no part in the step (plain law, gap > 0)
  bool closing = false;  ///< an impact
  double shift = 0.0;  ///< of u_N [m/s]
  double tangential = 0.0;  ///< times u_T,old: that of u_T [-]
};

/** @brief The shift of one contact or joint limit. @param dt time step [s] > 0 */
NormalShift normalShift(const NormalLaw& law, double gap, double old_velocity, const Restitution& restitution,
                        double dt);

/**
 * @brief The same for the impact at a given state, before the first step of length dt. Active where gap <= CONTACT_GAP
 * or the first midpoint, gap + dt/2 u_old, is below zero: u_N >= -e u_old where the pair bounces (and closing), else
 * u_N >= -2 gap/dt, 0 for what touches.
 */
NormalShift impactShift(double gap, double old_velocity, const Restitution& restitution, double dt);

/// Contacts and limits have a row at first where the free motion closes their gap so many times over: other rows add.
constexpr double CLOSING_MARGIN = 2.0;
constexpr double CONTACT_GAP = 1e-9;  ///< closer than this is touching, for the impact solve at a given state [m]

}  // namespace frictional_contact_sim
