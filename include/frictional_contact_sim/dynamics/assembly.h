#pragma once
/**
 * @file assembly.h
 * @brief State + contact points + dt to the incremental problem of one step (Moreau's midpoint scheme).
 *
 *     M = M(q_m) + dt^2/4 K + dt D                              servo stiffness K at the midpoint, damping D at the end
 *     f = -M(q_m) v_k + dt (bias(q_m, v_m) - applied) - c       c: servo offsets, see actuation.h
 *     u = H v + w                                               contacts, limits, dry friction, bounded servos
 *     G v + b = 0,  b = phi(q_m)/dt                             mimic joints
 *
 * with the predicted v_m = (v_k + v_free)/2, v_free the solution of M v + f = H^T r_last with bias at v_k and the last
 * step's impulses of contacts that persist: second order, and at rest exactly zero. Source: Cadoux (2009),
 * (2.28)-(2.31).
 *
 * A servo at its effort limit is a row: an auxiliary velocity s with mass K and the row u = v_j - s - c/K give the
 * impulse r = c - K v_j while |r| < limit dt, and +-limit dt beyond: the law of dry friction, exactly.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/collision/collision_world.h"
#include "frictional_contact_sim/dynamics/contact_law.h"
#include "frictional_contact_sim/dynamics/creep_law.h"
#include "frictional_contact_sim/dynamics/material.h"
#include "frictional_contact_sim/dynamics/robot.h"
#include "frictional_contact_sim/dynamics/row_builder.h"
#include "frictional_contact_sim/dynamics/rows.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
/** @brief Friction and restitution by pair of shapes, from tables made once. */
class PairTable
{
public:
  PairTable() = default;
  /** @param sides one a shape handle */
  PairTable(const MaterialTable& materials, const std::vector<SurfaceSide>& sides);
  const Material& operator()(int shape_a, int shape_b) const
  {
    return table_[class_of_[shape_a] * classes_ + class_of_[shape_b]];
  }
  /** @brief True when some pair has the creep law. */
  bool hasCreep() const;

private:
  int classes_ = 0;
  std::vector<int> class_of_;
  std::vector<Material> table_;
};

struct StepSettings
{
  double dt = 0.001;  ///< [s] > 0
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};
  NormalLaw normal_law;
};

class StepAssembly
{
public:
  /** @brief Sizes everything; the robots and shapes may not change in number afterwards. */
  StepAssembly(std::vector<Robot>& robots, const CollisionWorld& world, PairTable pairs);

  /** @brief Rows H, w, G, b, laws of one step. Robots' middle data are at q_m. */
  void assembleRows(const std::vector<ContactPoint>& points, const StepSettings& settings);
  /**
   * @brief M and f of one step, after assembleRows.
   * @param guess impulses (rows) for the predicted midpoint velocity, lambda for mimic rows
   */
  void assembleDynamics(const Solution& guess, const StepSettings& settings);
  /** @brief The whole problem of an impact at one instant: M v - M v_k = H^T r, contacts and limits at gap <= 1e-9. */
  void assembleImpact(const std::vector<ContactPoint>& points);

  /** @brief True when some pair of materials has the creep law; only then are the next three calls of any use. */
  bool hasCreep() const { return creep_; }
  /** @brief Once a step, before assembleRows: creep contacts are linearised at the start velocities. */
  void startCreep(size_t points);
  /** @brief Normal impulse that is expected at a contact point; the law is Coulomb's where it is unknown. */
  void setCreepNormal(int point, double normal);
  /**
   * @brief Moves the linearisation to a solution. @param tolerance of the traction, relative to mu r_N
   * @return true when the tangents missed the law there: assemble and solve again
   */
  bool updateCreep(const Solution& solution, double tolerance);

  const IncrementalProblem& problem() const { return problem_; }
  const std::vector<ContactRow>& contactRows() const { return contact_rows_; }
  const std::vector<JointRow>& jointRows() const { return joint_rows_; }
  const std::vector<MimicRow>& mimicRows() const { return mimic_rows_; }
  /** @brief Velocities of the robots, without auxiliary ones. */
  int velocities() const { return velocities_; }

private:
  void beginRows();
  void addContact(const ContactPoint& point, int index, const StepSettings* settings);
  void addCreep(const ContactPoint& point, const CreepTable& curve, const Eigen::Vector3d& velocity,
                ContactRow& contact);
  Eigen::Vector3d addRollingSide(const ContactPoint& point, const ShapeInfo& shape, double weight,
                                 const Eigen::Matrix3d& spin);
  void addLimits(int robot, int joint, const StepSettings* settings);
  void addJointRow(JointRow::Kind kind, int robot, int joint, double sign, double w, double shift, Law law);
  void addMimic(int robot, int joint, double dt);
  void finishRows();
  void collectColumns(const ShapeInfo& shape, const Eigen::Vector3d& position, double sign,
                      std::vector<std::pair<int, Eigen::Vector3d>>& columns) const;
  Eigen::Vector3d baseVelocity(const ShapeInfo& shape, const Eigen::Vector3d& position) const;
  bool movesAlong(const Eigen::Vector3d& normal) const;
  void assembleMass(bool with_implicit);

  /** One contact with the creep law; its row of rolling_rows_ has the same index. */
  struct CreepContact
  {
    int contact;  ///< in contact_rows_
    const CreepTable* curve;
    double base_speed;  ///< share of moving bases in the rolling speed [m/s]
  };

  std::vector<Robot>& robots_;
  const CollisionWorld& world_;
  PairTable pairs_;
  int velocities_ = 0;
  int auxiliaries_ = 0;
  Eigen::VectorXd v_old_;  ///< velocities_: at the start of the step
  Eigen::VectorXd impulse_;  ///< generalized impulse of the guess
  Eigen::VectorXd scratch_;  ///< momentum without bias, robot by robot
  RowBuilder rows_h_;
  RowBuilder rows_g_;
  RowBuilder rows_m_;
  std::vector<double> w_;
  std::vector<double> b_;
  std::vector<double> auxiliary_mass_;
  std::vector<std::pair<int, Eigen::Vector3d>> columns_a_;
  std::vector<std::pair<int, Eigen::Vector3d>> columns_b_;
  std::vector<std::vector<int>> mass_columns_;  ///< tree pattern of M, row by row
  bool creep_ = false;
  int creep_iterations_ = 0;  ///< in this step
  std::vector<RollingShape> rolling_shapes_;  ///< one a shape handle
  std::vector<CreepPoint> creep_points_;  ///< one a detected point, kept over the iterations of a step
  std::vector<CreepContact> creep_contacts_;
  RowBuilder rolling_rows_;  ///< rolling speed along the rolling direction, by generalized velocity
  std::vector<std::pair<int, Eigen::Vector3d>> rolling_columns_;
  std::vector<ContactRow> contact_rows_;
  std::vector<JointRow> joint_rows_;
  std::vector<MimicRow> mimic_rows_;
  IncrementalProblem problem_;
};

}  // namespace frictional_contact_sim
