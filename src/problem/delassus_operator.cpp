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
  std::vector<int> block_of_row(static_cast<std::size_t>(size));
  for (int i = 0; i < blocks(); ++i)
    std::fill(block_of_row.begin() + offset(i), block_of_row.begin() + offset(i + 1), i);
  std::vector<std::vector<int>> block_columns(laws.size());
  for (int i = 0; i < blocks(); ++i)
  {
    std::vector<int>& touched = block_columns[static_cast<std::size_t>(i)];
    touched.push_back(i);
    for (int row = offset(i); row < offset(i + 1); ++row)
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
        touched.push_back(block_of_row[static_cast<std::size_t>(entry.col())]);
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  }
  resizeSparse(laws, block_columns);
  for (int i = 0; i < blocks(); ++i)
    for (int row = offset(i); row < offset(i + 1); ++row)
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
      {
        const int j = block_of_row[static_cast<std::size_t>(entry.col())];
        block(i, j)[(row - offset(i)) + dimension(i) * (static_cast<int>(entry.col()) - offset(j))] += entry.value();
      }
}

void DelassusOperator::assign(const Eigen::MatrixXd& matrix, const std::vector<Law>& laws)
{
  assign(SparseRows(matrix.sparseView()), laws);
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
