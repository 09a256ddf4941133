#include "frictional_contact_sim/problem/delassus_operator.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "frictional_contact_sim/math/dense_kernels.h"

namespace frictional_contact_sim
{
namespace
{
constexpr OperatorKind KINDS[] = {OperatorKind::AUTOMATIC, OperatorKind::DENSE, OperatorKind::SPARSE,
                                  OperatorKind::MATRIX_FREE};
}

const char* toString(OperatorKind kind)
{
  switch (kind)
  {
    case OperatorKind::AUTOMATIC:
      return "automatic";
    case OperatorKind::DENSE:
      return "dense";
    case OperatorKind::SPARSE:
      return "sparse";
    case OperatorKind::MATRIX_FREE:
      return "matrix_free";
  }
  return "unknown";
}

OperatorKind operatorKind(const std::string& name)
{
  std::string valid;
  for (const OperatorKind kind : KINDS)
  {
    if (name == toString(kind))
      return kind;
    valid += valid.empty() ? "" : ", ";
    valid += toString(kind);
  }
  throw std::invalid_argument("unknown operator '" + name + "', expected one of: " + valid);
}

const char* toString(OperatorUse use)
{
  switch (use)
  {
    case OperatorUse::PRODUCTS:
      return "products";
    case OperatorUse::BLOCK_ROWS:
      return "block rows";
    case OperatorUse::DENSE:
      return "dense";
  }
  return "unknown";
}

void DelassusOperator::throwMatrixFree()
{
  throw std::logic_error("a matrix-free W has no entries, only products");
}

void DelassusOperator::setBlocks(const std::vector<Law>& laws)
{
  offsets_.resize(laws.size() + 1);
  offsets_[0] = 0;
  for (size_t i = 0; i < laws.size(); ++i)
    offsets_[i + 1] = offsets_[i] + laws[i].dimension();
  block_of_row_.resize(static_cast<size_t>(rows()));
  for (int i = 0; i < blocks(); ++i)
    std::fill(block_of_row_.begin() + offset(i), block_of_row_.begin() + offset(i + 1), i);
}

void DelassusOperator::resizeDense(const std::vector<Law>& laws)
{
  is_dense_ = true;
  is_matrix_free_ = false;
  setBlocks(laws);
  dense_.resize(rows(), rows());
}

void DelassusOperator::resizeSparse(const std::vector<Law>& laws, const std::vector<int>& begin,
                                    const std::vector<int>& block_columns)
{
  is_dense_ = is_matrix_free_ = false;
  dense_.resize(0, 0);
  setBlocks(laws);
  const size_t count = laws.size();
  row_begin_.assign(count + 1, 0);
  value_begin_.assign(count + 1, 0);
  diagonal_.assign(count, 0);
  columns_.clear();
  for (size_t i = 0; i < count; ++i)
  {
    const int d = laws[i].dimension();
    for (int p = begin[i]; p < begin[i + 1]; ++p)
    {
      const int j = block_columns[static_cast<size_t>(p)];
      if (j == static_cast<int>(i))
        diagonal_[i] = value_begin_[i] + d * (static_cast<int>(columns_.size()) - row_begin_[i]);
      for (int column = offset(j); column < offset(j + 1); ++column)
        columns_.push_back(column);
    }
    row_begin_[i + 1] = static_cast<int>(columns_.size());
    value_begin_[i + 1] = value_begin_[i] + d * (row_begin_[i + 1] - row_begin_[i]);
  }
  values_.assign(static_cast<size_t>(value_begin_[count]), 0.0);
}

double* DelassusOperator::block(int i, int j)
{
  const auto row = static_cast<size_t>(i);
  const auto first = columns_.begin() + row_begin_[row];
  const auto last = columns_.begin() + row_begin_[row + 1];
  const auto found = std::lower_bound(first, last, offset(j));
  if (found == last || *found != offset(j))
    return nullptr;
  return values_.data() + value_begin_[row] + dimension(i) * (found - first);
}

bool DelassusOperator::prefersDense(int rows, double share)
{
  constexpr int FEW = 16, MANY = 96;
  constexpr double SHARE = 0.15, SHARE_OF_MANY = 0.4;
  return rows <= FEW || share >= (rows <= MANY ? SHARE : SHARE_OF_MANY);
}

void DelassusOperator::assign(const SparseRows& matrix, const std::vector<Law>& laws, OperatorKind kind)
{
  const int size = rowCount(laws);
  if (matrix.rows() != size || matrix.cols() != size)
    throw std::invalid_argument("W is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
                                ", expected " + std::to_string(size) + " x " + std::to_string(size) +
                                " for the given laws");
  const double share = static_cast<double>(matrix.nonZeros()) / (static_cast<double>(size) * size);
  if (kind == OperatorKind::DENSE || (kind != OperatorKind::SPARSE && prefersDense(size, share)))
  {
    resizeDense(laws);
    dense_ = matrix;
    return;
  }
  setBlocks(laws);
  std::vector<int> begin = {0};
  std::vector<int> block_columns;
  for (int i = 0; i < blocks(); ++i)
  {
    block_columns.push_back(i);
    for (int row = offset(i); row < offset(i + 1); ++row)
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
        block_columns.push_back(blockOf(static_cast<int>(entry.col())));
    std::sort(block_columns.begin() + begin.back(), block_columns.end());
    block_columns.erase(std::unique(block_columns.begin() + begin.back(), block_columns.end()), block_columns.end());
    begin.push_back(static_cast<int>(block_columns.size()));
  }
  resizeSparse(laws, begin, block_columns);
  for (int i = 0; i < blocks(); ++i)
    for (int row = offset(i); row < offset(i + 1); ++row)
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
      {
        const int j = blockOf(static_cast<int>(entry.col()));
        block(i, j)[(row - offset(i)) + dimension(i) * (static_cast<int>(entry.col()) - offset(j))] += entry.value();
      }
}

void DelassusOperator::assign(const Eigen::MatrixXd& matrix, const std::vector<Law>& laws)
{
  assign(SparseRows(matrix.sparseView()), laws);
}

void DelassusOperator::assignHalf(const std::vector<Law>& laws, const std::vector<int>& touched_begin,
                                  const std::vector<int>& touched, const std::vector<double>& values, int columns)
{
  is_dense_ = false;
  is_matrix_free_ = true;
  dense_.resize(0, 0);
  setBlocks(laws);
  row_begin_ = touched_begin;
  columns_ = touched;
  value_begin_.resize(laws.size() + 1);
  value_begin_[0] = 0;
  for (size_t i = 0; i < laws.size(); ++i)
    value_begin_[i + 1] = value_begin_[i] + laws[i].dimension() * (touched_begin[i + 1] - touched_begin[i]);
  values_ = values;
  half_.resize(columns);
  computeDiagonal();
}

void DelassusOperator::computeDiagonal()
{
  diagonal_.resize(static_cast<size_t>(blocks()));
  size_t next = static_cast<size_t>(value_begin_.back());
  for (int i = 0; i < blocks(); ++i)
  {
    diagonal_[static_cast<size_t>(i)] = static_cast<int>(next);
    next += static_cast<size_t>(dimension(i) * dimension(i));
  }
  values_.resize(next);
  for (int i = 0; i < blocks(); ++i)
  {
    const int d = dimension(i);
    double* target = values_.data() + diagonal_[static_cast<size_t>(i)];
    std::fill(target, target + d * d, 0.0);
    visitHalfRow(i,
                 [&](int, const double* value, int)
                 {
                   for (int a = 0; a < d; ++a)
                     for (int b = 0; b < d; ++b)
                       target[a + b * d] += value[a] * value[b];
                 });
  }
}

template <int D>
void DelassusOperator::addHalfProduct(int i, const Eigen::VectorXd& x) const
{
  const Vector<D> impulse = x.segment<D>(offset(i));
  const auto row = static_cast<size_t>(i);
  const double* value = values_.data() + value_begin_[row];
  for (int k = row_begin_[row]; k < row_begin_[row + 1]; ++k, value += D)
    half_[columns_[static_cast<size_t>(k)]] += Eigen::Map<const Vector<D>>(value).dot(impulse);
}

void DelassusOperator::apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const
{
  y.resize(rows());
  if (is_dense_)
  {
    denseProduct(dense_.data(), rows(), rows(), x.data(), y.data());
    return;
  }
  if (is_matrix_free_)
  {
    half_.setZero();
    for (int i = 0; i < blocks(); ++i)
      if (dimension(i) == 3)
        addHalfProduct<3>(i, x);
      else if (dimension(i) == 2)
        addHalfProduct<2>(i, x);
      else
        addHalfProduct<1>(i, x);
  }
  const Eigen::VectorXd& factor = is_matrix_free_ ? half_ : x;
  for (int i = 0; i < blocks(); ++i)
    if (dimension(i) == 3)
      y.segment<3>(offset(i)) = storedProduct<3>(i, factor);
    else if (dimension(i) == 2)
      y.segment<2>(offset(i)) = storedProduct<2>(i, factor);
    else
      y.segment<1>(offset(i)) = storedProduct<1>(i, factor);
}

void DelassusOperator::applyTransposed(const Eigen::VectorXd& x, Eigen::VectorXd& y) const
{
  if (is_matrix_free_)
  {
    apply(x, y);
    return;
  }
  y.resize(rows());
  if (is_dense_)
  {
    y.noalias() = dense_.transpose() * x;
    return;
  }
  y.setZero();
  for (int i = 0; i < blocks(); ++i)
    visitRow(i,
             [&](int column, const double* value, int)
             {
               for (int k = 0; k < dimension(i); ++k)
                 y[column] += value[k] * x[offset(i) + k];
             });
}

Eigen::MatrixXd DelassusOperator::toDense() const
{
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows(), rows());
  for (int i = 0; i < blocks(); ++i)
    visitRow(i,
             [&](int column, const double* value, int stride)
             {
               for (int k = 0; k < dimension(i); ++k)
                 matrix(offset(i) + k, column) = value[k * stride];
             });
  return matrix;
}

SparseRows DelassusOperator::toSparse() const
{
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < blocks(); ++i)
    visitRow(i,
             [&](int column, const double* value, int stride)
             {
               for (int k = 0; k < dimension(i); ++k)
                 if (value[k * stride] != 0.0)
                   entries.emplace_back(offset(i) + k, column, value[k * stride]);
             });
  SparseRows matrix(rows(), rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace frictional_contact_sim
