#pragma once
/**
 * @file islands.h
 * @brief Islands of a local problem: the connected components of the graph of W's blocks (laws are nodes, two are
 * joined when W_ij or W_ji has an entry that is not zero). They are problems of their own: u_i depends on no other
 * island's r.
 *
 * Laws are joined by union-find, stopped as soon as one component is left: a W whose first block row couples everything
 * costs one look at each of its blocks.
 */
#include <vector>

#include "frictional_contact_sim/math/union_find.h"
#include "frictional_contact_sim/problem/delassus_operator.h"

namespace frictional_contact_sim
{
class Islands
{
public:
  /** @brief Finds them. @return their number; when it is at most one the lists are left empty. */
  int find(const DelassusOperator& W);

  int count() const { return static_cast<int>(order_.size()); }
  /** @brief The k of a law's island, 0 when there is one only; not in the order of laws(): the first law's is 0. */
  int islandOf(int law) const { return order_.empty() ? 0 : island_[static_cast<size_t>(law)]; }
  /** @brief Laws of the k-th island in ascending order; islands are ordered by rows, smallest first, then by first law.
   */
  void laws(int k, std::vector<int>& laws) const;
  /** @brief Rows of the k-th island. */
  int rows(int k) const { return rows_[static_cast<size_t>(order_[static_cast<size_t>(k)])]; }

private:
  int uniteDense(const DelassusOperator& W);
  int uniteSparse(const DelassusOperator& W);
  int uniteMatrixFree(const DelassusOperator& W);

  UnionFind sets_;  ///< of laws; the first law of an island names it
  std::vector<int> toucher_;  ///< matrix-free: a law that touches the column of Z, or -1
  Eigen::RowVectorXd magnitude_;  ///< dense: largest entry of a block row in each column
  std::vector<int> island_;  ///< of a law
  std::vector<int> begin_, members_;  ///< laws, island by island
  std::vector<int> rows_;  ///< of an island
  std::vector<int> order_;
};

}  // namespace frictional_contact_sim
