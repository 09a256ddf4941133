#include "frictional_contact_sim/problem/delassus_operator.h"

// Parts of an operator: the blocks of an island, in the storage of the whole.
namespace frictional_contact_sim
{
double DelassusOperator::storedShare(const std::vector<int>& blocks, const std::vector<int>& position, int rows) const
{
  double entries = 0.0;
  for (const int i : blocks)
    for (int p = row_begin_[static_cast<size_t>(i)]; p < row_begin_[static_cast<size_t>(i) + 1]; ++p)
      if (position[static_cast<size_t>(blockOf(columns_[static_cast<size_t>(p)]))] >= 0)
        entries += dimension(i);
  return entries / (static_cast<double>(rows) * rows);
}

void DelassusOperator::assignSparseBlocks(const DelassusOperator& whole, const std::vector<int>& blocks,
                                          const std::vector<int>& position)
{
  const size_t count = blocks.size();
  row_begin_.resize(count + 1);
  value_begin_.resize(count + 1);
  diagonal_.resize(count);
  columns_.clear();
  values_.clear();
  for (size_t k = 0; k < count; ++k)
  {
    row_begin_[k] = static_cast<int>(columns_.size());
    value_begin_[k] = static_cast<int>(values_.size());
    const auto row = static_cast<size_t>(blocks[k]);
    const int d = dimension(static_cast<int>(k));
    const double* value = whole.values_.data() + whole.value_begin_[row];
    for (int p = whole.row_begin_[row]; p < whole.row_begin_[row + 1]; ++p, value += d)
    {
      const int column = whole.columns_[static_cast<size_t>(p)];
      const int j = whole.blockOf(column);
      const int place = position[static_cast<size_t>(j)];
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
                                    const std::vector<int>& position, const std::vector<Law>& laws, OperatorKind kind)
{
  if (whole.is_matrix_free_)
  {
    is_dense_ = false;
    is_matrix_free_ = true;
    setBlocks(laws);
    assignHalfBlocks(whole, blocks);
    return;
  }
  const int size = rowCount(laws);
  const bool sparse = !whole.is_dense_ && !prefersDense(size, whole.storedShare(blocks, position, size));
  if (!whole.is_dense_ && kind != OperatorKind::DENSE && (sparse || kind == OperatorKind::SPARSE))
  {
    is_dense_ = is_matrix_free_ = false;
    setBlocks(laws);
    assignSparseBlocks(whole, blocks, position);
    return;
  }
  resizeDense(laws);
  if (!whole.is_dense_)
    dense_.setZero();
  for (size_t k = 0; k < blocks.size(); ++k)
  {
    const int d = dimension(static_cast<int>(k));
    const int first = offset(static_cast<int>(k));
    if (whole.is_dense_)
      for (size_t l = 0; l < blocks.size(); ++l)
        dense_.block(first, offset(static_cast<int>(l)), d, dimension(static_cast<int>(l))) =
            whole.dense_.block(whole.offset(blocks[k]), whole.offset(blocks[l]), d, dimension(static_cast<int>(l)));
    else
      whole.visitRow(blocks[k],
                     [&](int column, const double* value, int stride)
                     {
                       const int j = whole.blockOf(column);
                       const int place = position[static_cast<size_t>(j)];
                       if (place < 0)
                         return;
                       for (int a = 0; a < d; ++a)
                         dense_(first + a, offset(place) + column - whole.offset(j)) = value[a * stride];
                     });
  }
}

void DelassusOperator::assignHalfBlocks(const DelassusOperator& whole, const std::vector<int>& blocks)
{
  if (place_.size() != static_cast<size_t>(whole.half_.size()))
    place_.assign(static_cast<size_t>(whole.half_.size()), -1);
  row_begin_.resize(blocks.size() + 1);
  value_begin_.resize(blocks.size() + 1);
  columns_.clear();
  values_.clear();
  int count = 0;
  for (size_t k = 0; k < blocks.size(); ++k)
  {
    row_begin_[k] = static_cast<int>(columns_.size());
    value_begin_[k] = static_cast<int>(values_.size());
    const int d = dimension(static_cast<int>(k));
    whole.visitHalfRow(blocks[k],
                       [&](int column, const double* value, int)
                       {
                         int& place = place_[static_cast<size_t>(column)];
                         if (place < 0)
                           place = count++;
                         columns_.push_back(place);
                         values_.insert(values_.end(), value, value + d);
                       });
  }
  row_begin_[blocks.size()] = static_cast<int>(columns_.size());
  value_begin_[blocks.size()] = static_cast<int>(values_.size());
  for (const int i : blocks)
    whole.visitHalfRow(i, [&](int column, const double*, int) { place_[static_cast<size_t>(column)] = -1; });
  half_.resize(count);
  computeDiagonal();
}

}  // namespace frictional_contact_sim
