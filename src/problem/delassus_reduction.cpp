#include "frictional_contact_sim/problem/delassus_reduction.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/problem/residual.h"

namespace frictional_contact_sim
{
namespace
{
/// Columns of A^T whose remainder is below this share of the largest pivot are linear combinations of the others.
constexpr double RANK_TOLERANCE = 1e-11;

/** Z_i = H_i C^-T for one law: forward substitution on the touched velocities only, D right-hand sides together. */
template <int D>
void halfRows(const SparseRows& H, int first_row, const MassFactor& factor, const int* pattern, int count, double* work,
              double* result)
{
  for (int k = 0; k < D; ++k)
    for (int p = H.outerIndexPtr()[first_row + k]; p < H.outerIndexPtr()[first_row + k + 1]; ++p)
      work[D * factor.permuted(H.innerIndexPtr()[p]) + k] += H.valuePtr()[p];
  const int* begin = factor.columnBegin().data();
  const int* rows = factor.rowIndices().data();
  const double* values = factor.values().data();
  const double* scale = factor.inverseRootPivots().data();
  for (int entry = 0; entry < count; ++entry, result += D)
  {
    const int column = pattern[entry];
    double x[D];
    for (int k = 0; k < D; ++k)
    {
      x[k] = work[D * column + k];
      work[D * column + k] = 0.0;
      result[k] = x[k] * scale[column];
    }
    for (int p = begin[column]; p < begin[column + 1]; ++p)
      for (int k = 0; k < D; ++k)
        work[D * rows[p] + k] -= values[p] * x[k];
  }
}

/** Sum over the velocities both laws touch of z_i z_j^T, written to both places of W. */
template <int DI, int DJ>
void multiplyRows(const int* pattern_i, const int* end_i, const double* z_i, const int* pattern_j, const int* end_j,
                  const double* z_j, double* lower, double* upper, int row_stride, int column_stride)
{
  double sum[DI][DJ] = {};
  while (pattern_i != end_i && pattern_j != end_j)
  {
    if (*pattern_i == *pattern_j)
    {
      for (int a = 0; a < DI; ++a)
        for (int b = 0; b < DJ; ++b)
          sum[a][b] += z_i[a] * z_j[b];
      ++pattern_i;
      z_i += DI;
      ++pattern_j;
      z_j += DJ;
    }
    else if (*pattern_i < *pattern_j)
    {
      ++pattern_i;
      z_i += DI;
    }
    else
    {
      ++pattern_j;
      z_j += DJ;
    }
  }
  // Dense storage has rows a stride apart; a sparse block is column-major with its own number of rows.
  const bool dense = row_stride != 0;
  for (int a = 0; a < DI; ++a)
    for (int b = 0; b < DJ; ++b)
    {
      lower[dense ? a * row_stride + b * column_stride : a + b * DI] = sum[a][b];
      upper[dense ? b * row_stride + a * column_stride : b + a * DJ] = sum[a][b];
    }
}

using MultiplyRows = void (*)(const int*, const int*, const double*, const int*, const int*, const double*, double*,
                              double*, int, int);
constexpr MultiplyRows MULTIPLY[3][3] = {{multiplyRows<1, 1>, multiplyRows<1, 2>, multiplyRows<1, 3>},
                                         {multiplyRows<2, 1>, multiplyRows<2, 2>, multiplyRows<2, 3>},
                                         {multiplyRows<3, 1>, multiplyRows<3, 2>, multiplyRows<3, 3>}};
}  // namespace

bool DelassusReduction::samePattern(const IncrementalProblem& problem) const
{
  const SparseRows& H = problem.H;
  if (bilateral_ != (problem.bilaterals() > 0) || types_.size() != problem.laws.size() ||
      h_outer_.size() != static_cast<std::size_t>(H.rows()) + 1 ||
      h_inner_.size() != static_cast<std::size_t>(H.nonZeros()))
    return false;
  for (std::size_t i = 0; i < types_.size(); ++i)
    if (types_[i] != problem.laws[i].type)
      return false;
  return std::equal(h_outer_.begin(), h_outer_.end(), H.outerIndexPtr()) &&
         std::equal(h_inner_.begin(), h_inner_.end(), H.innerIndexPtr());
}

void DelassusReduction::collectPattern(const SparseRows& matrix, int first_row, int last_row, int mark)
{
  const std::size_t begin = pattern_.size();
  for (int p = matrix.outerIndexPtr()[first_row]; p < matrix.outerIndexPtr()[last_row]; ++p)
    for (int k = factor_.permuted(matrix.innerIndexPtr()[p]); k >= 0 && flags_[static_cast<std::size_t>(k)] != mark;
         k = factor_.parent()[static_cast<std::size_t>(k)])
    {
      flags_[static_cast<std::size_t>(k)] = mark;
      pattern_.push_back(k);
    }
  std::sort(pattern_.begin() + static_cast<std::ptrdiff_t>(begin), pattern_.end());
}

void DelassusReduction::analyse(const IncrementalProblem& problem)
{
  const SparseRows& H = problem.H;
  const std::size_t count = problem.laws.size();
  bilateral_ = problem.bilaterals() > 0;
  h_outer_.assign(H.outerIndexPtr(), H.outerIndexPtr() + H.rows() + 1);
  h_inner_.assign(H.innerIndexPtr(), H.innerIndexPtr() + H.nonZeros());
  types_.resize(count);
  block_offset_.assign(count + 1, 0);
  pattern_begin_.assign(count + 1, 0);
  value_begin_.assign(count + 1, 0);
  pattern_.clear();
  flags_.assign(static_cast<std::size_t>(problem.velocities()), -1);
  work_.assign(3 * static_cast<std::size_t>(problem.velocities()), 0.0);
  for (std::size_t i = 0; i < count; ++i)
  {
    const int dimension = problem.laws[i].dimension();
    types_[i] = problem.laws[i].type;
    block_offset_[i + 1] = block_offset_[i] + dimension;
    collectPattern(H, block_offset_[i], block_offset_[i + 1], static_cast<int>(i));
    pattern_begin_[i + 1] = static_cast<int>(pattern_.size());
    value_begin_[i + 1] = value_begin_[i] + dimension * (pattern_begin_[i + 1] - pattern_begin_[i]);
  }
  half_rows_.resize(static_cast<std::size_t>(value_begin_[count]));
  preparePairs();
}

void DelassusReduction::preparePairs()
{
  const int count = static_cast<int>(types_.size());
  const int rows = block_offset_.back();
  pairs_.clear();
  if (bilateral_)
  {
    // The projector couples everything its loops touch: dense.
    local_.W.resizeDense(local_.laws);
    return;
  }
  std::vector<std::vector<int>> touching(flags_.size());
  for (int i = 0; i < count; ++i)
    for (int p = pattern_begin_[static_cast<std::size_t>(i)]; p < pattern_begin_[static_cast<std::size_t>(i) + 1]; ++p)
      touching[static_cast<std::size_t>(pattern_[static_cast<std::size_t>(p)])].push_back(i);
  std::vector<std::vector<int>> columns(static_cast<std::size_t>(count));
  std::vector<int> mark(static_cast<std::size_t>(count), -1);
  double entries = 0.0;
  for (int i = 0; i < count; ++i)
  {
    std::vector<int>& row = columns[static_cast<std::size_t>(i)];
    row.push_back(i);
    mark[static_cast<std::size_t>(i)] = i;
    for (int p = pattern_begin_[static_cast<std::size_t>(i)]; p < pattern_begin_[static_cast<std::size_t>(i) + 1]; ++p)
      for (const int j : touching[static_cast<std::size_t>(pattern_[static_cast<std::size_t>(p)])])
        if (mark[static_cast<std::size_t>(j)] != i)
        {
          mark[static_cast<std::size_t>(j)] = i;
          row.push_back(j);
        }
    std::sort(row.begin(), row.end());
    for (const int j : row)
      entries +=
          local_.laws[static_cast<std::size_t>(i)].dimension() * local_.laws[static_cast<std::size_t>(j)].dimension();
  }
  DelassusOperator& W = local_.W;
  const bool dense = rows <= DelassusOperator::DENSE_ROWS ||
                     entries >= DelassusOperator::DENSE_SHARE * rows * static_cast<double>(rows);
  if (dense)
  {
    W.resizeDense(local_.laws);
    W.dense().setZero();
  }
  else
    W.resizeSparse(local_.laws, columns);
  for (int i = 0; i < count; ++i)
    for (const int j : columns[static_cast<std::size_t>(i)])
      if (j <= i)
      {
        if (dense)
          pairs_.push_back({i, j, &W.dense()(W.offset(i), W.offset(j)), &W.dense()(W.offset(j), W.offset(i))});
        else
          pairs_.push_back({i, j, W.block(i, j), W.block(j, i)});
      }
}

void DelassusReduction::computeHalfRows(const IncrementalProblem& problem)
{
  for (std::size_t i = 0; i < types_.size(); ++i)
  {
    const int* pattern = pattern_.data() + pattern_begin_[i];
    const int count = pattern_begin_[i + 1] - pattern_begin_[i];
    double* result = half_rows_.data() + value_begin_[i];
    const int dimension = block_offset_[i + 1] - block_offset_[i];
    if (dimension == 3)
      halfRows<3>(problem.H, block_offset_[i], factor_, pattern, count, work_.data(), result);
    else if (dimension == 2)
      halfRows<2>(problem.H, block_offset_[i], factor_, pattern, count, work_.data(), result);
    else
      halfRows<1>(problem.H, block_offset_[i], factor_, pattern, count, work_.data(), result);
  }
}

void DelassusReduction::multiplyPairs()
{
  const int stride = local_.W.isDense() ? local_.W.rows() : 0;
  for (const Pair& pair : pairs_)
  {
    const auto i = static_cast<std::size_t>(pair.i);
    const auto j = static_cast<std::size_t>(pair.j);
    MULTIPLY[block_offset_[i + 1] - block_offset_[i] - 1][block_offset_[j + 1] - block_offset_[j] - 1](
        pattern_.data() + pattern_begin_[i], pattern_.data() + pattern_begin_[i + 1],
        half_rows_.data() + value_begin_[i], pattern_.data() + pattern_begin_[j],
        pattern_.data() + pattern_begin_[j + 1], half_rows_.data() + value_begin_[j], pair.lower, pair.upper, stride,
        1);
  }
}

void DelassusReduction::compute(const IncrementalProblem& problem)
{
  local_.laws = problem.laws;
  const bool new_tree = factor_.compute(problem.M);
  if (new_tree || !samePattern(problem))
    analyse(problem);
  computeHalfRows(problem);
  factor_.halfSolve(problem.f, half_force_);
  base_ = -half_force_;
  if (bilateral_)
    factor_.transposedHalfSolve(half_force_, mass_inverse_force_);
  x_.resize(problem.velocities());
  local_.q = problem.w;
  for (std::size_t i = 0; i < types_.size(); ++i)
  {
    const int dimension = block_offset_[i + 1] - block_offset_[i];
    const double* z = half_rows_.data() + value_begin_[i];
    for (int p = pattern_begin_[i]; p < pattern_begin_[i + 1]; ++p)
      for (int k = 0; k < dimension; ++k)
        local_.q[block_offset_[i] + k] -= *z++ * half_force_[pattern_[static_cast<std::size_t>(p)]];
  }
  free_velocity_ = local_.q.size() == 0 ? 0.0 : local_.q.lpNorm<Eigen::Infinity>();
  rank_ = 0;
  if (bilateral_)
    eliminateBilaterals(problem);
  else
  {
    multiplyPairs();
    computeStepLengths(local_, step_lengths_);
  }
}

void DelassusReduction::eliminateBilaterals(const IncrementalProblem& problem)
{
  const int velocities = problem.velocities();
  const int bilaterals = problem.bilaterals();
  const int rows = problem.rows();
  dense_rows_.setZero(rows, velocities);
  for (std::size_t i = 0; i < types_.size(); ++i)
  {
    const double* z = half_rows_.data() + value_begin_[i];
    for (int p = pattern_begin_[i]; p < pattern_begin_[i + 1]; ++p)
      for (int row = block_offset_[i]; row < block_offset_[i + 1]; ++row)
        dense_rows_(row, pattern_[static_cast<std::size_t>(p)]) = *z++;
  }
  // The residual is measured with the unconstrained W_ii; form those blocks before projecting.
  local_.W.dense().setZero();
  for (std::size_t i = 0; i < types_.size(); ++i)
  {
    const int first = block_offset_[i], dimension = block_offset_[i + 1] - first;
    local_.W.dense().block(first, first, dimension, dimension) =
        dense_rows_.middleRows(first, dimension).lazyProduct(dense_rows_.middleRows(first, dimension).transpose());
  }
  computeStepLengths(local_, step_lengths_);

  bilateral_rows_.resize(velocities, bilaterals);
  for (int k = 0; k < bilaterals; ++k)
  {
    x_.setZero();
    for (SparseRows::InnerIterator entry(problem.G, k); entry; ++entry)
      x_[entry.col()] += entry.value();
    factor_.halfSolve(x_, particular_);
    bilateral_rows_.col(k) = particular_;
  }
  qr_.setThreshold(RANK_TOLERANCE);
  qr_.compute(bilateral_rows_);
  rank_ = static_cast<int>(qr_.rank());
  basis_.setIdentity(velocities, rank_);
  basis_.applyOnTheLeft(qr_.householderQ());

  // y: R_1^T y = -(E b)_1 on the independent rows.
  particular_.resize(rank_);
  for (int k = 0; k < rank_; ++k)
    particular_[k] = -problem.b[qr_.colsPermutation().indices()[k]];
  const auto R = qr_.matrixR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>();
  R.transpose().solveInPlace(particular_);
  gram_.resize(rank_, rank_);
  const auto trapezoid = qr_.matrixR().topRows(rank_);
  for (int i = 0; i < rank_; ++i)
    for (int j = 0; j <= i; ++j)
      gram_(i, j) = gram_(j, i) = trapezoid.row(i).tail(bilaterals - i).dot(trapezoid.row(j).tail(bilaterals - i));

  coefficients_.noalias() = basis_.transpose() * half_force_;
  coefficients_ += particular_;
  base_.noalias() = basis_ * coefficients_;
  base_ -= half_force_;
  local_.q.noalias() = dense_rows_ * base_;
  local_.q += problem.w;
  coupling_.noalias() = dense_rows_ * basis_;
  dense_rows_.noalias() -= coupling_ * basis_.transpose();
  local_.W.dense().noalias() = dense_rows_ * dense_rows_.transpose();
}

void DelassusReduction::recover(const IncrementalProblem& problem, Solution& solution)
{
  x_ = base_;
  if (bilateral_)
    x_.noalias() += dense_rows_.transpose() * solution.r;
  else
    for (std::size_t i = 0; i < types_.size(); ++i)
    {
      const int dimension = block_offset_[i + 1] - block_offset_[i];
      const double* z = half_rows_.data() + value_begin_[i];
      for (int p = pattern_begin_[i]; p < pattern_begin_[i + 1]; ++p)
        for (int k = 0; k < dimension; ++k)
          x_[pattern_[static_cast<std::size_t>(p)]] += *z++ * solution.r[block_offset_[i] + k];
    }
  factor_.transposedHalfSolve(x_, solution.v);
  solution.u.resize(problem.rows());
  solution.u.noalias() = problem.H * solution.v;
  solution.u += problem.w;
  solution.lambda.setZero(problem.bilaterals());
  if (!bilateral_ || rank_ == 0)
    return;
  // The unprojected Z^T r: half_rows_ still hold Z.
  x_ = half_force_;
  for (std::size_t i = 0; i < types_.size(); ++i)
  {
    const int dimension = block_offset_[i + 1] - block_offset_[i];
    const double* z = half_rows_.data() + value_begin_[i];
    for (int p = pattern_begin_[i]; p < pattern_begin_[i + 1]; ++p)
      for (int k = 0; k < dimension; ++k)
        x_[pattern_[static_cast<std::size_t>(p)]] -= *z++ * solution.r[block_offset_[i] + k];
  }
  coefficients_.noalias() = basis_.transpose() * x_;
  coefficients_ += particular_;
  const int bilaterals = problem.bilaterals();
  if (rank_ == bilaterals)
  {
    qr_.matrixR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>().solveInPlace(coefficients_);
    for (int k = 0; k < rank_; ++k)
      solution.lambda[qr_.colsPermutation().indices()[k]] = coefficients_[k];
    return;
  }
  const Eigen::VectorXd dual = gram_.llt().solve(coefficients_);
  for (int column = 0; column < bilaterals; ++column)
  {
    const int count = std::min(column + 1, rank_);
    solution.lambda[qr_.colsPermutation().indices()[column]] =
        qr_.matrixR().col(column).head(count).dot(dual.head(count));
  }
}

DelassusProblem reduce(const IncrementalProblem& problem)
{
  DelassusReduction reduction;
  reduction.compute(problem);
  return reduction.problem();
}

}  // namespace frictional_contact_sim
