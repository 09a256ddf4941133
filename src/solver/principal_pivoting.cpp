#include <cmath>
#include <limits>

#include "frictional_contact_sim/solver/lemke.h"
#include "lcp_tableau.h"

namespace frictional_contact_sim
{
namespace
{
/// Principal transforms of y = M x + b: index i is `swapped` when x_i is basic and y_i is not.
class PrincipalPath
{
public:
  PrincipalPath(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options)
    : options_(options), T_(-M), b_(b), swapped_(static_cast<size_t>(b.size()), false)
  {
    tolerance_ = options.pivot_tolerance * M.lpNorm<Eigen::Infinity>();
  }
  LcpStatus follow(int max_pivots, int& pivots);
  const std::vector<bool>& basic() const { return swapped_; }

private:
  void pivot(Eigen::Index row, Eigen::Index column) { exchange(T_, b_, row, column, work_column_, work_row_); }
  Eigen::Index mostNegative() const;
  Eigen::Index blocking(Eigen::Index driving, double& reached) const;

  const LcpOptions& options_;
  Eigen::MatrixXd T_;
  Eigen::VectorXd b_, work_column_;
  Eigen::RowVectorXd work_row_;
  std::vector<bool> swapped_;
  double tolerance_ = 0.0;
};

Eigen::Index PrincipalPath::mostNegative() const
{
  Eigen::Index row = 0;
  const double smallest = b_.minCoeff(&row);
  return smallest < -options_.pivot_tolerance * b_.lpNorm<Eigen::Infinity>() ? row : -1;
}

/// The basic variable that stops the driving one on its way up from `reached`: basic = b - T x_driving.
Eigen::Index PrincipalPath::blocking(Eigen::Index driving, double& reached) const
{
  double limit = std::numeric_limits<double>::infinity();
  Eigen::Index row = -1;
  for (Eigen::Index i = 0; i < b_.size(); ++i)
  {
    const double slope = -T_(i, driving);
    const double value = b_[i] + slope * reached;
    double length = std::numeric_limits<double>::infinity();
    if (i == driving && slope > tolerance_)
      length = -value / slope;  // the distinguished variable reaches zero from below
    else if (i != driving && value >= 0.0 && slope < -tolerance_)
      length = value / -slope;
    if (length < limit)
    {
      limit = length;
      row = i;
    }
  }
  if (row >= 0)
    reached += std::max(limit, 0.0);
  return row;
}

LcpStatus PrincipalPath::follow(int max_pivots, int& pivots)
{
  pivots = 0;
  for (Eigen::Index driving = mostNegative(); driving >= 0; driving = mostNegative())
  {
    double reached = 0.0;
    while (true)
    {
      if (++pivots > max_pivots)
        return LcpStatus::MAX_PIVOTS;
      if (options_.interrupted && options_.interrupted())
        return LcpStatus::INTERRUPTED;
      const Eigen::Index row = blocking(driving, reached);
      if (row < 0)
        return LcpStatus::RAY;
      if (std::abs(T_(row, row)) > tolerance_)
      {
        pivot(row, row);
        swapped_[static_cast<size_t>(row)] = !swapped_[static_cast<size_t>(row)];
        if (row == driving)
          break;
        continue;
      }
      // A vanishing diagonal entry: the 2 x 2 principal pivot on {row, driving}, done as two crossed exchanges.
      if (std::abs(T_(row, driving)) <= tolerance_)
        return LcpStatus::RAY;
      pivot(row, driving);
      if (std::abs(T_(driving, row)) <= tolerance_)
        return LcpStatus::RAY;
      pivot(driving, row);
      b_.row(row).swap(b_.row(driving));
      T_.row(row).swap(T_.row(driving));
      for (const Eigen::Index i : {row, driving})
        swapped_[static_cast<size_t>(i)] = !swapped_[static_cast<size_t>(i)];
      T_.col(row).swap(T_.col(driving));
      break;
    }
  }
  return LcpStatus::SOLVED;
}
}  // namespace

LcpResult solvePrincipalPivoting(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options)
{
  return followPath<PrincipalPath>(M, b, options);
}

}  // namespace frictional_contact_sim
