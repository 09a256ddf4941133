#include "criterion_program.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
CriterionProgram::CriterionProgram(const ContactKinematics& kinematics, const CriterionUnits& units, double bound,
                                   double cap)
  : kinematics_(kinematics), units_(units)
{
  const int size = static_cast<int>(kinematics.H.cols());
  const double scaled_bound = bound * units.height / units.velocity;
  for (int j = 0; j < size; ++j)
    program_.addColumn(-scaled_bound, scaled_bound, 0.0);
  first_u_ = size;
  for (int j = 0; j < kinematics.H.rows(); ++j)
    program_.addColumn(-LinearProgram::INFINITE, LinearProgram::INFINITE, 0.0);
  s_ = program_.addColumn(-LinearProgram::INFINITE, cap, -1.0);
  addMatrix(kinematics.H, kinematics.w, first_u_);
  first_bilateral_ = addMatrix(kinematics.E, kinematics.b, -1);
}

void CriterionProgram::addFacet(int cone, const Eigen::Vector2d& direction, double slope)
{
  const DualCone& dual = kinematics_.cones[static_cast<size_t>(cone)];
  std::vector<int> columns = {first_u_ + dual.row, s_};
  std::vector<double> values = {1.0, -1.0};
  for (int k = 0; k + 1 < dual.dimension && slope != 0.0; ++k)
  {
    if (std::abs(direction[k]) < 1e-12)
      continue;
    columns.push_back(first_u_ + dual.row + 1 + k);
    values.push_back(-slope * direction[k]);
  }
  facets_.push_back({program_.addRow(0.0, LinearProgram::INFINITE, columns, values), cone, slope * direction});
}

bool CriterionProgram::solve(int max_iterations)
{
  if (!program_.solve(max_iterations))
    return false;
  x_ = program_.solution();
  return true;
}

void CriterionProgram::multipliers(Eigen::VectorXd& r, Eigen::VectorXd& lambda) const
{
  const Eigen::VectorXd prices = program_.prices();
  r.setZero(kinematics_.H.rows());
  for (const Facet& facet : facets_)
  {
    const DualCone& cone = kinematics_.cones[static_cast<size_t>(facet.cone)];
    const double price = std::max(0.0, prices[facet.row]);
    r[cone.row] += price;
    r.segment(cone.row + 1, cone.dimension - 1) -= price * facet.slope.head(cone.dimension - 1);
  }
  lambda = prices.segment(first_bilateral_, kinematics_.E.rows());
}

int CriterionProgram::addMatrix(const SparseRows& matrix, const Eigen::VectorXd& offset, int first_slack)
{
  int first = -1;
  std::vector<int> columns;
  std::vector<double> values;
  for (int j = 0; j < matrix.rows(); ++j)
  {
    columns.clear();
    values.clear();
    for (SparseRows::InnerIterator entry(matrix, j); entry; ++entry)
    {
      columns.push_back(static_cast<int>(entry.col()));
      values.push_back(entry.value() / units_.height);
    }
    if (first_slack >= 0)
    {
      columns.push_back(first_slack + j);
      values.push_back(-1.0);
    }
    const double right = -offset[j] / units_.velocity;
    const int row = program_.addRow(right, right, columns, values);
    if (first < 0)
      first = row;
  }
  return std::max(first, 0);
}

}  // namespace frictional_contact_sim
