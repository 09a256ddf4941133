#include "relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mode_bounds.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = UNBOUNDED;
constexpr double NOT_TURNED = std::numeric_limits<double>::quiet_NaN();
constexpr double PI = 3.14159265358979323846;
constexpr int FACETS = 8;  ///< of a cone in 3D, before cuts
constexpr int WEDGE_ROWS = 4;
constexpr int SIMPLEX_ITERATIONS = 20000;
/// Of an impulse, relative: what is known of its distance from a cone.
constexpr double ROUND_OFF = 1e-14;

double shifted(double bound, double shift)
{
  return std::abs(bound) == INFINITE ? bound : bound - shift;
}
}  // namespace

Relaxation::Relaxation(const ScaledIsland& island, const EnumerateOptions& options)
  : island_(island), bound_(options.impulse_bound)
{
  const int rows = island.rows();
  const size_t laws = island.laws.size();
  T_ = Eigen::MatrixXd::Identity(rows, rows);
  int size = rows;
  for (size_t i = 0; i < laws; ++i)
  {
    const Law& law = island.laws[i];
    modes_.push_back(modesOf(law));
    spatial_.push_back(law.type == LawType::COULOMB_3D && isFrictional(law));
    wedge_rows_.push_back(spatial_.back() ? size : -1);
    sides_.emplace_back(NOT_TURNED, NOT_TURNED);
    size += spatial_.back() ? WEDGE_ROWS + FACETS : 0;
    if (law.type == LawType::COULOMB_2D && isFrictional(law))
    {
      const double mu = law.coefficient, length = std::sqrt(1.0 + mu * mu);
      T_.block<2, 2>(island.offsets[i], island.offsets[i]) << 1.0 / length, 1.0 / length, mu / length, -mu / length;
    }
  }
  const auto equations = static_cast<int>(island.e.size());
  for (int k = 0; k < equations; ++k)
    equation_rows_.push_back(size + k);
  U_ = island.W * T_;
  A_.setZero(size + equations, rows);
  A_.topRows(rows) = U_;
  A_.bottomRows(equations) = island.E * T_;
  shift_.setZero(A_.rows());
  shift_.head(rows) = island.q;
  shift_.tail(equations) = -island.e;
  for (size_t i = 0; i < laws; ++i)
    for (int k = 0; spatial_[i] && k < FACETS; ++k)
    {
      const double angle = 2.0 * PI * k / FACETS;
      const int row = wedge_rows_[i] + WEDGE_ROWS + k;
      A_.block<1, 3>(row, island.offsets[i]) << island.laws[i].coefficient, std::cos(angle), std::sin(angle);
    }
  for (int j = 0; j < rows; ++j)
    program_.addColumn(-INFINITE, INFINITE, 0.0);
  for (Eigen::Index i = 0; i < A_.rows(); ++i)
  {
    std::vector<int> used;
    std::vector<double> values;
    for (int j = 0; j < rows; ++j)
      if (A_(i, j) != 0.0)
      {
        used.push_back(j);
        values.push_back(A_(i, j));
      }
    program_.addRow(-INFINITE, INFINITE, used, values);
  }
  column_lower_.setZero(rows);
  column_upper_.setZero(rows);
  row_lower_.setConstant(A_.rows(), -INFINITE);
  row_upper_.setConstant(A_.rows(), INFINITE);
  program_.solve(SIMPLEX_ITERATIONS);
}

Eigen::VectorXd Relaxation::impulses(const Eigen::VectorXd& y) const
{
  return T_ * y;
}

void Relaxation::changeEntries(int row, const Eigen::VectorXd& values)
{
  for (int j = 0; j < columns(); ++j)
    if (A_(row, j) != values[j])
    {
      program_.setEntry(row, j, values[j]);
      A_(row, j) = values[j];
    }
}

