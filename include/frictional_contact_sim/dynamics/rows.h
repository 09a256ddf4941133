#pragma once
/**
 * @file rows.h
 * @brief Which contact or joint each row of an incremental problem stands for.
 *
 * Row order: contacts (as detected), then joint limits, dry joint friction and bounded servos robot by robot.
 */
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "frictional_contact_sim/dynamics/creep_law.h"

namespace frictional_contact_sim
{
/** @brief Three rows (normal, tangent 1, tangent 2) of one contact. */
struct ContactRow
{
  int point = 0;  ///< index in the list of detected contact points
  int row = 0;  ///< first row
  Eigen::Vector3d tangent_1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d tangent_2 = Eigen::Vector3d::UnitY();
  double friction = 0.0;
  double restitution = 0.0;
  double shift = 0.0;  ///< of the normal law [m/s]; w holds base velocity + shift
  bool closing = false;
  CreepTangent creep;  ///< along tangent_1, the rolling direction then; u of the solution holds k r + c as well
  Eigen::Vector3d base_velocity =
      Eigen::Vector3d::Zero();  ///< of moving bases, contact frame: w without the shift [m/s]
};

/** @brief One row of one joint. */
struct JointRow
{
  enum class Kind
  {
    LOWER_LIMIT,
    UPPER_LIMIT,
    DRY_FRICTION,
    BOUNDED_SERVO
  };
  Kind kind = Kind::LOWER_LIMIT;
  int robot = 0;
  int joint = 0;
  int row = 0;
  double shift = 0.0;  ///< [m/s] or [rad/s]
};

/** @brief q_joint = multiplier q_followed + offset, one row of G. */
struct MimicRow
{
  int robot = 0;
  int joint = 0;
};

/** @brief Two unit vectors that complete `normal` to a right-handed frame; smooth in the normal almost everywhere. */
void tangentFrame(const Eigen::Vector3d& normal, Eigen::Vector3d& tangent_1, Eigen::Vector3d& tangent_2);

}  // namespace frictional_contact_sim
