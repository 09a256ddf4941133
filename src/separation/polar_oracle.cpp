#include "frictional_contact_sim/separation/polar_oracle.h"

#include <cmath>
#include <stdexcept>

#include "dense_rows.h"
#include "pivot_row.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int SIMPLEX_ITERATIONS = 200000;
/// Reduced costs above this, over the largest cost, keep a column at zero on the whole face.
constexpr double POSITIVE = 1e-9;
}  // namespace

PolarOracle::PolarOracle(const Disjunction& disjunction, double bound)
{
  validate(disjunction);
  int column = 0;
  for (size_t k = 0; k < disjunction.terms.size(); ++k)
  {
    terms_.push_back(disjunction.term(k));
    pivots_.push_back(pivotRow(terms_.back(), "term " + std::to_string(k)));
    firsts_.push_back(column);
    for (int i = 0; i <= terms_.back().rows(); ++i)
      program_.addColumn(0.0, LinearProgram::INFINITE, 0.0);
    column += terms_.back().rows() + 1;
  }
  const Polyhedron& first = terms_.front();
  for (size_t k = 1; k < terms_.size(); ++k)
    for (int j = 0; j < disjunction.dimension(); ++j)
    {
      ProgramRow row;
      row.add(first.A.col(j), 0);
      row.add(terms_[k].A.col(j), firsts_[k], -1.0);
      row.addTo(program_, 0.0, 0.0);
    }
  ProgramRow sum;
  for (size_t k = 0; k < terms_.size(); ++k)
  {
    ProgramRow row;
    row.add(terms_[k].b, firsts_[k]);
    row.add(firsts_[k] + terms_[k].rows(), -terms_[k].b[pivots_[k]]);
    row.addTo(program_, -1.0, -1.0);
    for (int i = 0; i <= terms_[k].rows(); ++i)
      sum.add(firsts_[k] + i, i == pivots_[k] ? 0.0 : 1.0);
  }
  const auto equations = static_cast<Eigen::Index>((terms_.size() - 1) * disjunction.dimension() + terms_.size());
  row_lower_.setZero(equations + (bound > 0.0 ? 1 : 0));
  row_lower_.segment(equations - static_cast<Eigen::Index>(terms_.size()), static_cast<Eigen::Index>(terms_.size()))
      .setConstant(-1.0);
  row_upper_ = row_lower_;
  if (bound > 0.0)
  {
    sum.addTo(program_, -LinearProgram::INFINITE, bound);
    row_lower_[equations] = -LinearProgram::INFINITE;
    row_upper_[equations] = bound;
  }
  generic_.resize(disjunction.dimension());
  for (Eigen::Index j = 0; j < generic_.size(); ++j)
    generic_[j] = std::cos(1.0 + 2.3 * static_cast<double>(j * j));
  lower_.setZero(column);
  upper_.setConstant(column, LinearProgram::INFINITE);
  feasible_ = solveFirst(program_);
}

Eigen::VectorXd PolarOracle::costs(const Eigen::VectorXd& direction) const
{
  Eigen::VectorXd result = Eigen::VectorXd::Zero(lower_.size());
  result.head(terms_.front().rows()) = terms_.front().A * direction;
  return result;
}

/** Costs of order one whatever the length of d_0: tolerances are absolute. */
bool PolarOracle::minimise(const Eigen::VectorXd& direction)
{
  const Eigen::VectorXd cost = costs(direction);
  const double size = cost.lpNorm<Eigen::Infinity>();
  program_.setCosts(size > 0.0 ? Eigen::VectorXd(cost / size) : cost);
  return program_.solvePrimal(SIMPLEX_ITERATIONS);
}

/** The bounds become those of the minimisers of the last minimise(). */
void PolarOracle::fixFace()
{
  const Eigen::VectorXd reduced = program_.reducedCosts(), prices = program_.prices();
  for (Eigen::Index j = 0; j < reduced.size(); ++j)
    if (reduced[j] > POSITIVE)
      upper_[j] = 0.0;
  for (Eigen::Index i = 0; i < prices.size(); ++i)
    if (std::abs(prices[i]) > POSITIVE && row_upper_[i] < LinearProgram::INFINITE)
      row_lower_[i] = row_upper_[i];
  program_.setBounds(lower_, upper_, row_lower_, row_upper_);
}

void PolarOracle::goToExtremePoint()
{
  const Eigen::VectorXd upper = upper_, row_lower = row_lower_;
  fixFace();
  if (minimise(generic_) || minimise(-generic_))
    solution_ = program_.solution();
  upper_ = upper;
  row_lower_ = row_lower;
  program_.setBounds(lower_, upper_, row_lower_, row_upper_);
}

OracleAnswer PolarOracle::operator()(const Eigen::VectorXd& direction)
{
  if (!feasible_)
    return {OracleStatus::EMPTY, {}};
  minimise(direction);
  const LinearProgramStatus status = program_.status();
  const bool is_ray = status == LinearProgramStatus::UNBOUNDED;
  solution_.resize(0);
  if (is_ray)
    solution_ = program_.unboundedRay();
  else if (status == LinearProgramStatus::OPTIMAL)
  {
    solution_ = program_.solution();
    goToExtremePoint();
  }
  if (solution_.size() == 0)
    return {OracleStatus::FAILED, {}};
  return {OracleStatus::FOUND, {terms_.front().A.transpose() * multipliers(0), is_ray}};
}

void PolarOracle::restrictToFace(const Eigen::VectorXd& direction)
{
  if (feasible_ && minimise(direction))
    fixFace();
}

Eigen::VectorXd PolarOracle::multipliers(size_t term) const
{
  return solution_.segment(firsts_[term], terms_[term].rows());
}

double PolarOracle::multiplierSum() const
{
  double sum = solution_.sum();
  for (size_t k = 0; k < terms_.size(); ++k)
    sum -= solution_[firsts_[k] + pivots_[k]];
  return sum;
}

}  // namespace frictional_contact_sim
