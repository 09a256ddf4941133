#pragma once
/**
 * @file creep_law.h
 * @brief Opt-in longitudinal creep law of a rolling contact: traction as a function of creepage, from a table.
 *
 *     r_d = -mu r_N tau(xi) sign(u_d),   xi = |u_d| / V,   |r_T| <= mu r_N always
 *
 * d is the rolling direction, u_d the slip along it [m/s], V the rolling speed [m/s] (RollingShape), tau the table's
 * traction [-]. Across d, beyond the table's last creepage and at V < ROLLING_SPEED the law is Coulomb's as it is.
 *
 * Within a step the law is solved implicitly by Newton's method: at the last iterate (u_0, r_N0, V_0) the curve is
 * replaced by its tangent  T_0 + g (u_d - u_0),  T_0 = mu r_N0 tau_0 sign(u_0),  g = mu r_N0 tau'_0 / V_0,  and
 *
 *     (u', r) in Coulomb's law with   u'_d = u_d + k r_d + c,   k = 1/g,   c = k T_0 - u_0
 *
 * "sticks" exactly on the tangent and is capped by the cone. k adds to the diagonal of the Delassus operator: positive,
 * so every solve is as well posed as without creep. For a concave table the tangent lies above the curve, the iterates
 * come from the side of small slips and end on the exact segment after finitely many; the order is quadratic in u_d,
 * linear in r_N and V, which hardly depend on r_d. Measured: 1.8 solves a step, driven wheel. After six iterations
 * steps are halved, for curves with convex parts; a step whose law is not met after forty counts as not converged. As V
 * -> 0, k -> 0: exact Coulomb sticking.
 *
 * Source: Carter (1926) for the curve of two cylinders; Kalker (1990), 1.2 for creepage and rolling velocity. The table
 * belongs to one load (reference_load); it is not rescaled to the actual one, since a contact point has no line load.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "frictional_contact_sim/model/multibody_model.h"

namespace frictional_contact_sim
{
struct CreepTable
{
  double friction = 0.0;  ///< mu the table was computed with [-] > 0
  double reference_load = 0.0;  ///< normal load it was computed with [N/m]
  std::vector<double> creepage;  ///< xi, from 0, ascending [-]
  std::vector<double> traction;  ///< |Q| / (mu P), from 0, not decreasing, 1 at the end and only there [-]

  /** @brief tau(xi), linear between the entries, 1 beyond the last. */
  double value(double xi) const;
  /** @brief Derivative on the segment that ends at or contains xi, bounded below so that a flat segment has one. */
  double slope(double xi) const;
};

/** @brief The tangent of the law in one step as the numbers k and c of the file comment; k = 0: plain Coulomb. */
struct CreepTangent
{
  double compliance = 0.0;  ///< k [1/kg]
  double offset = 0.0;  ///< c [m/s]
};

/** @brief Where the law is linearised. */
struct CreepPoint
{
  double slip = 0.0;  ///< u_d [m/s]
  double normal = 0.0;  ///< r_N [N s]; 0: unknown
  double speed = 0.0;  ///< V [m/s]
  bool known = false;  ///< false: slip and speed are still to be taken from the velocities at the start of the step
};

CreepTangent creepTangent(const CreepTable& curve, double friction, const CreepPoint& at);

/** @brief The law itself: T with r_d = -T [N s]. */
double creepTraction(const CreepTable& curve, double friction, const CreepPoint& at);

constexpr double ROLLING_SPEED = 1e-6;  ///< slower contacts do not roll: Coulomb's law [m/s]

/**
 * @brief The curvature of a shape, as far as rolling needs it.
 *
 * The contact point moves with  c = alpha_a (v_a - s_a) + alpha_b (v_b - s_b):  v the velocity of the material at the
 * contact, s the part of it that is due to the spin of a round shape and does not carry the contact along (a sphere:
 * omega x arm; a cylinder or capsule: the part of omega along its axis x arm; flat: 0), alpha_a = R_b / (R_a + R_b).
 * The rolling velocity is that of the contact point over the mean of both materials,  V = c - (v_a + v_b)/2,
 * tangential.
 */
struct RollingShape
{
  enum class Kind
  {
    FLAT,  ///< boxes, meshes, the ground: contacts do not roll over them by their own spin
    SPHERE,
    CYLINDER,
    CAPSULE
  };
  Kind kind = Kind::FLAT;
  double radius = 0.0;  ///< [m]
  double half_length = 0.0;  ///< [m]
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< in the body frame

  RollingShape() = default;
  explicit RollingShape(const CollisionShape& shape);
  /**
   * @brief Matrix S of s = S omega at a contact; zero and `round` false where the shape is flat there (a cylinder
   * whose axis is within 60 degrees of the normal stands on its face).
   */
  Eigen::Matrix3d spin(const Eigen::Isometry3d& link_pose, const Eigen::Vector3d& position,
                       const Eigen::Vector3d& normal, bool& round) const;
};

}  // namespace frictional_contact_sim