/** Rows of u_T as distances from the sides of a wedge, or as they are. */
void Relaxation::turnRows(int law, double first, double second)
{
  Eigen::Vector2d& sides = sides_[static_cast<size_t>(law)];
  const bool same = std::isnan(first) ? std::isnan(sides[0]) : sides == Eigen::Vector2d(first, second);
  if (same)
    return;
  sides = {first, second};
  const int row = island_.offsets[static_cast<size_t>(law)] + 1;
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();
  if (!std::isnan(first))
    turn << -std::sin(first), std::cos(first), std::sin(second), -std::cos(second);
  const Eigen::MatrixXd turned = turn * U_.middleRows<2>(row);
  changeEntries(row, turned.row(0));
  changeEntries(row + 1, turned.row(1));
  shift_.segment<2>(row) = turn * island_.q.segment<2>(row);
}

void Relaxation::setWedge(int law, LawMode mode, const Cell& cell)
{
  const auto index = static_cast<size_t>(law);
  const int base = wedge_rows_[index];
  const Interval wedge = {mode == LawMode::SLIDE ? 0.0 : -INFINITE, INFINITE};
  row_lower_.segment<WEDGE_ROWS>(base).setConstant(wedge.lower);
  row_upper_.segment<WEDGE_ROWS>(base).setConstant(wedge.upper);
  row_lower_.segment<FACETS>(base + WEDGE_ROWS).setZero();
  if (mode != LawMode::SLIDE)
  {
    turnRows(law, NOT_TURNED, NOT_TURNED);
    return;
  }
  const double center = cell.centers[index], half = cell.halves[index], mu = island_.laws[index].coefficient;
  turnRows(law, center - half, center + half);
  const int column = island_.offsets[index];
  const auto tangent = [&](int row, double angle, double sign, double normal)
  {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(columns());
    values.segment<3>(column) << normal, sign * std::cos(angle), sign * std::sin(angle);
    changeEntries(row, values);
  };
  tangent(base, center, -1.0, -mu * std::cos(half));  // the chord
  for (int k = 0; k < 3; ++k)
    tangent(base + 1 + k, center + (k - 1) * half, 1.0, mu);
}

void Relaxation::setLaw(int law, LawMode mode, const Cell& cell)
{
  const auto index = static_cast<size_t>(law);
  if (isSpatial(law))
    setWedge(law, mode, cell);
  const ModeBounds bounds = modeBounds(island_.laws[index], mode);
  for (int k = 0; k < island_.laws[index].dimension(); ++k)
  {
    const int row = island_.offsets[index] + k;
    column_lower_[row] = bounds.columns[k].lower;
    column_upper_[row] = bounds.columns[k].upper;
    row_lower_[row] = shifted(bounds.rows[k].lower, shift_[row]);
    row_upper_[row] = shifted(bounds.rows[k].upper, shift_[row]);
    if (!isSpatial(law))
      continue;
    // Facets cannot exclude what a cone excludes only at infinity, such as r = (a, -a, 2) of example 3.21.
    const double most = k == 0 ? bound_ : bound_ * std::max(1.0, island_.laws[index].coefficient);
    column_lower_[row] = std::max(column_lower_[row], -most);
    column_upper_[row] = std::min(column_upper_[row], most);
  }
}

void Relaxation::setBounds(const Cell& cell)
{
  for (size_t i = 0; i < island_.laws.size(); ++i)
    setLaw(static_cast<int>(i), cell.modes[i], cell);
  for (const int row : equation_rows_)
    row_lower_[row] = row_upper_[row] = -shift_[row];
  for (size_t k = 0; k < cut_rows_.size(); ++k)
    row_upper_[cut_rows_[k]] = k < right_hand_sides_.size() && !suspended_ ? right_hand_sides_[k] : INFINITE;
}

void Relaxation::addCut(const Eigen::VectorXd& row, double right_hand_side)
{
  if (cut_rows_.size() == right_hand_sides_.size())
  {
    cut_rows_.push_back(static_cast<int>(A_.rows()));
    appendRow(row, -INFINITE, right_hand_side);
  }
  else
    changeEntries(cut_rows_[right_hand_sides_.size()], row);
  right_hand_sides_.push_back(right_hand_side);
}

