#pragma once
/**
 * @file row_builder.h
 * @brief Fills a sparse matrix row by row into storage that only grows.
 */
#include <utility>
#include <vector>

#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
class RowBuilder
{
public:
  void clear()
  {
    starts_.assign(1, 0);
    columns_.clear();
    values_.clear();
  }
  /** @brief Next entry of the current row; columns ascend. */
  void push(int column, double value)
  {
    columns_.push_back(column);
    values_.push_back(value);
  }
  void endRow() { starts_.push_back(static_cast<int>(columns_.size())); }
  int rows() const { return static_cast<int>(starts_.size()) - 1; }
  /** @brief Value of row * vector for a finished row. */
  double dot(int row, const Eigen::VectorXd& vector) const
  {
    double sum = 0.0;
    for (int k = starts_[row]; k < starts_[row + 1]; ++k)
      sum += values_[k] * vector[columns_[k]];
    return sum;
  }
  /** @brief Copies the rows into `matrix`, keeping its storage where it is large enough. */
  void copyTo(int columns, SparseRows& matrix) const;

private:
  std::vector<int> starts_{0};
  std::vector<int> columns_;
  std::vector<double> values_;
};

}  // namespace frictional_contact_sim
