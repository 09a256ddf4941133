#pragma once
/**
 * @file search.h
 * @brief The depth-first search over the modes of one island (solver/enumeration/enumeration.h).
 */
#include <functional>

#include "sliding_cell.h"

namespace frictional_contact_sim
{
struct SearchResult
{
  std::vector<Leaf> leaves;
  bool complete = true;
  long nodes = 0;
  long unresolved = 0;
  long cuts = 0;
};

class Search
{
public:
  /**
   * @param first end with the first solution
   * @param interrupted asked at every node
   */
  Search(const ScaledIsland& island, const EnumerateOptions& options, bool first, std::function<bool()> interrupted);

  SearchResult run();
  /** @brief Cells of two leaves without wedges have a common point. */
  bool meet(const Leaf& a, const Leaf& b) { return relaxation_.meets(a.cell, b.cell); }

private:
  void visit(Cell& cell);
  void look(Cell& cell);
  Feasibility addCuts(const Cell& cell, Feasibility feasibility);
  void closeWithoutCuts(Cell& cell);
  void close(Cell& cell);
  void closeWedges(Cell& cell);
  int nextLaw(const Cell& cell, bool has_point) const;
  void branch(Cell& cell, int law, bool has_point);

  const ScaledIsland& island_;
  const EnumerateOptions& options_;
  bool first_;
  std::function<bool()> interrupted_;
  Relaxation relaxation_;
  SearchResult result_;
  bool stopped_ = false;
};

}  // namespace frictional_contact_sim
