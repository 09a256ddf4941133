#pragma once
/**
 * @file relaxation.h
 * @brief The linear program at a node: what the modes decided so far say exactly, what is undecided from outside.
 *
 * Columns y, rows a = A y with bounds on both; u' = a + q' on the first rows:
 *
 *   COULOMB_2D   r = (t+ (1, mu) + t- (1, -mu)) / sqrt(1 + mu^2), columns t+, t- >= 0; right: t+ = 0, left: t- = 0
 *   COULOMB_3D   columns r; facets mu r_N + d_k.r_T >= 0; in `slide` rows of u_T are turned to its distances from the
 *                two sides of the wedge, four more rows hold r in the convex hull of the wedge's arc
 *   others       columns r
 * Modes change bounds and, in 3D, entries only: every node starts from the basis of the one before.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/linear_program.h"
#include "frictional_contact_sim/solver/enumeration/enumeration.h"
#include "scaled_island.h"

namespace frictional_contact_sim
{
/** @brief A node of the search: a mode each law; of a sliding one in 3D the wedge |angle of u_T - center| <= half. */
struct Cell
{
  std::vector<LawMode> modes;
  std::vector<double> centers, halves;  ///< [rad]
};

enum class Feasibility
{
  FEASIBLE,
  INFEASIBLE,  ///< proved
  UNPROVED  ///< the simplex method found nothing, and no proof either
};

class Relaxation
{
public:
  /// Feasible up to this, in the units of the scaled island.
  static constexpr double TOLERANCE = 1e-9;

  Relaxation(const ScaledIsland& island, const EnumerateOptions& options);

  /** @brief Modes of a law, most inclusive first: where two overlap the earlier one is kept. */
  const std::vector<LawMode>& modes(int law) const { return modes_[static_cast<size_t>(law)]; }
  bool isSpatial(int law) const { return spatial_[static_cast<size_t>(law)]; }

  Feasibility solve(const Cell& cell);
  /** @brief Another cell's bounds on top of those of the cell solved last: is there a common point? No wedges. */
  bool meets(const Cell& a, const Cell& b);
  /** @brief Of the last FEASIBLE solve. */
  const Eigen::VectorXd& point() const { return y_; }
  Eigen::VectorXd impulses(const Eigen::VectorXd& y) const;
  /** @brief How far the point is from a mode of a law: the sum of its violated bounds. */
  double violation(int law, LawMode mode) const;

  /** @brief A further row.y <= right_hand_side from the next solve on; the last one added is the first to go. */
  void addCut(const Eigen::VectorXd& row, double right_hand_side);
  /** @brief Cuts that hold now. */
  size_t cuts() const { return right_hand_sides_.size(); }
  /** @brief The first `count` of them remain. */
  void keepCuts(size_t count) { right_hand_sides_.resize(count); }
  /** @brief The next solves go without cuts, or with them again. */
  void suspendCuts(bool suspended) { suspended_ = suspended; }

  /** @brief Every point of the cell solved last is one of the same cell with one law in an earlier mode. */
  bool isContained(const Cell& cell);
  /**
   * @brief Inequalities of the cell solved last that are equations throughout, as rows of coefficients of y; with them
   * the polyhedron has a relative interior, whose point becomes point().
   */
  Eigen::MatrixXd impliedEquations();

  /** @brief The impulses of the cell solved last do not grow without bound. */
  bool isBounded();

  /** @brief The point is outside a cone in 3D, by more than TOLERANCE. */
  bool leavesCones(const Cell& cell) const { return farthestCone(cell) >= 0; }
  /** @brief 3D: a facet through where the point leaves a cone farthest. @return false when it leaves none */
  bool cutCones(const Cell& cell);

  const Eigen::MatrixXd& matrix() const { return A_; }
  const Eigen::VectorXd& columnLower() const { return column_lower_; }
  const Eigen::VectorXd& columnUpper() const { return column_upper_; }
  const Eigen::VectorXd& rowLower() const { return row_lower_; }
  const Eigen::VectorXd& rowUpper() const { return row_upper_; }
  /** @brief u' = U y + q'. */
  const Eigen::MatrixXd& velocities() const { return U_; }
  /** @brief r' = T y. */
  const Eigen::MatrixXd& generators() const { return T_; }

private:
  /// A quantity that its bound says to be >= 0: a column or a row (index behind the columns) less its bound.
  struct Slack
  {
    int index;
    double sign;
  };

  int farthestCone(const Cell& cell) const;
  void setBounds(const Cell& cell);
  void setLaw(int law, LawMode mode, const Cell& cell);
  void setWedge(int law, LawMode mode, const Cell& cell);
  void turnRows(int law, double first, double second);
  void appendRow(const Eigen::VectorXd& values, double lower, double upper);
  void changeEntries(int row, const Eigen::VectorXd& values);
  bool provesInfeasible(const Eigen::VectorXd& multipliers) const;
  Feasibility solveElastic();
  bool hasImpossibleRow() const;
  bool staysBelow(int row, double sign);
  bool isZero(int row) { return staysBelow(row, 1.0) && staysBelow(row, -1.0); }
  double value(const Slack& slack) const;
  std::vector<bool> canRise(const std::vector<Slack>& slacks, bool average);
  int columns() const { return static_cast<int>(T_.cols()); }

  const ScaledIsland& island_;
  double bound_;
  LinearProgram program_;
  std::vector<std::vector<LawMode>> modes_;
  std::vector<bool> spatial_;
  std::vector<int> wedge_rows_;  ///< first of the four, -1 without
  std::vector<Eigen::Vector2d> sides_;  ///< angles that the tangential rows are turned to, NaN: not turned
  Eigen::MatrixXd T_, A_, U_;  ///< U_ = W' T
  Eigen::VectorXd shift_;  ///< of each row of A_: u' or e = a + shift
  Eigen::VectorXd column_lower_, column_upper_, row_lower_, row_upper_;
  std::vector<int> equation_rows_;
  std::vector<int> cut_rows_;  ///< rows of A_ made for cuts; those behind right_hand_sides_ are idle
  std::vector<double> right_hand_sides_;
  bool suspended_ = false;
  Eigen::VectorXd y_;
};

}  // namespace frictional_contact_sim
