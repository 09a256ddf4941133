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

  const IncrementalProblem& problem() const { return problem_; }
  const std::vector<ContactRow>& contactRows() const { return contact_rows_; }
  const std::vector<JointRow>& jointRows() const { return joint_rows_; }
  const std::vector<MimicRow>& mimicRows() const { return mimic_rows_; }
  /** @brief Velocities of the robots, without auxiliary ones. */
  int velocities() const { return velocities_; }

private:
  void beginRows();
  void addContact(const ContactPoint& point, int index, const StepSettings* settings);
  void addLimits(int robot, int joint, const StepSettings* settings);
  void addJointRow(JointRow::Kind kind, int robot, int joint, double sign, double w, double shift, Law law);
  void addMimic(int robot, int joint, double dt);
  void finishRows();
  void collectColumns(const ShapeInfo& shape, const Eigen::Vector3d& position, double sign,
                      std::vector<std::pair<int, Eigen::Vector3d>>& columns) const;
  Eigen::Vector3d baseVelocity(const ShapeInfo& shape, const Eigen::Vector3d& position) const;
  bool movesAlong(const Eigen::Vector3d& normal) const;
  void assembleMass(bool with_implicit);

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
  std::vector<ContactRow> contact_rows_;
  std::vector<JointRow> joint_rows_;
  std::vector<MimicRow> mimic_rows_;
  IncrementalProblem problem_;
};

}  // namespace frictional_contact_sim
