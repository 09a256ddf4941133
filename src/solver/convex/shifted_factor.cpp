#include "frictional_contact_sim/solver/convex/shifted_factor.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

namespace frictional_contact_sim
{
namespace
{
/// One multiplication of the sparse factorization takes about as long as this many of the blocked dense one.
constexpr double SPARSE_COST = 6.0;
using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
using Columns = Eigen::SparseMatrix<double, Eigen::ColMajor>;

/// Multiplications of the sparse factorization, from the column counts along the elimination tree (Liu 1990).
double sparseFactorCost(const Columns& permuted)
{
  const auto n = static_cast<size_t>(permuted.cols());
  std::vector<int> parent(n, -1), mark(n, -1);
  std::vector<double> count(n, 1.0);
  for (int j = 0; j < static_cast<int>(n); ++j)
  {
    mark[static_cast<size_t>(j)] = j;
    for (Columns::InnerIterator it(permuted, j); it && it.index() < j; ++it)
      for (auto i = static_cast<size_t>(it.index()); mark[i] != j; i = static_cast<size_t>(parent[i]))
      {
        if (parent[i] < 0)
          parent[i] = j;
        count[i] += 1.0;
        mark[i] = j;
      }
  }
  double cost = 0.0;
  for (double c : count)
    cost += c * c;
  return cost;
}

/// Symmetric part with full blocks: a block is stored when any of its entries or of its mirror's is.
Columns symmetricBlocks(const DelassusOperator& W, const std::vector<int>& offsets)
{
  std::vector<int> block_of(static_cast<size_t>(W.rows()));
  for (int i = 0; i < W.blocks(); ++i)
    std::fill(block_of.begin() + offsets[static_cast<size_t>(i)],
              block_of.begin() + offsets[static_cast<size_t>(i) + 1], i);
  const SparseRows rows = W.toSparse();
  std::vector<Eigen::Triplet<double>> entries;
  const auto addZeros = [&](int i, int j)
  {
    for (int a = W.offset(i); a < W.offset(i + 1); ++a)
      for (int b = W.offset(j); b < W.offset(j + 1); ++b)
      {
        entries.emplace_back(a, b, 0.0);
        entries.emplace_back(b, a, 0.0);
      }
  };
  std::vector<int> last(static_cast<size_t>(W.blocks()), -1);
  for (int i = 0; i < W.blocks(); ++i)
  {
    addZeros(i, i);
    for (int row = W.offset(i); row < W.offset(i + 1); ++row)
      for (SparseRows::InnerIterator it(rows, row); it; ++it)
      {
        entries.emplace_back(row, static_cast<int>(it.col()), 0.5 * it.value());
        entries.emplace_back(static_cast<int>(it.col()), row, 0.5 * it.value());
        const int j = block_of[static_cast<size_t>(it.col())];
        if (last[static_cast<size_t>(j)] != i)
          addZeros(i, j);
        last[static_cast<size_t>(j)] = i;
      }
  }
  Columns result(W.rows(), W.rows());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}
}  // namespace

struct ShiftedFactor::Sparse
{
  struct Place
  {
    int i, j;  ///< block row and column
    int entry, stride;  ///< position of its first value, distance of its columns
  };
  Columns matrix;  ///< symmetric part of W, both triangles, full blocks
  Columns shifted;
  std::vector<Place> blocks;
  std::vector<int> diagonal;  ///< position of each diagonal entry
  Eigen::SimplicialLLT<Columns, Eigen::Lower> factor;
  bool analysed = false;