/** No shift: bounds are those of row.y itself. */
void Relaxation::appendRow(const Eigen::VectorXd& values, double lower, double upper)
{
  std::vector<int> used;
  std::vector<double> entries;
  for (int j = 0; j < columns(); ++j)
    if (values[j] != 0.0)
    {
      used.push_back(j);
      entries.push_back(values[j]);
    }
  program_.addRow(lower, upper, used, entries);
  const Eigen::Index row = A_.rows();
  A_.conservativeResize(row + 1, Eigen::NoChange);
  A_.row(row) = values.transpose();
  for (Eigen::VectorXd* vector : {&shift_, &row_lower_, &row_upper_})
    vector->conservativeResize(row + 1);
  shift_[row] = 0.0;
  row_lower_[row] = lower;
  row_upper_[row] = upper;
}

Feasibility Relaxation::solve(const Cell& cell)
{
  setBounds(cell);
  if (hasImpossibleRow())
    return Feasibility::INFEASIBLE;
  program_.setBounds(column_lower_, column_upper_, row_lower_, row_upper_);
  if (program_.solve(SIMPLEX_ITERATIONS))
  {
    y_ = program_.solution();
    return Feasibility::FEASIBLE;
  }
  const bool proved =
      program_.status() == LinearProgramStatus::INFEASIBLE && provesInfeasible(program_.infeasibilityRay());
  return proved ? Feasibility::INFEASIBLE : solveElastic();
}

/**
 * The sum of what rows are violated by, minimised from a fresh basis: its multipliers prove infeasibility where the
 * simplex method's own ray does not (Clp's is now and then that of another basis).
 */
Feasibility Relaxation::solveElastic()
{
  LinearProgram elastic;
  for (int j = 0; j < columns(); ++j)
    elastic.addColumn(column_lower_[j], column_upper_[j], 0.0);
  for (Eigen::Index i = 0; i < 2 * A_.rows(); ++i)
    elastic.addColumn(0.0, INFINITE, 1.0);
  for (int i = 0; i < A_.rows(); ++i)
  {
    std::vector<int> used = {columns() + 2 * i, columns() + 2 * i + 1};
    std::vector<double> values = {1.0, -1.0};
    for (int j = 0; j < columns(); ++j)
      if (A_(i, j) != 0.0)
      {
        used.push_back(j);
        values.push_back(A_(i, j));
      }
    elastic.addRow(row_lower_[i], row_upper_[i], used, values);
  }
  if (!elastic.solve(SIMPLEX_ITERATIONS))
    return Feasibility::UNPROVED;
  if (provesInfeasible(elastic.prices()))
    return Feasibility::INFEASIBLE;
  const Eigen::VectorXd x = elastic.solution();
  if (x.tail(2 * A_.rows()).sum() > TOLERANCE)
    return Feasibility::UNPROVED;
  y_ = x.head(columns());
  return Feasibility::FEASIBLE;
}

/** A row that the columns' bounds alone keep out of its own, among them rows that nothing moves. */
bool Relaxation::hasImpossibleRow() const
{
  for (Eigen::Index i = 0; i < A_.rows(); ++i)
  {
    double low = 0.0, high = 0.0;
    for (Eigen::Index j = 0; j < A_.cols(); ++j)
    {
      const double a = A_(i, j);
      if (a == 0.0)
        continue;
      low += a > 0.0 ? a * column_lower_[j] : a * column_upper_[j];
      high += a > 0.0 ? a * column_upper_[j] : a * column_lower_[j];
    }
    if (low > row_upper_[i] + TOLERANCE || high < row_lower_[i] - TOLERANCE)
      return true;
  }
  return false;
}

bool Relaxation::meets(const Cell& a, const Cell& b)
{
  setBounds(a);
  const Eigen::VectorXd column_lower = column_lower_, column_upper = column_upper_, row_lower = row_lower_,
                        row_upper = row_upper_;
  setBounds(b);
  column_lower_ = column_lower_.cwiseMax(column_lower);
  column_upper_ = column_upper_.cwiseMin(column_upper);
  row_lower_ = row_lower_.cwiseMax(row_lower);
  row_upper_ = row_upper_.cwiseMin(row_upper);
  if ((column_lower_.array() > column_upper_.array()).any() || (row_lower_.array() > row_upper_.array()).any())
    return false;
  program_.setBounds(column_lower_, column_upper_, row_lower_, row_upper_);
  return program_.solve(SIMPLEX_ITERATIONS);
}

/**
 * Whether z.(A y) cannot be in both its ranges, the one of the columns' bounds and the one of the rows', |y| <= bound.
 * What round-off may do to A^T z, gamma |A|^T |z|, goes against the proof.
 */
