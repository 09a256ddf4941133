#include "families.h"

#include <algorithm>

#include "frictional_contact_sim/math/union_find.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double SAME_POINT = 1e-6;  ///< relative distance of points that count as one

bool isSame(const Eigen::VectorXd& a, const Eigen::VectorXd& b)
{
  return (a - b).lpNorm<Eigen::Infinity>() <= SAME_POINT * std::max(1.0, a.lpNorm<Eigen::Infinity>());
}

bool shareVertex(const SolutionPiece& a, const SolutionPiece& b)
{
  return std::any_of(
      a.vertices.begin(), a.vertices.end(),
      [&](const Eigen::VectorXd& vertex)
      {
        return std::any_of(
            b.vertices.begin(), b.vertices.end(), [&](const Eigen::VectorXd& other) { return isSame(vertex, other); });
      });
}

bool slides(const Leaf& leaf)
{
  return std::count(leaf.cell.modes.begin(), leaf.cell.modes.end(), LawMode::SLIDE) > 0;
}

/// Boxes around bounded pieces are apart.
bool areApart(const SolutionPiece& a, const SolutionPiece& b)
{
  if (!a.bounded || !b.bounded || !a.vertices_complete || !b.vertices_complete)
    return false;
  const auto corner = [](const SolutionPiece& piece, double sign)
  {
    Eigen::VectorXd result = sign * piece.vertices.front();
    for (const Eigen::VectorXd& vertex : piece.vertices)
      result = result.cwiseMax(sign * vertex);
    return Eigen::VectorXd(sign * result);
  };
  const Eigen::VectorXd gap = (corner(a, -1.0) - corner(b, 1.0)).cwiseMax(corner(b, -1.0) - corner(a, 1.0));
  return gap.maxCoeff() > SAME_POINT * std::max(1.0, corner(a, 1.0).lpNorm<Eigen::Infinity>());
}

/// What stands for one continuum that the search could only sample (3D): same modes, positive dimension.
bool areSamples(const Leaf& a, const Leaf& b)
{
  return a.piece.dimension > 0 && b.piece.dimension > 0 && slides(a) && slides(b) && a.cell.modes == b.cell.modes;
}

bool touch(Search& search, const Leaf& a, const Leaf& b)
{
  if (shareVertex(a.piece, b.piece) || areSamples(a, b))
    return true;
  if (a.piece.dimension + b.piece.dimension == 0 || areApart(a.piece, b.piece) || slides(a) || slides(b))
    return false;
  return search.meet(a, b);
}

SolutionPiece unscaled(const ScaledIsland& island, const std::vector<Law>& laws, const SolutionPiece& scaled)
{
  SolutionPiece piece = scaled;
  piece.modes.assign(laws.size(), LawMode::STICK);
  for (size_t i = 0; i < island.indices.size(); ++i)
    piece.modes[static_cast<size_t>(island.indices[i])] = scaled.modes[i];
  for (Eigen::VectorXd& vertex : piece.vertices)
    vertex = island.impulses(vertex);
  for (Eigen::VectorXd& ray : piece.rays)
    ray = island.P * ray;
  return piece;
}
}  // namespace

int IslandFamily::dimension() const
{
  int largest = 0;
  for (const SolutionPiece& piece : pieces)
    largest = std::max(largest, piece.dimension);
  return largest;
}

std::vector<IslandFamily> joinLeaves(const ScaledIsland& island, const std::vector<Law>& laws, Search& search,
                                     const std::vector<Leaf>& leaves)
{
  UnionFind sets;
  const auto count = static_cast<int>(leaves.size());
  sets.reset(count);
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < a; ++b)
      if (sets.root(a) != sets.root(b) && touch(search, leaves[static_cast<size_t>(a)], leaves[static_cast<size_t>(b)]))
        sets.unite(a, b);
  std::vector<IslandFamily> families;
  std::vector<int> family_of(leaves.size(), -1);
  for (int a = 0; a < count; ++a)
  {
    int& place = family_of[static_cast<size_t>(sets.root(a))];
    if (place < 0)
    {
      place = static_cast<int>(families.size());
      families.emplace_back();
    }
    IslandFamily& family = families[static_cast<size_t>(place)];
    const Leaf& leaf = leaves[static_cast<size_t>(a)];
    family.proved = family.pieces.empty() ? leaf.proved
                    : leaf.piece.dimension == 0 && family.isolated()
                        ? family.proved || leaf.proved  // one point: a proof from one side will do
                        : family.proved && leaf.proved;
    family.pieces.push_back(unscaled(island, laws, leaf.piece));
  }
  for (IslandFamily& family : families)
    if (family.isolated())
      family.pieces.resize(1);  // one point met from several sides
  return families;
}

}  // namespace frictional_contact_sim
