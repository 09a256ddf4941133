#pragma once
/**
 * @file union_find.h
 * @brief Sets of 0 ... n-1 that are joined one pair at a time; the smallest member names a set, whatever the order.
 *
 * Source: Tarjan (1975), path halving; any textbook.
 */
#include <algorithm>
#include <numeric>
#include <vector>

namespace frictional_contact_sim
{
class UnionFind
{
public:
  /** @brief n sets of one; storage is reused. */
  void reset(int n)
  {
    parent_.resize(static_cast<size_t>(n));
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  /** @brief Smallest member of i's set. */
  int root(int i)
  {
    while (parent(i) != i)
      i = parent(i) = parent(parent(i));
    return i;
  }
  /** @brief Joins the sets of i and j. @return whether they were apart */
  bool unite(int i, int j)
  {
    const int a = root(i), b = root(j);
    parent(std::max(a, b)) = std::min(a, b);
    return a != b;
  }

private:
  int& parent(int i) { return parent_[static_cast<size_t>(i)]; }
  std::vector<int> parent_;
};

}  // namespace frictional_contact_sim
