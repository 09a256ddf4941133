#pragma once
/**
 * @file super_helix.h
 * @brief A rod as a chain of helices: clamped at its root, unstretchable, of pieces with constant twist and curvatures.
 *
 * kappa (twist, curvature 1, curvature 2 a piece [1/m]) is natural + q. With the material frame R(s), e_1 along the
 * rod:
 *
 *     R' = R [kappa_k]x,  x' = R e_1                                   piece by piece in closed form (Rodrigues)
 *     omega(s) = int_0^s R dq dt,   v(p, s) = int_0^s (R dq) x (p - x) dt          p fixed to the section at s
 *     M(q) = int rho A J^T J + rho J_w^T I J_w ds,   K = E I (length of a piece) on curvatures, 2 G I on twists
 *
 * Integrals by the midpoint rule over the sections of a piece. A step is that of dynamic_body.h with M at q_m and the
 * rate terms of the accelerations in the bias; K enters M_h as dt^2/4 K (midpoint) where Cadoux (2009), remark 2.1, has
 * all inner forces explicit: a departure, since hair at dt = 1 ms is far beyond the explicit limit. Each section is a
 * capsule to the collision world: rods meet each other and rigid shapes by closest points; a rod does not meet itself.
 *
 * Sources: Cadoux (2009), sections 2.3.4 and 5.1.3; Bertails et al. (2006).
 */
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/dynamics/body.h"

namespace frictional_contact_sim
{
struct RodSpec
{
  double length = 0.0;  ///< [m] > 0
  double radius = 0.0;  ///< [m] > 0
  int pieces = 6;  ///< >= 1
  int sections = 8;  ///< a piece, >= 1
  double density = 0.0;  ///< [kg/m^3] > 0
  std::vector<double> young_modulus;  ///< [Pa] > 0: one for all pieces or one a piece
  double poisson_ratio = 0.5;  ///< [-] in [0, 0.5]
  double damping = 0.0;  ///< D = damping K [s] >= 0
  std::vector<double>
      natural;  ///< twist, curvature 1, curvature 2 [1/m]: three for all pieces or three a piece; empty: 0
  std::vector<double> start;  ///< the same at the start; empty: natural
};

/** @brief Frames and points at the middles of the sections, in the axes of the root. */
struct RodShape
{
  std::vector<Eigen::Matrix3d> frames;
  std::vector<Eigen::Vector3d> points;
};

class SuperHelix : public DynamicBody
{
public:
  explicit SuperHelix(const RodSpec& spec);

  RodShape shapeAt(const VectorIn& q) const;
  const RodSpec& spec() const { return spec_; }
  Eigen::VectorXd startPosition() const;  ///< q of RodSpec::start
  const Eigen::VectorXd& stiffness() const { return stiffness_; }  ///< 3 pieces: the diagonal of K

  int velocities() const override { return static_cast<int>(stiffness_.size()); }
  double totalMass() const override { return line_mass_ * spec_.pieces * spec_.sections; }
  bool isSupported() const override { return true; }
  const std::vector<std::vector<int>>& massColumns() const override { return columns_; }
  std::unique_ptr<BodyWork> makeWork() const override;
  void setPoses(const VectorIn& q, MultibodyData& data) const override;
  void setVelocities(const VectorIn& v, MultibodyData& data) const override;
  void addPointColumns(const Body& body, const BodyPoint& point, double sign, PointColumns& columns) const override;
  void recentre(BodyState& /*state*/) const override {}
  double pointSpeed(const Body& body, const VectorIn& v) const override;
  double nodeDistance() const override { return spec_.radius; }
  const std::vector<Facet>& facets() const override { return no_facets_; }
  void prepare(Body& body, double dt) const override;
  bool factorize(Body& body) const override;
  void solve(const Body& body, Eigen::VectorXd& v) const override;
  void multiply(const Body& body, const Eigen::VectorXd& v, VectorOut product) const override;
  void copyMass(const Body& body, double*& value) const override;
  void computeBias(const Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity,
                   Eigen::VectorXd& bias) const override;
  /** @brief At arc length point.x, within or beyond the rod, beside its centre line by point.y and z in the section's
   * axes; forces and torques in those of the world or the root. Body::external has the inertia of an accelerated
   * support too, whose work is the support's. */
  void applyWrenches(Body& body, double now) const override;
  double kineticEnergy(const Body& body) const override;
  double potentialEnergy(const Body& body, const Eigen::Vector3d& gravity) const override;
  double dampingPower(const VectorIn& v) const override;
  std::string refusal(const VectorIn& /*q*/) const override { return ""; }
  std::string wrenchRefusal(const ExternalWrench& /*wrench*/) const override { return ""; }
  std::string staticsRefusal() const override;

private:
  struct Motion;
  Motion motionOf(const RodShape& shape, const VectorIn& v) const;
  const RodShape& shapeOfState(const Body& body) const;

  RodSpec spec_;
  double step_;  ///< length of a section [m]
  double line_mass_;  ///< of a section [kg]
  double spin_inertia_;  ///< of a section about a diameter [kg m^2]
  Eigen::VectorXd natural_;
  Eigen::VectorXd stiffness_;
  std::vector<std::vector<int>> columns_;
  std::vector<Facet> no_facets_;
};

/** @brief Links and shapes of a rod: a root on a fixed base, and a capsule a section along the frame's x axis. */
MultibodyModel sectionTree(const std::string& name, const RodSpec& spec);

}  // namespace frictional_contact_sim
