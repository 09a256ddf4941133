#include "island_solutions.h"

namespace frictional_contact_sim
{
IslandSolutions enumerateIsland(const Eigen::MatrixXd& W, const Eigen::VectorXd& q, const std::vector<Law>& laws,
                                const EnumerateOptions& options, bool first, const std::function<bool()>& interrupted)
{
  IslandSolutions result;
  const ScaledIsland island = scaleIsland(W, q, laws);
  result.consistent = island.consistent;
  if (island.laws.empty() || !island.consistent)
  {
    result.complete = true;
    if (island.consistent)
    {
      result.families.emplace_back();
      result.families.front().pieces.push_back(
          {std::vector<LawMode>(laws.size(), LawMode::STICK), 0, true, true, true, {island.p}, {}});
    }
    return result;
  }
  Search search(island, options, first, interrupted);
  const SearchResult found = search.run();
  result.complete = found.complete;
  result.nodes = found.nodes;
  result.unresolved = found.unresolved;
  result.cuts = found.cuts;
  result.leaves = static_cast<long>(found.leaves.size());
  result.families = joinLeaves(island, laws, search, found.leaves);
  return result;
}

Eigen::VectorXd middle(const SolutionPiece& piece)
{
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(piece.vertices.front().size());
  for (const Eigen::VectorXd& vertex : piece.vertices)
    sum += vertex;
  return sum / static_cast<double>(piece.vertices.size());
}

}  // namespace frictional_contact_sim