bool Relaxation::provesInfeasible(const Eigen::VectorXd& multipliers) const
{
  const double size = multipliers.size() == 0 ? 0.0 : multipliers.lpNorm<Eigen::Infinity>();
  if (!(size > 0.0) || !std::isfinite(size))
    return false;
  const double gamma = 4.0 * std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(A_.rows()));
  for (const double sign : {1.0, -1.0})
  {
    const Eigen::VectorXd z = sign / size * multipliers;
    const Eigen::VectorXd slope = A_.transpose() * z, error = gamma * (A_.cwiseAbs().transpose() * z.cwiseAbs());
    double low = 0.0, high = 0.0, terms = 0.0;
    for (Eigen::Index j = 0; j < slope.size(); ++j)
    {
      const double lower = std::max(column_lower_[j], -bound_), upper = std::min(column_upper_[j], bound_);
      const double least = std::min({(slope[j] - error[j]) * lower, (slope[j] + error[j]) * lower,
                                     (slope[j] - error[j]) * upper, (slope[j] + error[j]) * upper});
      low += least;
      terms += std::abs(least);
    }
    for (Eigen::Index i = 0; i < z.size(); ++i)
    {
      if (z[i] == 0.0)
        continue;
      const double reach = bound_ * A_.row(i).lpNorm<1>();
      const double lower = row_lower_[i] == -INFINITE ? -reach : row_lower_[i];
      const double upper = row_upper_[i] == INFINITE ? reach : row_upper_[i];
      const double most = std::max(z[i] * lower, z[i] * upper);
      high += most;
      terms += std::abs(most);
    }
    if (low - high > gamma * terms)
      return true;
  }
  return false;
}

double Relaxation::violation(int law, LawMode mode) const
{
  const auto index = static_cast<size_t>(law);
  const ModeBounds bounds = modeBounds(island_.laws[index], mode);
  const auto beyond = [](double x, const Interval& interval) {
    return std::max({0.0, interval.lower - x, x - interval.upper});
  };
  const int first = island_.offsets[index], dimension = island_.laws[index].dimension();
  const Eigen::VectorXd u = U_.middleRows(first, dimension) * y_ + island_.q.segment(first, dimension);
  if (mode == LawMode::SLIDE)
  {
    const Eigen::Vector2d r = y_.segment<2>(first + 1), slip = u.tail<2>();
    const double speed = slip.norm(), mu = island_.laws[index].coefficient;
    return std::abs(u[0]) + (speed > 0.0 ? (r + mu * y_[first] / speed * slip).norm() : mu * y_[first] - r.norm());
  }
  double sum = 0.0;
  for (int k = 0; k < dimension; ++k)
    sum += beyond(y_[first + k], bounds.columns[k]) + beyond(u[k], bounds.rows[k]);
  return sum;
}

/** The law in 3D whose cone the point leaves farthest, -1 when it leaves none. */
int Relaxation::farthestCone(const Cell& cell) const
{
  int worst = -1;
  double farthest = 0.0;
  for (size_t i = 0; i < cell.modes.size(); ++i)
  {
    if (!isSpatial(static_cast<int>(i)))
      continue;
    const Eigen::Vector3d r = y_.segment<3>(island_.offsets[i]);
    const double outside = r.tail<2>().norm() - island_.laws[i].coefficient * r[0];
    if (outside > TOLERANCE + ROUND_OFF * r.norm() && outside > farthest)
    {
      farthest = outside;
      worst = static_cast<int>(i);
    }
  }
  return worst;
}

bool Relaxation::cutCones(const Cell& cell)
{
  const int worst = farthestCone(cell);
  if (worst < 0)
    return false;
  const int column = island_.offsets[static_cast<size_t>(worst)];
  const Eigen::Vector2d direction = -y_.segment<2>(column + 1).normalized();
  const double mu = island_.laws[static_cast<size_t>(worst)].coefficient;
  Eigen::VectorXd facet = Eigen::VectorXd::Zero(columns());
  facet.segment<3>(column) << mu, direction[0], direction[1];
  appendRow(facet, 0.0, INFINITE);
  return true;
}

}  // namespace frictional_contact_sim
