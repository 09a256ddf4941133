#include "frictional_contact_sim/solver/lemke.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "lcp_tableau.h"
#include "options_check.h"

namespace frictional_contact_sim
{
namespace
{
/// Entries of the tableau changed between two questions to `interrupted`: half a millisecond.
constexpr int ASK_EVERY = 1000000;
/// What a solution may violate signs by, relative to the largest of |b| and |x|, before it counts as failed.
constexpr double SIGN_TOLERANCE = 1e-7;

/// Lemke's path. Variables 0..n-1 are x, n..2n-1 are y, 2n is the artificial one.
class LemkePath
{
public:
  LemkePath(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options);
  LcpStatus follow(int max_pivots, int& pivots);
  std::vector<bool> basic() const;

private:
  void pivot(int row, int column);
  int blockingRow(int column);
  /// Entry of B^-1 for the column of y_j.
  double inverseEntry(int row, int j) const;
  void breakTies(int column);

  const LcpOptions& options_;
  int n_;
  Eigen::MatrixXd T_;
  Eigen::VectorXd b_, work_column_;
  Eigen::RowVectorXd work_row_;
  std::vector<int> row_of_, column_of_;  ///< position of each variable, -1 when it is on the other side
  std::vector<int> basic_, nonbasic_;
  std::vector<int> ties_;
};

LemkePath::LemkePath(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options)
  : options_(options), n_(static_cast<int>(b.size())), T_(n_, n_ + 1), b_(b)
{
  T_.leftCols(n_) = -M;
  if (options.covering.size() > 0)
    T_.col(n_) = -options.covering;
  else
    T_.col(n_).setConstant(-1.0);
  row_of_.assign(static_cast<size_t>(2 * n_ + 1), -1);
  column_of_ = row_of_;
  for (int i = 0; i < n_; ++i)
  {
    basic_.push_back(n_ + i);
    nonbasic_.push_back(i);
    row_of_[static_cast<size_t>(n_ + i)] = i;
    column_of_[static_cast<size_t>(i)] = i;
  }
  nonbasic_.push_back(2 * n_);
  column_of_[static_cast<size_t>(2 * n_)] = n_;
}

void LemkePath::pivot(int row, int column)
{
  exchange(T_, b_, row, column, work_column_, work_row_);
  const int leaving = basic_[static_cast<size_t>(row)];
  const int entering = nonbasic_[static_cast<size_t>(column)];
  basic_[static_cast<size_t>(row)] = entering;
  nonbasic_[static_cast<size_t>(column)] = leaving;
  row_of_[static_cast<size_t>(entering)] = row;
  column_of_[static_cast<size_t>(entering)] = -1;
  row_of_[static_cast<size_t>(leaving)] = -1;
  column_of_[static_cast<size_t>(leaving)] = column;
}

double LemkePath::inverseEntry(int row, int j) const
{
  const int column = column_of_[static_cast<size_t>(n_ + j)];
  if (column >= 0)
    return T_(row, column);
  return row_of_[static_cast<size_t>(n_ + j)] == row ? 1.0 : 0.0;
}

void LemkePath::breakTies(int column)
{
  for (int j = 0; j < n_ && ties_.size() > 1; ++j)
  {
    double smallest = std::numeric_limits<double>::infinity();
    double largest = 0.0;
    for (int row : ties_)
    {
      const double ratio = inverseEntry(row, j) / T_(row, column);
      smallest = std::min(smallest, ratio);
      largest = std::max(largest, std::abs(ratio));
    }
    size_t kept = 0;
    for (int row : ties_)
      if (inverseEntry(row, j) / T_(row, column) <= smallest + options_.tie_tolerance * largest)
        ties_[kept++] = row;
    ties_.resize(kept);
  }
}

int LemkePath::blockingRow(int column)
{
  const double smallest_pivot = options_.pivot_tolerance * T_.col(column).lpNorm<Eigen::Infinity>();
  double best = std::numeric_limits<double>::infinity();
  double scale = 0.0;
  for (int row = 0; row < n_; ++row)
    if (T_(row, column) > smallest_pivot)
    {
      const double ratio = std::max(b_[row], 0.0) / T_(row, column);
      best = std::min(best, ratio);
      scale = std::max(scale, ratio);
    }
  if (!std::isfinite(best))
    return -1;
  const double limit = best + options_.tie_tolerance * std::min(scale, best + b_.lpNorm<Eigen::Infinity>());
  ties_.clear();
  for (int row = 0; row < n_; ++row)
    if (T_(row, column) > smallest_pivot && std::max(b_[row], 0.0) / T_(row, column) <= limit)
    {
      if (basic_[static_cast<size_t>(row)] == 2 * n_)
        return row;  // the artificial variable may leave: done
      ties_.push_back(row);
    }
  breakTies(column);
  return ties_.front();
}

LcpStatus LemkePath::follow(int max_pivots, int& pivots)
{
  // The first pivot makes every row lexicographically positive: the smallest b_i/d_i, the last of equal ones.
  int row = 0;
  for (int i = 1; i < n_; ++i)
    if (-b_[i] / T_(i, n_) <= -b_[row] / T_(row, n_))
      row = i;
  if (b_[row] >= 0.0)
    return LcpStatus::SOLVED;
  int column = n_;
  for (pivots = 1; pivots <= max_pivots; ++pivots)
  {
    const int leaving = basic_[static_cast<size_t>(row)];
    pivot(row, column);
    if (leaving == 2 * n_)
      return LcpStatus::SOLVED;
    if (pivots % std::max(ASK_EVERY / n_ / n_, 1) == 0 && options_.interrupted && options_.interrupted())
      return LcpStatus::INTERRUPTED;
    column = column_of_[static_cast<size_t>(leaving < n_ ? leaving + n_ : leaving - n_)];
    row = blockingRow(column);
    if (row < 0)
      return LcpStatus::RAY;
  }
  pivots = max_pivots;
  return LcpStatus::MAX_PIVOTS;
}

std::vector<bool> LemkePath::basic() const
{
  std::vector<bool> result(static_cast<size_t>(n_));
  for (size_t i = 0; i < result.size(); ++i)
    result[i] = row_of_[i] >= 0;
  return result;
}
}  // namespace

const OptionTable<LcpOptions>& LcpOptions::table()
{
  static const OptionTable<LcpOptions> table(
      "lcp", {
                 {"max_pivots", &LcpOptions::max_pivots, atLeast(0), "pivots", "at most, 0 = 20 n + 100"},
                 {"pivot_tolerance", &LcpOptions::pivot_tolerance, inside(0.0, 1.0), "-",
                  "entries below this share of the column's largest never pivot"},
                 {"tie_tolerance", &LcpOptions::tie_tolerance, NumberRange{0.0, 1.0, false, true}, "-",
                  "ratios this close, relative to the largest, are equal"},
             });
  return table;
}

void LcpOptions::validate() const
{
  table().validate(*this);
  requireOption(covering.size() == 0 || covering.minCoeff() > 0.0, "lcp.covering", "a vector with an entry <= 0",
                "entries > 0");
}

void checkLcp(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options)
{
  options.validate();
  if (M.rows() != b.size() || M.cols() != b.size())
    throw std::invalid_argument("M is " + std::to_string(M.rows()) + " x " + std::to_string(M.cols()) +
                                ", expected a square matrix of " + std::to_string(b.size()) + " rows");
  if (options.covering.size() != 0 && options.covering.size() != b.size())
    throw std::invalid_argument("lcp.covering has " + std::to_string(options.covering.size()) + " entries, expected " +
                                std::to_string(b.size()));
  if (!M.allFinite() || !b.allFinite())
    throw std::invalid_argument("M or b has an entry that is not finite");
}

double lcpResidual(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const Eigen::VectorXd& x)
{
  if (b.size() == 0)
    return 0.0;
  return x.cwiseMin(M * x + b).lpNorm<Eigen::Infinity>();
}

void solveBasis(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const std::vector<bool>& basic, LcpResult& result)
{
  std::vector<Eigen::Index> index;
  for (size_t i = 0; i < basic.size(); ++i)
    if (basic[i])
      index.push_back(static_cast<Eigen::Index>(i));
  const auto size = static_cast<Eigen::Index>(index.size());
  Eigen::MatrixXd block(size, size);
  Eigen::VectorXd right(size);
  for (Eigen::Index i = 0; i < size; ++i)
  {
    right[i] = -b[index[static_cast<size_t>(i)]];
    for (Eigen::Index j = 0; j < size; ++j)
      block(i, j) = M(index[static_cast<size_t>(i)], index[static_cast<size_t>(j)]);
  }
  result.x.setZero(b.size());
  if (size > 0)
  {
    const Eigen::PartialPivLU<Eigen::MatrixXd> factor(block);
    Eigen::VectorXd solution = factor.solve(right);
    solution += factor.solve(right - block * solution);
    for (Eigen::Index i = 0; i < size; ++i)
      result.x[index[static_cast<size_t>(i)]] = solution[i];
  }
  if (!result.x.allFinite())
    result.x.setZero();
  result.y = M * result.x + b;
  if (result.status != LcpStatus::SOLVED || b.size() == 0)
    return;
  const double scale_x = std::max(result.x.lpNorm<Eigen::Infinity>(), std::numeric_limits<double>::min());
  const double scale_y = b.lpNorm<Eigen::Infinity>() + (M.cwiseAbs() * result.x.cwiseAbs()).maxCoeff();
  for (Eigen::Index i = 0; i < b.size(); ++i)
    if (!(result.x[i] >= -SIGN_TOLERANCE * scale_x) || !(result.y[i] >= -SIGN_TOLERANCE * scale_y) ||
        !(std::min(result.x[i] / scale_x, result.y[i] / scale_y) <= SIGN_TOLERANCE))
      result.status = LcpStatus::NUMERICAL_FAILURE;
}

LcpResult solveLemke(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options)
{
  return followPath<LemkePath>(M, b, options);
}

}  // namespace frictional_contact_sim