  void collectBlocks(const std::vector<int>& offsets);
};

void ShiftedFactor::Sparse::collectBlocks(const std::vector<int>& offsets)
{
  blocks.clear();
  diagonal.resize(static_cast<size_t>(matrix.cols()));
  for (int j = 0; j + 1 < static_cast<int>(offsets.size()); ++j)
  {
    const int first = offsets[static_cast<size_t>(j)];
    const int columns = offsets[static_cast<size_t>(j) + 1] - first;
    for (int k = matrix.outerIndexPtr()[first]; k < matrix.outerIndexPtr()[first + 1];)
    {
      const int row = matrix.innerIndexPtr()[k];
      const int i = static_cast<int>(std::upper_bound(offsets.begin(), offsets.end(), row) - offsets.begin()) - 1;
      const int stride = matrix.outerIndexPtr()[first + 1] - matrix.outerIndexPtr()[first];
      if (i == j)
        for (int c = 0; c < columns; ++c)
          diagonal[static_cast<size_t>(first + c)] = k + c * (stride + 1);
      blocks.push_back({i, j, k, stride});
      k += offsets[static_cast<size_t>(i) + 1] - offsets[static_cast<size_t>(i)];
    }
  }
}

ShiftedFactor::ShiftedFactor() : sparse_(std::make_unique<Sparse>())
{
}

ShiftedFactor::~ShiftedFactor() = default;

void ShiftedFactor::useDense(const DelassusOperator& W)
{
  is_dense_ = true;
  if (W.isDense())
    operator_ = W.dense();
  else
    operator_ = W.toDense();
  shifted_ = operator_.transpose();
  operator_ = 0.5 * (operator_ + shifted_);
}

void ShiftedFactor::setSparse(const DelassusOperator& W)
{
  Columns symmetric = symmetricBlocks(W, offsets_);
  Columns& matrix = sparse_->matrix;
  const bool same =
      matrix.nonZeros() == symmetric.nonZeros() && matrix.cols() == symmetric.cols() &&
      std::equal(symmetric.outerIndexPtr(), symmetric.outerIndexPtr() + symmetric.cols() + 1, matrix.outerIndexPtr()) &&
      std::equal(symmetric.innerIndexPtr(), symmetric.innerIndexPtr() + symmetric.nonZeros(), matrix.innerIndexPtr());
  matrix.swap(symmetric);
  if (same)
    return;
  sparse_->collectBlocks(offsets_);
  sparse_->factor.analyzePattern(matrix);
  Columns permuted;
  permuted = matrix.twistedBy(sparse_->factor.permutationP());
  const double rows = static_cast<double>(matrix.rows());
  sparse_->analysed = SPARSE_COST * sparseFactorCost(permuted) < rows * rows * rows / 3.0;
}

void ShiftedFactor::setOperator(const DelassusOperator& W)
{
  offsets_.resize(static_cast<size_t>(W.blocks()) + 1);
  for (int i = 0; i <= W.blocks(); ++i)
    offsets_[static_cast<size_t>(i)] = W.offset(i);
  if (!W.isDense())
    setSparse(W);
  is_dense_ = W.isDense() || !sparse_->analysed;
  if (is_dense_)
    useDense(W);
}

void ShiftedFactor::transformDense(const std::vector<SquareMatrix<3>>& bases)
{
  shifted_ = operator_;
  for (size_t i = 0; i < bases.size(); ++i)
  {
    const int d = offsets_[i + 1] - offsets_[i];
    for (Eigen::Index row = 0; row < shifted_.rows(); ++row)
    {
      Vector<3> x = Vector<3>::Zero();
      for (int k = 0; k < d; ++k)
        x[k] = shifted_(row, offsets_[i] + k);
      x = (bases[i].transpose() * x).eval();
      for (int k = 0; k < d; ++k)
        shifted_(row, offsets_[i] + k) = x[k];
    }
  }
  // Rows of a column-major matrix, column by column.
  for (Eigen::Index j = 0; j < shifted_.cols(); ++j)
    for (size_t i = 0; i < bases.size(); ++i)
    {
      double* x = &shifted_(offsets_[i], j);
      if (offsets_[i + 1] - offsets_[i] == 3)
        Eigen::Map<Vector<3>>{x} = (bases[i].transpose() * Eigen::Map<const Vector<3>>(x)).eval();
      else if (offsets_[i + 1] - offsets_[i] == 2)
        Eigen::Map<Vector<2>>{x} = (bases[i].topLeftCorner<2, 2>().transpose() * Eigen::Map<const Vector<2>>(x)).eval();
      else
        *x *= bases[i](0, 0);
    }
}

void ShiftedFactor::transformSparse(const std::vector<SquareMatrix<3>>& bases)
{
  sparse_->shifted = sparse_->matrix;
  double* values = sparse_->shifted.valuePtr();
  for (const Sparse::Place& block : sparse_->blocks)
  {
    const auto i = static_cast<size_t>(block.i);
    const auto j = static_cast<size_t>(block.j);
    const int rows = offsets_[i + 1] - offsets_[i];
    const int columns = offsets_[j + 1] - offsets_[j];
    // The columns of a block hold the same rows: they are equally far apart.
    Eigen::Map<Block, 0, Eigen::OuterStride<>> value(values + block.entry, rows, columns,
                                                     Eigen::OuterStride<>(block.stride));
    value = (bases[i].topLeftCorner(rows, rows).transpose() * value * bases[j].topLeftCorner(columns, columns)).eval();
  }
}

bool ShiftedFactor::factorShifted(const Eigen::VectorXd& shift)
{
  if (is_dense_)
  {
    shifted_.diagonal() += shift;
    dense_factor_.compute(shifted_);
    return dense_factor_.info() == Eigen::Success;
  }
  for (Eigen::Index row = 0; row < shift.size(); ++row)
    sparse_->shifted.valuePtr()[sparse_->diagonal[static_cast<size_t>(row)]] += shift[row];
  sparse_->factor.factorize(sparse_->shifted);
  return sparse_->factor.info() == Eigen::Success;
}

bool ShiftedFactor::factor(const Eigen::VectorXd& shift)
{
  bases_.clear();
  if (is_dense_)
    shifted_ = operator_;
  else
    sparse_->shifted = sparse_->matrix;
  return factorShifted(shift);
}

bool ShiftedFactor::factor(const std::vector<SquareMatrix<3>>& bases, const Eigen::VectorXd& shift)
{
  bases_ = bases;
  if (is_dense_)
    transformDense(bases);
  else
    transformSparse(bases);
  return factorShifted(shift);
}

void ShiftedFactor::toBasis(Eigen::VectorXd& x, bool transposed) const
{
  for (size_t i = 0; i < bases_.size(); ++i)
  {
    const int d = offsets_[i + 1] - offsets_[i];
    Vector<3> value = Vector<3>::Zero();
    for (int k = 0; k < d; ++k)
      value[k] = x[offsets_[i] + k];
    value = transposed ? (bases_[i].transpose() * value).eval() : (bases_[i] * value).eval();
    for (int k = 0; k < d; ++k)
      x[offsets_[i] + k] = value[k];
  }
}

void ShiftedFactor::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x)
{
  if (&x != &b)
    x = b;
  toBasis(x, true);
  if (is_dense_)
    dense_factor_.solveInPlace(x);
  else
    x = sparse_->factor.solve(x).eval();
  toBasis(x, false);
}

}  // namespace frictional_contact_sim
