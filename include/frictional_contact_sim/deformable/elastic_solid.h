#pragma once
/**
 * @file elastic_solid.h
 * @brief A linear elastic body in the frame of its base: constant M and K, displacements q of its free nodes.
 *
 *     M q'' + damping K q' + K q = forces,      point of node i = base_pose (X_i + q_i)
 *
 * Nodes on supports do not move in that frame, which may itself move with a constant linear velocity; without supports
 * the frame goes along with the centre of mass. It does not turn: rotations are those of linear elasticity, so a state
 * in which a cell (where there are none, the body on the mean) has turned by more than 0.1 rad is refused. Source:
 * Cadoux (2009), section 2.3.3; Hughes (2000), chapter 7.
 */
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/deformable/elastic_mesh.h"
#include "frictional_contact_sim/dynamics/body.h"

namespace frictional_contact_sim
{
/// Beyond this the strain that a rotation feigns, half its square, is 0.5 %.
constexpr double MOST_ROTATION = 0.1;  ///< [rad]

class ElasticSolid : public DynamicBody
{
public:
  /** @param supports nodes that do not move, may repeat. @param damping D = damping K [s] >= 0
   *  @throws ModelError when no node is free, M is not positive definite or K not semi-definite, or a body without
   *  supports resists translations: constraints that are in the matrices already */
  ElasticSolid(const std::string& name, ElasticParts parts, const std::vector<int>& supports, double damping);

  const ElasticParts& parts() const { return parts_; }
  const Eigen::VectorXd& carried(int axis) const { return carried_[axis]; }  ///< n: M times a unit translation [kg]
  const SparseRows& mass() const { return mass_; }  ///< n x n, of the free nodes [kg]
  const SparseRows& stiffness() const { return stiffness_; }  ///< n x n [N/m]
  double totalMass() const override { return total_mass_; }  ///< [kg]
  /** @brief Displacement of every node at q, body axes [m]; v gives velocities. */
  std::vector<Eigen::Vector3d> displacements(const VectorIn& q) const;
  /** @brief v of a rigid motion in body axes, supports at rest. */
  Eigen::VectorXd rigidVelocity(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) const;
  /** @brief Largest rotation at q [rad]. */
  double rotation(const VectorIn& q) const;

  bool isSupported() const override { return is_supported_; }
  int velocities() const override { return static_cast<int>(mass_.rows()); }
  const std::vector<std::vector<int>>& massColumns() const override { return columns_; }
  std::unique_ptr<BodyWork> makeWork() const override;
  void setPoses(const VectorIn& q, MultibodyData& data) const override;
  void setVelocities(const VectorIn& v, MultibodyData& data) const override;
  void addPointColumns(const Body& body, const BodyPoint& point, double sign, PointColumns& columns) const override;
  void recentre(BodyState& state) const override;
  double pointSpeed(const Body& body, const VectorIn& v) const override;
  double nodeDistance() const override { return node_distance_; }
  const std::vector<Facet>& facets() const override { return facets_; }
  void prepare(Body& body, double dt) const override;
  bool factorize(Body& body) const override;
  void solve(const Body& body, Eigen::VectorXd& v) const override;
  void multiply(const Body& body, const Eigen::VectorXd& v, VectorOut product) const override;
  void copyMass(const Body& body, double*& value) const override;
  void computeBias(const Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity,
                   Eigen::VectorXd& bias) const override;
  void applyWrenches(Body& body, double now) const override;
  double kineticEnergy(const Body& body) const override;
  double potentialEnergy(const Body& body, const Eigen::Vector3d& gravity) const override;
  double dampingPower(const VectorIn& v) const override;
  std::string refusal(const VectorIn& q) const override;
  std::string wrenchRefusal(const ExternalWrench& wrench) const override;
  std::string staticsRefusal() const override;

private:
  Eigen::Vector3d displacement(const VectorIn& q, int node) const;
  Eigen::Vector3d centre(const VectorIn& q) const;
  void setMatrices(const std::vector<int>& supports);
  void checkMatrices();
  void checkFree() const;
  void setRotations();
  void setSurface();

  std::string name_;
  ElasticParts parts_;
  double damping_;
  bool is_supported_ = false;
  bool is_held_ = false;  ///< by its supports against every motion: K is positive definite
  std::vector<Eigen::Vector3i> dofs_;  ///< nodes: coordinate of x, y, z, -1 = none
  SparseRows mass_;
  SparseRows stiffness_;  ///< the same pattern
  SparseRows rotation_;  ///< three rows a cell: its rotation of q [1/m]
  std::vector<std::vector<int>> columns_;
  std::array<Eigen::VectorXd, 3> carried_;
  double total_mass_ = 0.0;
  std::vector<Facet> facets_;
  double node_distance_ = 0.0;
};

/** @brief Links and shapes of a deformable body: a root on a fixed base, and a point at each surface node. */
MultibodyModel nodeTree(const std::string& name, const std::vector<Eigen::Vector3d>& nodes,
                        const std::vector<int>& surface);

}  // namespace frictional_contact_sim
