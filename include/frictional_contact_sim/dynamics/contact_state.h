#pragma once
/**
 * @file contact_state.h
 * @brief A contact at the end of a step: what messages report, and what the next step starts from.
 */
#include <Eigen/Core>

#include "frictional_contact_sim/collision/contact_id.h"

namespace frictional_contact_sim
{
enum class ContactMode
{
  OPEN,
  STICKING,
  SLIDING,
  IMPACT
};
const char* toString(ContactMode mode);

/** @brief `a` and `b` are shape handles of Simulator::shape. */
struct ContactState
{
  ContactId id;
  int shape_a = 0;
  int shape_b = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< world, from b to a
  Eigen::Vector3d tangent_1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d tangent_2 = Eigen::Vector3d::UnitY();
  double gap = 0.0;  ///< at the midpoint of the step [m]
  /// What the normal row kept: u_N >= -row_gap/dt. The gap itself but for overlaps, restitution and rows linearised
  /// ahead (contact_set.h) [m]
  double row_gap = 0.0;
  double friction = 0.0;
  double restitution = 0.0;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  ///< on a, world [N s]; the force is impulse / dt
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of a relative to b, world, end of the step [m/s]
  ContactMode mode = ContactMode::OPEN;
  double residual = 0.0;  ///< |e_i| of this contact, natural map [m/s]
  double cone_margin = 0.0;  ///< mu r_N - |r_T| [N s]
};

}  // namespace frictional_contact_sim
