// What is zero throughout a cell: containment in earlier modes, implied equations, unbounded impulses (relaxation.h).
#include <algorithm>

#include "mode_bounds.h"
#include "relaxation.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = UNBOUNDED;
constexpr int SIMPLEX_ITERATIONS = 20000;
/// Slacks are driven up to here to show that they can rise at all.
constexpr double RAISED = 1.0;
/// Smaller slacks count as zero throughout. Below the tolerance of feasibility: what is left out here for lying in an
/// earlier mode is feasible there.
constexpr double ZERO = 1e-10;
}  // namespace

double Relaxation::value(const Slack& slack) const
{
  const double x = slack.index < columns() ? y_[slack.index] : A_.row(slack.index - columns()).dot(y_);
  const Eigen::VectorXd& lower = slack.index < columns() ? column_lower_ : row_lower_;
  const Eigen::VectorXd& upper = slack.index < columns() ? column_upper_ : row_upper_;
  const int index = slack.index < columns() ? slack.index : slack.index - columns();
  return slack.sign > 0.0 ? x - lower[index] : upper[index] - x;
}

/**
 * Which slacks are not zero throughout the cell solved last. All that are zero at the point are driven up together, to
 * RAISED at most, again and again until none of them rises.
 * @param average the point becomes the mean of all that were met
 */
std::vector<bool> Relaxation::canRise(const std::vector<Slack>& slacks, bool average)
{
  std::vector<bool> rises(slacks.size(), false);
  Eigen::VectorXd sum = y_;
  double count = 1.0;
  for (bool goes_on = true; goes_on;)
  {
    Eigen::VectorXd costs = Eigen::VectorXd::Zero(columns());
    Eigen::VectorXd column_lower = column_lower_, column_upper = column_upper_, row_lower = row_lower_,
                    row_upper = row_upper_;
    bool any = false;
    for (size_t k = 0; k < slacks.size(); ++k)
    {
      const Slack& slack = slacks[k];
      rises[k] = rises[k] || value(slack) > ZERO;
      if (rises[k])
        continue;
      any = true;
      const bool is_column = slack.index < columns();
      const int index = is_column ? slack.index : slack.index - columns();
      Eigen::VectorXd& lower = is_column ? column_lower : row_lower;
      Eigen::VectorXd& upper = is_column ? column_upper : row_upper;
      if (is_column)
        costs[index] -= slack.sign;
      else
        costs -= slack.sign * A_.row(index).transpose();
      (slack.sign > 0.0 ? upper : lower)[index] = slack.sign > 0.0 ? std::min(upper[index], lower[index] + RAISED)
                                                                   : std::max(lower[index], upper[index] - RAISED);
    }
    if (!any)
      break;
    program_.setBounds(column_lower, column_upper, row_lower, row_upper);
    program_.setCosts(costs);
    const bool solved = program_.solvePrimal(SIMPLEX_ITERATIONS);
    program_.setCosts(Eigen::VectorXd::Zero(columns()));
    if (!solved)
    {
      // Not known: nothing may be concluded from a slack that did not rise.
      rises.assign(rises.size(), true);
      break;
    }
    y_ = program_.solution();
    sum += y_;
    ++count;
    goes_on = false;
    for (size_t k = 0; k < slacks.size(); ++k)
      goes_on = goes_on || (!rises[k] && value(slacks[k]) > ZERO);
  }
  if (average)
    y_ = sum / count;
  program_.setBounds(column_lower_, column_upper_, row_lower_, row_upper_);
  return rises;
}

/** sign u <= 0 on a row throughout the cell solved last. */
bool Relaxation::staysBelow(int row, double sign)
{
  const Eigen::VectorXd slope = A_.row(row);
  if (sign * (slope.dot(y_) + shift_[row]) > ZERO)
    return false;
  program_.setCosts(-sign * slope);
  const bool bounded = program_.solvePrimal(SIMPLEX_ITERATIONS);
  program_.setCosts(Eigen::VectorXd::Zero(columns()));
  return bounded && sign * (slope.dot(program_.solution()) + shift_[row]) <= ZERO;
}

