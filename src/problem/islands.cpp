#include "frictional_contact_sim/problem/islands.h"

#include <algorithm>
#include <numeric>

namespace frictional_contact_sim
{
int Islands::uniteDense(const DelassusOperator& W)
{
  const int blocks = W.blocks();
  int count = blocks;
  for (int i = 0; i < blocks && count > 1; ++i)
  {
    // Whole block rows, so that W_ij is seen from i and W_ji from j.
    magnitude_ = W.dense().row(W.offset(i)).cwiseAbs();
    for (int row = W.offset(i) + 1; row < W.offset(i + 1); ++row)
      magnitude_ = magnitude_.cwiseMax(W.dense().row(row).cwiseAbs());
    for (int j = 0; j < blocks && count > 1; ++j)
    {
      bool coupled = false;
      for (int column = W.offset(j); column < W.offset(j + 1); ++column)
        coupled = coupled || magnitude_[column] > 0.0;
      if (coupled && sets_.unite(i, j))
        --count;
    }
  }
  return count;
}

int Islands::uniteSparse(const DelassusOperator& W)
{
  int count = W.blocks();
  for (int i = 0; i < W.blocks() && count > 1; ++i)
    W.visitRow(i,
               [&](int column, const double* value, int stride)
               {
                 const int j = W.blockOf(column);
                 if (j == i)
                   return;
                 for (int a = 0; a < W.dimension(i); ++a)
                   if (value[a * stride] != 0.0)
                   {
                     count -= sets_.unite(i, j) ? 1 : 0;
                     return;
                   }
               });
  return count;
}

int Islands::uniteMatrixFree(const DelassusOperator& W)
{
  int count = W.blocks();
  toucher_.assign(static_cast<size_t>(W.halfColumns()), -1);
  for (int i = 0; i < W.blocks() && count > 1; ++i)
    W.visitHalfRow(i,
                   [&](int column, const double*, int)
                   {
                     int& toucher = toucher_[static_cast<size_t>(column)];
                     if (toucher >= 0)
                       count -= sets_.unite(i, toucher) ? 1 : 0;
                     toucher = i;
                   });
  return count;
}

int Islands::find(const DelassusOperator& W)
{
  const int blocks = W.blocks();
  order_.clear();
  sets_.reset(blocks);
  const int count = W.isDense() ? uniteDense(W) : W.isMatrixFree() ? uniteMatrixFree(W) : uniteSparse(W);
  if (count <= 1)
    return count;
  const auto size = static_cast<size_t>(count);
  island_.resize(static_cast<size_t>(blocks));
  begin_.assign(size + 1, 0);
  rows_.assign(size, 0);
  int next = 0;
  for (int i = 0; i < blocks; ++i)
  {
    const int first = sets_.root(i);
    const int k = first == i ? next++ : island_[static_cast<size_t>(first)];
    island_[static_cast<size_t>(i)] = k;
    ++begin_[static_cast<size_t>(k) + 1];
    rows_[static_cast<size_t>(k)] += W.dimension(i);
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  members_.resize(static_cast<size_t>(blocks));
  for (int i = 0; i < blocks; ++i)
    members_[static_cast<size_t>(begin_[static_cast<size_t>(island_[static_cast<size_t>(i)])]++)] = i;
  for (size_t k = size; k > 0; --k)
    begin_[k] = begin_[k - 1];
  begin_[0] = 0;
  order_.resize(size);
  std::iota(order_.begin(), order_.end(), 0);
  std::sort(order_.begin(), order_.end(),
            [this](int a, int b)
            {
              const int rows_a = rows_[static_cast<size_t>(a)], rows_b = rows_[static_cast<size_t>(b)];
              return rows_a != rows_b ? rows_a < rows_b : a < b;
            });
  return count;
}

void Islands::laws(int k, std::vector<int>& laws) const
{
  const auto island = static_cast<size_t>(order_[static_cast<size_t>(k)]);
  laws.assign(members_.begin() + begin_[island], members_.begin() + begin_[island + 1]);
}

}  // namespace frictional_contact_sim
