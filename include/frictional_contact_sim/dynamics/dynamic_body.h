#pragma once
/**
 * @file dynamic_body.h
 * @brief Mechanics of a body that is not a tree of rigid links (an elastic solid, a rod): what the assembly of a step
 * and the contacts ask of it. Trees answer through the functions of body.h; this is where those ask on.
 *
 * Coordinates q (n) are displacements from the reference shape, v (n) their rates. A step is
 *
 *     M_h (v - v_k) + dt (bias - applied) = H^T r,       M_h = M + dt^2/4 K + dt/2 D,  bias = K q_m + D v_k - gravity
 *
 * which is Moreau's midpoint rule with stiffness and damping at the mean displacement and velocity: for constant M, K
 * it keeps the energy of a free body to round-off. In a quasi-static step M_h = dt^2 K and v_k = 0, so that K (q + dt
 * v) balances the forces r / dt. The links of the body's frame tree are the root and after it one a surface node.
 */
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frictional_contact_sim/collision/contact_id.h"
#include "frictional_contact_sim/model/kinematics.h"
#include "frictional_contact_sim/model/multibody_data.h"

namespace frictional_contact_sim
{
struct Body;
struct BodyState;

/** @brief Columns of a point velocity: coordinate and the motion that it gives the point, coordinates ascend. */
using PointColumns = std::vector<std::pair<int, Eigen::Vector3d>>;

/** @brief A material point of a contact. */
struct BodyPoint
{
  int link = 0;  ///< of the shape
  Feature feature = 0;  ///< FACE k of a deformable body: a point on its facet k
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world, at the midpoint of the step [m]
};

/** @brief A piece of a deformable surface: a triangle, in the plane a segment, of a bar its end. */
struct Facet
{
  std::array<int, 3> links{-1, -1, -1};  ///< of its nodes; the normal points outwards: (b - a) x (c - a)
  int count = 3;  ///< of nodes; 2: normal (b - a) x y axis of the body; 1: normal along `axis`
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< body axes, unit
};

/** @brief What a simulation keeps of a body beside its state: the matrix of the step and its factor. */
struct BodyWork
{
  virtual ~BodyWork() = default;
};

/** @brief Constant, shared by all simulations of the body. */
class DynamicBody
{
public:
  virtual ~DynamicBody() = default;

  virtual int velocities() const = 0;  ///< n
  virtual double totalMass() const = 0;  ///< [kg]
  virtual bool isSupported() const = 0;  ///< some of it is fixed to its base, which does not move by itself
  /** @brief Columns of the entries of M_h, row by row, ascending. */
  virtual const std::vector<std::vector<int>>& massColumns() const = 0;
  virtual std::unique_ptr<BodyWork> makeWork() const = 0;

  /** @brief link_pose of the nodes; that of the root and reference are base_pose. @param q n [m] */
  virtual void setPoses(const VectorIn& q, MultibodyData& data) const = 0;
  /** @brief link_velocity of the nodes, about data.reference. @param v n [m/s] */
  virtual void setVelocities(const VectorIn& v, MultibodyData& data) const = 0;
  /** @brief sign times the Jacobian of a point; supports have no columns. Appends to `columns`. */
  virtual void addPointColumns(const Body& body, const BodyPoint& point, double sign, PointColumns& columns) const = 0;
  /** @brief After a step: a body without supports takes its frame along, so that q stays as small as the deformation
   * and round-off with it. Nothing moves. */
  virtual void recentre(BodyState& state) const = 0;
  /** @brief Largest speed of a point at the midpoint [m/s], or a bound of it. */
  virtual double pointSpeed(const Body& body, const VectorIn& v) const = 0;
  virtual double nodeDistance() const = 0;  ///< smallest between two surface nodes that are joined [m]
  virtual const std::vector<Facet>& facets() const = 0;

  /** @brief The matrix of a step of `dt`; 0: of an impact, M alone. */
  virtual void prepare(Body& body, double dt) const = 0;
  /** @brief The factor of that matrix. @return false where it is not positive definite */
  virtual bool factorize(Body& body) const = 0;
  virtual void solve(const Body& body, Eigen::VectorXd& v) const = 0;  ///< v <- M_h^-1 v
  virtual void multiply(const Body& body, const Eigen::VectorXd& v, VectorOut product) const = 0;  ///< M_h v
  /** @brief Entries of M_h (M) in the order of massColumns; `value` moves behind them. */
  virtual void copyMass(const Body& body, double*& value) const = 0;
  /** @brief See above, at q_middle and v_start; what depends on the mean velocity of the step, at `v`.
   * @param gravity world axes [m/s^2] */
  virtual void computeBias(const Body& body, const Eigen::VectorXd& v, const Eigen::Vector3d& gravity,
                           Eigen::VectorXd& bias) const = 0;
  /** @brief Body::external of its wrenches at scenario time `now` [s]. Needs prepare(). */
  virtual void applyWrenches(Body& body, double now) const = 0;

  virtual double kineticEnergy(const Body& body) const = 0;  ///< of the state, in the frame of its base [J]
  /** @brief Elastic energy, and gravity's: of a body with supports counted from its reference shape [J]. */
  virtual double potentialEnergy(const Body& body, const Eigen::Vector3d& gravity) const = 0;
  /** @brief Power of the damping at mean velocity `v` [W] >= 0. */
  virtual double dampingPower(const VectorIn& v) const = 0;
  /** @brief Why the model does not hold at q; empty where it does. */
  virtual std::string refusal(const VectorIn& q) const = 0;
  /** @brief Why it does not take a wrench; empty where it does. */
  virtual std::string wrenchRefusal(const ExternalWrench& wrench) const = 0;
  /** @brief Why one linear step does not find its equilibrium; empty where it does. */
  virtual std::string staticsRefusal() const = 0;
};

}  // namespace frictional_contact_sim
