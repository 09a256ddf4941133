#include "frictional_contact_sim/problem/delassus_reduction.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/problem/residual.h"

namespace frictional_contact_sim
{
namespace
{
/// Rows of A whose remainder is below this share of the largest are linear combinations of the others.
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

/** Sum of z_i z_j^T over the velocities both laws touch; `same`: they touch the same ones. */
template <int DI, int DJ>
void sumProducts(const int* pattern_i, const int* end_i, const double* z_i, const int* pattern_j, const int* end_j,
                 const double* z_j, bool same, double (&sum)[DI][DJ])
{
  while (pattern_i != end_i && pattern_j != end_j)
  {
    const bool step_i = same || *pattern_i <= *pattern_j;
    const bool step_j = same || *pattern_j <= *pattern_i;
    if (step_i && step_j)
      for (int a = 0; a < DI; ++a)
        for (int b = 0; b < DJ; ++b)
          sum[a][b] += z_i[a] * z_j[b];
    pattern_i += step_i ? 1 : 0;
    z_i += step_i ? DI : 0;
    pattern_j += step_j ? 1 : 0;
    z_j += step_j ? DJ : 0;
  }
}

/** W_ij of two laws, written to both places of W. */
template <int DI, int DJ>
void multiplyRows(const int* pattern_i, const int* end_i, const double* z_i, const int* pattern_j, const int* end_j,
                  const double* z_j, bool same, double* lower, double* upper, int row_stride)
{
  double sum[DI][DJ] = {};
  if (same)
    sumProducts<DI, DJ>(pattern_i, end_i, z_i, pattern_j, end_j, z_j, true, sum);
  else
    sumProducts<DI, DJ>(pattern_i, end_i, z_i, pattern_j, end_j, z_j, false, sum);
  // Dense storage has rows a stride apart; a sparse block is column-major with its own number of rows.
  const bool dense = row_stride != 0;
  for (int a = 0; a < DI; ++a)
    for (int b = 0; b < DJ; ++b)
    {
      lower[dense ? a * row_stride + b : a + b * DI] = sum[a][b];
      upper[dense ? b * row_stride + a : b + a * DJ] = sum[a][b];
    }
}

using MultiplyRows = void (*)(const int*, const int*, const double*, const int*, const int*, const double*, bool,
                              double*, double*, int);
constexpr MultiplyRows MULTIPLY[3][3] = {{multiplyRows<1, 1>, multiplyRows<1, 2>, multiplyRows<1, 3>},
                                         {multiplyRows<2, 1>, multiplyRows<2, 2>, multiplyRows<2, 3>},
                                         {multiplyRows<3, 1>, multiplyRows<3, 2>, multiplyRows<3, 3>}};
}  // namespace

void DelassusReduction::findFresh(const IncrementalProblem& problem)
{
  const double* const values = problem.H.valuePtr();
  const int* const columns = problem.H.innerIndexPtr();
  for (size_t i = 0; i < types_.size() && loop_of_.empty() && !h_values_.empty(); ++i)
  {
    const auto begin = static_cast<std::ptrdiff_t>(h_outer_[static_cast<size_t>(block_offset_[i])]);
    const auto end = static_cast<std::ptrdiff_t>(h_outer_[static_cast<size_t>(block_offset_[i + 1])]);
    is_fresh_[i] = !std::equal(values + begin, values + end, h_values_.begin() + begin) ||
                   std::any_of(columns + begin, columns + end,
                               [this](int column) { return factor_.hasChanged(factor_.permuted(column)); });
  }
  h_values_.assign(values, values + problem.H.nonZeros());
}

void DelassusReduction::computeHalfRows(const IncrementalProblem& problem)
{
  findFresh(problem);
  for (size_t i = 0; i < types_.size(); ++i)
  {
    if (is_fresh_[i] == 0)
      continue;
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

void DelassusReduction::multiplyHalfRows(const Eigen::VectorXd& x, Eigen::VectorXd& rows) const
{
  rows.resize(block_offset_.back());
  for (size_t i = 0; i < types_.size(); ++i)
  {
    const int dimension = block_offset_[i + 1] - block_offset_[i];
    const double* z = half_rows_.data() + value_begin_[i];
    double sum[3] = {0.0, 0.0, 0.0};
    for (int p = pattern_begin_[i]; p < pattern_begin_[i + 1]; ++p)
      for (int k = 0; k < dimension; ++k)
        sum[k] += *z++ * x[pattern_[static_cast<size_t>(p)]];
    std::copy(sum, sum + dimension, rows.data() + block_offset_[i]);
  }
}

void DelassusReduction::multiplyPairs()
{
  const int stride = local_.W.isDense() ? local_.W.rows() : 0;
  for (const Pair& pair : pairs_)
  {
    const auto i = static_cast<size_t>(pair.i);
    const auto j = static_cast<size_t>(pair.j);
    if (is_fresh_[i] == 0 && is_fresh_[j] == 0)
      continue;
    MULTIPLY[block_offset_[i + 1] - block_offset_[i] - 1][block_offset_[j + 1] - block_offset_[j] - 1](
        pattern_.data() + pattern_begin_[i], pattern_.data() + pattern_begin_[i + 1],
        half_rows_.data() + value_begin_[i], pattern_.data() + pattern_begin_[j],
        pattern_.data() + pattern_begin_[j + 1], half_rows_.data() + value_begin_[j], pair.same, pair.lower, pair.upper,
        stride);
  }
}

void DelassusReduction::compute(const IncrementalProblem& problem, OperatorKind kind)
{
  local_.laws = problem.laws;
  local_.scales = problem.scales;
  const bool new_tree = factor_.compute(problem.M);
  if (new_tree || kind != kind_ || !samePattern(problem))
  {
    kind_ = kind;
    analyse(problem);
  }
  computeHalfRows(problem);
  factor_.halfSolve(problem.f, half_force_);
  multiplyHalfRows(half_force_, local_.q);
  local_.q = problem.w - local_.q;
  base_ = -half_force_;
  rank_ = 0;
  if (!loop_of_.empty())
  {
    free_velocity_ = local_.q;
    factor_.transposedHalfSolve(half_force_, mass_inverse_force_);
    unconstrained_.assignHalf(problem.laws, pattern_begin_, pattern_, half_rows_, problem.velocities());
    computeStepLengths(unconstrained_, step_lengths_);
    factorLoops(problem);
    multiplyHalfRows(base_, local_.q);
    local_.q += problem.w;
    projectHalfRows();
  }
  if (kind_ == OperatorKind::MATRIX_FREE)
    local_.W.assignHalf(problem.laws, pattern_begin_, pattern_, half_rows_, problem.velocities());
  else
    multiplyPairs();
  if (loop_of_.empty())
    computeStepLengths(local_, step_lengths_);
}

void DelassusReduction::factorLoops(const IncrementalProblem& problem)
{
  for (Loop& loop : loops_)
  {
    const int columns = static_cast<int>(loop.velocities.size());
    OrthogonalRows::Matrix& A = loop.factor.matrix();
    for (size_t k = 0; k < loop.rows.size(); ++k)
    {
      halfRows<1>(problem.G, loop.rows[k], factor_, loop.velocities.data(), columns, work_.data(),
                  A.row(static_cast<Eigen::Index>(k)).data());
      loop.b[static_cast<Eigen::Index>(k)] = -problem.b[loop.rows[k]];
    }
    loop.factor.compute(RANK_TOLERANCE);
    rank_ += loop.factor.rank();
    loop.factor.coordinates(loop.b, loop.particular);
    // x at r = 0: - N g + Q y = - g + Q (y + Q^T g)
    for (int k = 0; k < columns; ++k)
      loop.part[k] = half_force_[loop.velocities[static_cast<size_t>(k)]];
    loop.coordinates.noalias() = loop.factor.basis() * loop.part;
    loop.coordinates += loop.particular;
    loop.part.noalias() = loop.factor.basis().transpose() * loop.coordinates;
    for (int k = 0; k < columns; ++k)
      base_[loop.velocities[static_cast<size_t>(k)]] += loop.part[k];
  }
}

void DelassusReduction::projectHalfRows()
{
  for (size_t i = 0; i < types_.size(); ++i)
    for (int l = law_loop_begin_[i]; l < law_loop_begin_[i + 1]; ++l)
    {
      const int index = law_loops_[static_cast<size_t>(l)];
      const Loop& loop = loops_[static_cast<size_t>(index)];
      const int dimension = block_offset_[i + 1] - block_offset_[i];
      const auto forEachColumn = [&](auto visit)
      {
        // A law that touches a loop has all its velocities, in the same ascending order.
        int column = 0;
        for (int p = pattern_begin_[i]; p < pattern_begin_[i + 1]; ++p)
          if (loop_of_[static_cast<size_t>(pattern_[static_cast<size_t>(p)])] == index)
            visit(column++, half_rows_.data() + value_begin_[i] + dimension * (p - pattern_begin_[i]));
      };
      auto gathered = gathered_.topLeftCorner(loop.part.size(), dimension);
      auto coupling = coupling_.topLeftCorner(loop.factor.rank(), dimension);
      forEachColumn(
          [&](int column, const double* z)
          {
            for (int k = 0; k < dimension; ++k)
              gathered(column, k) = z[k];
          });
      coupling.noalias() = loop.factor.basis().lazyProduct(gathered);
      gathered.noalias() -= loop.factor.basis().transpose().lazyProduct(coupling);
      forEachColumn(
          [&](int column, double* z)
          {
            for (int k = 0; k < dimension; ++k)
              z[k] = gathered(column, k);
          });
    }
}

void DelassusReduction::recover(const IncrementalProblem& problem, Solution& solution)
{
  x_ = base_;
  for (size_t i = 0; i < types_.size(); ++i)
  {
    const int dimension = block_offset_[i + 1] - block_offset_[i];
    const double* z = half_rows_.data() + value_begin_[i];
    for (int p = pattern_begin_[i]; p < pattern_begin_[i + 1]; ++p)
      for (int k = 0; k < dimension; ++k)
        x_[pattern_[static_cast<size_t>(p)]] += *z++ * solution.r[block_offset_[i] + k];
  }
  factor_.transposedHalfSolve(x_, solution.v);
  solution.u.resize(problem.rows());
  solution.u.noalias() = problem.H * solution.v;
  solution.u += problem.w;
  recoverMultipliers(problem, solution);
}

void DelassusReduction::recoverMultipliers(const IncrementalProblem& problem, Solution& solution)
{
  solution.lambda.setZero(problem.bilaterals());
  if (loop_of_.empty())
    return;
  // g - Z^T r with the Z before projection
  momentum_.noalias() = problem.H.transpose() * solution.r;
  momentum_ = problem.f - momentum_;
  factor_.halfSolve(momentum_, x_);
  for (Loop& loop : loops_)
  {
    for (size_t k = 0; k < loop.velocities.size(); ++k)
      loop.part[static_cast<Eigen::Index>(k)] = x_[loop.velocities[k]];
    loop.coordinates.noalias() = loop.factor.basis() * loop.part;
    loop.coordinates += loop.particular;
    loop.factor.leastNorm(loop.coordinates, loop.b);
    for (size_t k = 0; k < loop.rows.size(); ++k)
      solution.lambda[loop.rows[k]] = loop.b[static_cast<Eigen::Index>(k)];
  }
}

DelassusProblem reduce(const IncrementalProblem& problem)
{
  DelassusReduction reduction;
  reduction.compute(problem);
  return reduction.problem();
}

}  // namespace frictional_contact_sim
