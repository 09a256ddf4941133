#include "frictional_contact_sim/problem/certificate/kinematic_islands.h"

#include <algorithm>

#include "frictional_contact_sim/math/union_find.h"
#include "frictional_contact_sim/problem/islands.h"

namespace frictional_contact_sim
{
namespace
{
/** Joins all columns of a group of rows. @return one of them, -1 where there is none */
int unite(const SparseRows& matrix, int first, int count, UnionFind& sets)
{
  int any = -1;
  for (int row = first; row < first + count; ++row)
    for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry)
      if (entry.value() != 0.0)
      {
        if (any >= 0)
          sets.unite(any, static_cast<int>(entry.col()));
        any = static_cast<int>(entry.col());
      }
  return any;
}

/** Chosen rows and columns. @param position of a column in the result, -1: not there */
SparseRows select(const SparseRows& matrix, const std::vector<int>& rows, const std::vector<int>& position, int columns)
{
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t i = 0; i < rows.size(); ++i)
    for (SparseRows::InnerIterator entry(matrix, rows[i]); entry; ++entry)
      if (position[static_cast<size_t>(entry.col())] >= 0)
        entries.emplace_back(static_cast<int>(i), position[static_cast<size_t>(entry.col())], entry.value());
  SparseRows result(static_cast<Eigen::Index>(rows.size()), columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Eigen::VectorXd select(const Eigen::VectorXd& vector, const std::vector<int>& rows)
{
  Eigen::VectorXd result(static_cast<Eigen::Index>(rows.size()));
  for (size_t i = 0; i < rows.size(); ++i)
    result[static_cast<Eigen::Index>(i)] = vector[rows[i]];
  return result;
}

template <typename T>
std::vector<T> select(const std::vector<T>& values, const std::vector<int>& indices)
{
  std::vector<T> result;
  for (const int index : indices)
    if (static_cast<size_t>(index) < values.size())  // scales may be empty
      result.push_back(values[static_cast<size_t>(index)]);
  return result;
}

/** Rows of laws. @param first row of every law */
std::vector<int> rowsOf(const std::vector<int>& laws, const std::vector<Law>& all, const std::vector<int>& first)
{
  std::vector<int> rows;
  for (const int law : laws)
    for (int k = 0; k < all[static_cast<size_t>(law)].dimension(); ++k)
      rows.push_back(first[static_cast<size_t>(law)] + k);
  return rows;
}

std::vector<int> firstRows(const std::vector<Law>& laws)
{
  std::vector<int> first;
  int row = 0;
  for (const Law& law : laws)
  {
    first.push_back(row);
    row += law.dimension();
  }
  return first;
}
}  // namespace

std::vector<KinematicIsland<IncrementalProblem>> kinematicIslands(const IncrementalProblem& problem)
{
  const int velocities = problem.velocities();
  const std::vector<int> first = firstRows(problem.laws);
  UnionFind sets;
  sets.reset(velocities);
  for (int j = 0; j < velocities; ++j)
    unite(problem.M, j, 1, sets);
  std::vector<int> law_column, bilateral_column;
  for (size_t i = 0; i < problem.laws.size(); ++i)
    law_column.push_back(unite(problem.H, first[i], problem.laws[i].dimension(), sets));
  for (int k = 0; k < problem.bilaterals(); ++k)
    bilateral_column.push_back(unite(problem.G, k, 1, sets));

  std::vector<KinematicIsland<IncrementalProblem>> islands;
  std::vector<int> island_of(static_cast<size_t>(velocities), -1);
  const auto islandOf = [&](int column) -> KinematicIsland<IncrementalProblem>&
  {
    // A row that moves with nothing is an island of its own.
    if (column < 0)
      return islands.emplace_back();
    int& index = island_of[static_cast<size_t>(sets.root(column))];
    if (index < 0)
    {
      index = static_cast<int>(islands.size());
      islands.emplace_back();
    }
    return islands[static_cast<size_t>(index)];
  };
  for (size_t i = 0; i < problem.laws.size(); ++i)
    islandOf(law_column[i]).laws.push_back(static_cast<int>(i));
  for (int k = 0; k < problem.bilaterals(); ++k)
    islandOf(bilateral_column[static_cast<size_t>(k)]).bilaterals.push_back(k);
  for (int j = 0; j < velocities; ++j)
    if (const int index = island_of[static_cast<size_t>(sets.root(j))]; index >= 0)
      islands[static_cast<size_t>(index)].velocities.push_back(j);

  std::vector<int> position(static_cast<size_t>(velocities), -1);
  for (KinematicIsland<IncrementalProblem>& island : islands)
  {
    const auto columns = static_cast<int>(island.velocities.size());
    for (int j = 0; j < columns; ++j)
      position[static_cast<size_t>(island.velocities[static_cast<size_t>(j)])] = j;
    const std::vector<int> rows = rowsOf(island.laws, problem.laws, first);
    IncrementalProblem& part = island.problem;
    part.M = select(problem.M, island.velocities, position, columns);
    part.f = select(problem.f, island.velocities);
    part.H = select(problem.H, rows, position, columns);
    part.w = select(problem.w, rows);
    part.laws = select(problem.laws, island.laws);
    part.G = select(problem.G, island.bilaterals, position, columns);
    part.b = select(problem.b, island.bilaterals);
    part.scales = select(problem.scales, island.laws);
    part.bilateral_scales = select(problem.bilateral_scales, island.bilaterals);
    for (const int velocity : island.velocities)
      position[static_cast<size_t>(velocity)] = -1;
  }
  return islands;
}

std::vector<KinematicIsland<DelassusProblem>> kinematicIslands(const DelassusProblem& problem)
{
  Islands finder;
  const int count = finder.find(problem.W);
  const std::vector<int> first = firstRows(problem.laws);
  const SparseRows W = problem.W.toSparse();
  std::vector<KinematicIsland<DelassusProblem>> islands(static_cast<size_t>(count));
  std::vector<int> position(static_cast<size_t>(W.rows()), -1);
  for (int i = 0; i < count; ++i)
  {
    KinematicIsland<DelassusProblem>& island = islands[static_cast<size_t>(i)];
    if (finder.count() == 0)
      for (size_t law = 0; law < problem.laws.size(); ++law)
        island.laws.push_back(static_cast<int>(law));
    else
      finder.laws(i, island.laws);
    island.velocities = rowsOf(island.laws, problem.laws, first);
    const auto columns = static_cast<int>(island.velocities.size());
    for (int j = 0; j < columns; ++j)
      position[static_cast<size_t>(island.velocities[static_cast<size_t>(j)])] = j;
    island.problem.laws = select(problem.laws, island.laws);
    island.problem.W.assign(select(W, island.velocities, position, columns), island.problem.laws);
    island.problem.q = select(problem.q, island.velocities);
    island.problem.scales = select(problem.scales, island.laws);
    for (const int row : island.velocities)
      position[static_cast<size_t>(row)] = -1;
  }
  std::sort(islands.begin(), islands.end(), [](const auto& a, const auto& b) { return a.laws < b.laws; });
  return islands;
}

}  // namespace frictional_contact_sim
