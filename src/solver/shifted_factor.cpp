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
using Lower = Eigen::SparseMatrix<double, Eigen::ColMajor>;

/// Multiplications of the sparse factorization, from the column counts of the elimination tree (Liu 1990).
double sparseFactorCost(const Lower& permuted)
{
  const int n = static_cast<int>(permuted.cols());
  std::vector<int> parent(static_cast<std::size_t>(n), -1), mark(static_cast<std::size_t>(n), -1);
  std::vector<double> count(static_cast<std::size_t>(n), 1.0);
  // Rows of the upper triangle are needed; the matrix holds both triangles.
  for (int j = 0; j < n; ++j)
  {
    mark[static_cast<std::size_t>(j)] = j;
    for (Lower::InnerIterator it(permuted, j); it && it.index() < j; ++it)
      for (int i = static_cast<int>(it.index()); mark[static_cast<std::size_t>(i)] != j;
           i = parent[static_cast<std::size_t>(i)])
      {
        if (parent[static_cast<std::size_t>(i)] < 0)
          parent[static_cast<std::size_t>(i)] = j;
        count[static_cast<std::size_t>(i)] += 1.0;
        mark[static_cast<std::size_t>(i)] = j;
      }
  }
  double cost = 0.0;
  for (double c : count)
    cost += c * c;
  return cost;
}
}  // namespace

struct ShiftedFactor::Sparse
{
  Lower matrix;  ///< symmetric part of W, both triangles, every diagonal block full
  Lower shifted;
  std::vector<int> block_entries;  ///< positions of the diagonal blocks' values, row-major, block after block
  Eigen::SimplicialLLT<Lower, Eigen::Lower> factor;
  bool analysed = false;
};

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
  operator_ = (0.5 * (operator_ + operator_.transpose())).eval();
}

void ShiftedFactor::setOperator(const DelassusOperator& W)
{
  offsets_.resize(static_cast<std::size_t>(W.blocks()) + 1);
  for (int i = 0; i <= W.blocks(); ++i)
    offsets_[static_cast<std::size_t>(i)] = W.offset(i);
  if (W.isDense())
  {
    useDense(W);
    return;
  }
  Lower full = W.toSparse();
  // Explicit zeros keep every diagonal block in the pattern.
  std::vector<Eigen::Triplet<double>> zeros;
  for (int i = 0; i < W.blocks(); ++i)
    for (int a = W.offset(i); a < W.offset(i + 1); ++a)
      for (int b = W.offset(i); b < W.offset(i + 1); ++b)
        zeros.emplace_back(a, b, 0.0);
  Lower diagonal(full.rows(), full.cols());
  diagonal.setFromTriplets(zeros.begin(), zeros.end());
  Lower symmetric = 0.5 * (full + Lower(full.transpose())) + diagonal;
  symmetric.makeCompressed();
  const bool same = sparse_->analysed && sparse_->matrix.nonZeros() == symmetric.nonZeros() &&
                    sparse_->matrix.cols() == symmetric.cols() &&
                    std::equal(symmetric.outerIndexPtr(), symmetric.outerIndexPtr() + symmetric.cols() + 1,
                               sparse_->matrix.outerIndexPtr()) &&
                    std::equal(symmetric.innerIndexPtr(), symmetric.innerIndexPtr() + symmetric.nonZeros(),
                               sparse_->matrix.innerIndexPtr());
  sparse_->matrix = symmetric;
  is_dense_ = false;
  if (!same)
  {
    sparse_->analysed = true;
    sparse_->factor.analyzePattern(symmetric);
    sparse_->block_entries.clear();
    for (int i = 0; i < W.blocks(); ++i)
      for (int a = W.offset(i); a < W.offset(i + 1); ++a)
        for (int b = W.offset(i); b < W.offset(i + 1); ++b)
        {
          const int* begin = symmetric.innerIndexPtr() + symmetric.outerIndexPtr()[a];
          const int* end = symmetric.innerIndexPtr() + symmetric.outerIndexPtr()[a + 1];
          sparse_->block_entries.push_back(
              static_cast<int>(std::lower_bound(begin, end, b) - symmetric.innerIndexPtr()));
        }
    Lower permuted;
    permuted = symmetric.twistedBy(sparse_->factor.permutationP());
    const double rows = static_cast<double>(symmetric.rows());
    sparse_->analysed = SPARSE_COST * sparseFactorCost(permuted) < rows * rows * rows / 3.0;
  }
  if (!sparse_->analysed)
    useDense(W);
}

void ShiftedFactor::addBlocks(const std::vector<double>& blocks)
{
  if (!is_dense_)
  {
    sparse_->shifted = sparse_->matrix;
    std::size_t entry = 0;
    for (std::size_t i = 0; i + 1 < offsets_.size(); ++i)
    {
      const int d = offsets_[i + 1] - offsets_[i];
      for (int k = 0; k < d * d; ++k, ++entry)
        sparse_->shifted.valuePtr()[sparse_->block_entries[entry]] +=
            blocks[BLOCK_STRIDE * i + static_cast<std::size_t>(k)];
    }
    return;
  }
  shifted_ = operator_;
  for (std::size_t i = 0; i + 1 < offsets_.size(); ++i)
  {
    const int d = offsets_[i + 1] - offsets_[i];
    for (int a = 0; a < d; ++a)
      for (int b = 0; b < d; ++b)
        shifted_(offsets_[i] + a, offsets_[i] + b) += blocks[BLOCK_STRIDE * i + static_cast<std::size_t>(d * a + b)];
  }
}

bool ShiftedFactor::factor(const std::vector<double>& blocks)
{
  addBlocks(blocks);
  if (is_dense_)
  {
    dense_factor_.compute(shifted_);
    return dense_factor_.info() == Eigen::Success;
  }
  sparse_->factor.factorize(sparse_->shifted);
  return sparse_->factor.info() == Eigen::Success;
}

void ShiftedFactor::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x)
{
  if (!is_dense_)
  {
    x = sparse_->factor.solve(b);
    return;
  }
  if (&x != &b)
    x = b;
  dense_factor_.solveInPlace(x);
}

}  // namespace frictional_contact_sim