bool Relaxation::isContained(const Cell& cell)
{
  const Eigen::VectorXd point = y_;
  std::vector<Slack> slacks;
  std::vector<size_t> owners;
  for (size_t i = 0; i < cell.modes.size(); ++i)
  {
    const LawMode mode = cell.modes[i];
    const int first = columns() + island_.offsets[i];
    const int tangential = first + (island_.laws[i].type == LawType::DRY_FRICTION ? 0 : 1);
    if (mode == LawMode::RIGHT || mode == LawMode::LEFT)
      slacks.push_back({tangential, mode == LawMode::RIGHT ? 1.0 : -1.0});
    else if (mode == LawMode::OPEN)
      slacks.push_back({first, 1.0});
    else if (mode == LawMode::SLIDE)  // no slip where u_T is at no distance from either side of the wedge
    {
      slacks.push_back({first + 1, 1.0});
      owners.push_back(i);
      slacks.push_back({first + 2, 1.0});
    }
    else
      continue;
    owners.push_back(i);
  }
  const std::vector<bool> rises = canRise(slacks, false);
  bool contained = false;
  for (size_t k = 0; k < owners.size() && !contained; ++k)
  {
    if (rises[k])
      continue;
    const Law& law = island_.laws[owners[k]];
    const LawMode mode = cell.modes[owners[k]];
    if (mode == LawMode::SLIDE)
      contained = k + 1 < owners.size() && owners[k + 1] == owners[k] && !rises[k + 1];
    else if (mode != LawMode::OPEN || !isFrictional(law))
      contained = true;
    else if (law.type == LawType::COULOMB_2D)  // right, left or (both) stick where u_T keeps its sign
      contained = staysBelow(island_.offsets[owners[k]] + 1, 1.0) || staysBelow(island_.offsets[owners[k]] + 1, -1.0);
    else
      contained = isZero(island_.offsets[owners[k]] + 1) && isZero(island_.offsets[owners[k]] + 2);
  }
  y_ = point;
  return contained;
}

Eigen::MatrixXd Relaxation::impliedEquations()
{
  std::vector<Slack> slacks;
  const auto add = [&slacks](int index, double lower, double upper)
  {
    if (lower >= upper)
      return;
    if (lower > -INFINITE)
      slacks.push_back({index, 1.0});
    if (upper < INFINITE)
      slacks.push_back({index, -1.0});
  };
  for (int j = 0; j < columns(); ++j)
    add(j, column_lower_[j], column_upper_[j]);
  for (Eigen::Index i = 0; i < row_lower_.size(); ++i)
    add(columns() + static_cast<int>(i), row_lower_[i], row_upper_[i]);
  const std::vector<bool> rises = canRise(slacks, true);
  Eigen::MatrixXd equations(std::count(rises.begin(), rises.end(), false), columns());
  Eigen::Index row = 0;
  for (size_t k = 0; k < slacks.size(); ++k)
    if (!rises[k])
      equations.row(row++) = slacks[k].index < columns()
                                 ? Eigen::RowVectorXd(Eigen::RowVectorXd::Unit(columns(), slacks[k].index))
                                 : Eigen::RowVectorXd(A_.row(slacks[k].index - columns()));
  return equations;
}

bool Relaxation::isBounded()
{
  // Cones are pointed: something with a lower bound only grows along every ray.
  Eigen::VectorXd costs = Eigen::VectorXd::Zero(columns());
  for (int j = 0; j < columns(); ++j)
    if (column_lower_[j] > -INFINITE && column_upper_[j] >= bound_)
      costs[j] = -1.0;
  program_.setCosts(costs);
  const bool bounded = program_.solvePrimal(SIMPLEX_ITERATIONS) && program_.solution().maxCoeff() < 0.99 * bound_;
  program_.setCosts(Eigen::VectorXd::Zero(columns()));
  return bounded;
}

}  // namespace frictional_contact_sim
