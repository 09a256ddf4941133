#include "frictional_contact_sim/problem/delassus_operator.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
void DelassusOperator::setBlocks(const std::vector<Law>& laws)
{
  offsets_.resize(laws.size() + 1);
  offsets_[0] = 0;
  for (std::size_t i = 0; i < laws.size(); ++i)
    offsets_[i + 1] = offsets_[i] + laws[i].dimension();
  block_of_row_.resize(static_cast<std::size_t>(rows()));
  for (int i = 0; i < blocks(); ++i)
    std::fill(block_of_row_.begin() + offset(i), block_of_row_.begin() + offset(i + 1), i);
}

void DelassusOperator::resizeDense(const std::vector<Law>& laws)
{
  is_dense_ = true;
  setBlocks(laws);
  dense_.resize(rows(), rows());
}

void DelassusOperator::resizeSparse(const std::vector<Law>& laws, const std::vector<std::vector<int>>& block_columns)
{
  is_dense_ = false;
  dense_.resize(0, 0);
  setBlocks(laws);
  const std::size_t count = laws.size();
  row_begin_.assign(count + 1, 0);
  value_begin_.assign(count + 1, 0);
  diagonal_.assign(count, 0);
  columns_.clear();
  for (std::size_t i = 0; i < count; ++i)
  {
    const int d = laws[i].dimension();
    for (const int j : block_columns[i])
    {
      if (j == static_cast<int>(i))
        diagonal_[i] = value_begin_[i] + d * (static_cast<int>(columns_.size()) - row_begin_[i]);
      for (int column = offset(j); column < offset(j + 1); ++column)
        columns_.push_back(column);
    }
    row_begin_[i + 1] = static_cast<int>(columns_.size());
    value_begin_[i + 1] = value_begin_[i] + d * (row_begin_[i + 1] - row_begin_[i]);
  }
  values_.assign(static_cast<std::size_t>(value_begin_[count]), 0.0);
}

double* DelassusOperator::block(int i, int j)
{
  const auto row = static_cast<std::size_t>(i);
  const auto first = columns_.begin() + row_begin_[row];
  const auto last = columns_.begin() + row_begin_[row + 1];
  const auto found = std::lower_bound(first, last, offset(j));
  if (found == last || *found != offset(j))
    return nullptr;
  return values_.data() + value_begin_[row] + dimension(i) * (found - first);
}

void DelassusOperator::assign(const SparseRows& matrix, const std::vector<Law>& laws)
{
  const int size = rowCount(laws);
  if (matrix.rows() != size || matrix.cols() != size)
    throw std::invalid_argument("W is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
                                ", expected " + std::to_string(size) + " x " + std::to_string(size) +
                                " for the given laws");
  if (size <= DENSE_ROWS || static_cast<double>(matrix.nonZeros()) >= DENSE_SHARE * size * static_cast<double>(size))
  {
    resizeDense(laws);
    dense_ = matrix;
    return;
  }
  setBlocks(laws);
  std::vector<std::vector<int>> block_columns(laws.size());
  for (int i = 0; i < blocks(); ++i)
  {
    std::vector<int>& touched = block_columns[static_cast<std::size_t>(i)];
    touched.push_back(i);
    for (int row = offset(i); row < offset(i + 1); ++row)
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
        touched.push_back(blockOf(static_cast<int>(entry.col())));
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  }
  resizeSparse(laws, block_columns);
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

double DelassusOperator::storedShare(const std::vector<int>& blocks, const std::vector<int>& position, int rows) const
{
  double entries = 0.0;
  for (const int i : blocks)
    for (int p = row_begin_[static_cast<std::size_t>(i)]; p < row_begin_[static_cast<std::size_t>(i) + 1]; ++p)
      if (position[static_cast<std::size_t>(blockOf(columns_[static_cast<std::size_t>(p)]))] >= 0)
        entries += dimension(i);
  return entries / (static_cast<double>(rows) * rows);
}

void DelassusOperator::assignSparseBlocks(const DelassusOperator& whole, const std::vector<int>& blocks,
                                          const std::vector<int>& position)
{
  const std::size_t count = blocks.size();
  row_begin_.resize(count + 1);
  value_begin_.resize(count + 1);
  diagonal_.resize(count);
  columns_.clear();
  values_.clear();
  for (std::size_t k = 0; k < count; ++k)
  {
    row_begin_[k] = static_cast<int>(columns_.size());
    value_begin_[k] = static_cast<int>(values_.size());
    const auto row = static_cast<std::size_t>(blocks[k]);
    const int d = dimension(static_cast<int>(k));
    const double* value = whole.values_.data() + whole.value_begin_[row];
    for (int p = whole.row_begin_[row]; p < whole.row_begin_[row + 1]; ++p, value += d)
    {
      const int column = whole.columns_[static_cast<std::size_t>(p)];
      const int j = whole.blockOf(column);
      const int place = position[static_cast<std::size_t>(j)];
      if (place < 0)
        continue;
      if (column == whole.offset(blocks[k]))
        diagonal_[k] = static_cast<int>(values_.size());
      columns_.push_back(offset(place) + column - whole.offset(j));
      values_.insert(values_.end(), value, value + d);
    }
  }
  row_begin_[count] = static_cast<int>(columns_.size());
  value_begin_[count] = static_cast<int>(values_.size());
}

void DelassusOperator::assignBlocks(const DelassusOperator& whole, const std::vector<int>& blocks,
                                    const std::vector<int>& position, const std::vector<Law>& laws)
{
  const int size = rowCount(laws);
  if (!whole.is_dense_ && size > DENSE_ROWS && whole.storedShare(blocks, position, size) < DENSE_SHARE)
  {
    is_dense_ = false;
    setBlocks(laws);
    assignSparseBlocks(whole, blocks, position);
    return;
  }
  resizeDense(laws);
  if (!whole.is_dense_)
    dense_.setZero();
  for (std::size_t k = 0; k < blocks.size(); ++k)
  {
    const int d = dimension(static_cast<int>(k));
    const int first = offset(static_cast<int>(k));
    if (whole.is_dense_)
      for (std::size_t l = 0; l < blocks.size(); ++l)
        dense_.block(first, offset(static_cast<int>(l)), d, dimension(static_cast<int>(l))) =
            whole.dense_.block(whole.offset(blocks[k]), whole.offset(blocks[l]), d, dimension(static_cast<int>(l)));
    else
      whole.visitRow(blocks[k],
                     [&](int column, const double* value, int stride)
                     {
                       const int j = whole.blockOf(column);
                       const int place = position[static_cast<std::size_t>(j)];
                       if (place < 0)
                         return;
                       for (int a = 0; a < d; ++a)
                         dense_(first + a, offset(place) + column - whole.offset(j)) = value[a * stride];
                     });
  }
}

void DelassusOperator::apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const
{
  y.resize(rows());
  if (is_dense_)
  {
    y.noalias() = dense_ * x;
    return;
  }
  for (int i = 0; i < blocks(); ++i)
  {
    if (dimension(i) == 3)
      y.segment<3>(offset(i)) = rowProduct<3>(i, x);
    else if (dimension(i) == 2)
      y.segment<2>(offset(i)) = rowProduct<2>(i, x);
    else
      y.segment<1>(offset(i)) = rowProduct<1>(i, x);
  }
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
