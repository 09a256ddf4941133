#include <algorithm>
#include <cmath>
#include <numeric>

#include "frictional_contact_sim/math/union_find.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"

// The symbolic part of the reduction: which velocities each law touches, which laws meet, where their products go.
namespace frictional_contact_sim
{
namespace
{
bool samePattern(const SparseRows& matrix, const std::vector<int>& outer, const std::vector<int>& inner)
{
  return outer.size() == static_cast<size_t>(matrix.rows()) + 1 &&
         inner.size() == static_cast<size_t>(matrix.nonZeros()) &&
         std::equal(outer.begin(), outer.end(), matrix.outerIndexPtr()) &&
         std::equal(inner.begin(), inner.end(), matrix.innerIndexPtr());
}

void storePattern(const SparseRows& matrix, std::vector<int>& outer, std::vector<int>& inner)
{
  outer.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.rows() + 1);
  inner.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
}
}  // namespace

bool DelassusReduction::samePattern(const IncrementalProblem& problem) const
{
  if (types_.size() != problem.laws.size())
    return false;
  for (size_t i = 0; i < types_.size(); ++i)
    if (types_[i] != problem.laws[i].type)
      return false;
  return frictional_contact_sim::samePattern(problem.H, h_outer_, h_inner_) &&
         frictional_contact_sim::samePattern(problem.G, g_outer_, g_inner_);
}

void DelassusReduction::collectPattern(const SparseRows& matrix, int first_row, int last_row, int mark)
{
  for (int p = matrix.outerIndexPtr()[first_row]; p < matrix.outerIndexPtr()[last_row]; ++p)
    for (int k = factor_.permuted(matrix.innerIndexPtr()[p]); k >= 0 && flags_[static_cast<size_t>(k)] != mark;
         k = factor_.parent()[static_cast<size_t>(k)])
    {
      flags_[static_cast<size_t>(k)] = mark;
      pattern_.push_back(k);
    }
}

void DelassusReduction::findLoops(const SparseRows& G)
{
  const int rows = static_cast<int>(G.rows());
  loops_.clear();
  loop_of_.clear();
  if (rows == 0)
    return;
  // Rows that share a velocity are joined: union-find through the first row that touched it.
  UnionFind sets;
  sets.reset(rows);
  std::vector<int> toucher(flags_.size(), -1);
  std::fill(flags_.begin(), flags_.end(), -1);
  for (int row = 0; row < rows; ++row)
  {
    pattern_.clear();
    collectPattern(G, row, row + 1, row);
    for (const int velocity : pattern_)
    {
      int& first = toucher[static_cast<size_t>(velocity)];
      if (first < 0)
        first = row;
      sets.unite(first, row);
    }
  }
  std::vector<int> index(static_cast<size_t>(rows), -1);
  for (int row = 0; row < rows; ++row)
  {
    int& loop = index[static_cast<size_t>(sets.root(row))];
    if (loop < 0)
    {
      loop = static_cast<int>(loops_.size());
      loops_.emplace_back();
    }
    loops_[static_cast<size_t>(loop)].rows.push_back(row);
  }
  loop_of_.assign(flags_.size(), -1);
  for (size_t velocity = 0; velocity < toucher.size(); ++velocity)
    if (toucher[velocity] >= 0)
    {
      loop_of_[velocity] = index[static_cast<size_t>(sets.root(toucher[velocity]))];
      loops_[static_cast<size_t>(loop_of_[velocity])].velocities.push_back(static_cast<int>(velocity));
    }
  Eigen::Index columns = 0, largest_rank = 0;
  for (Loop& loop : loops_)
  {
    const auto size = static_cast<Eigen::Index>(loop.velocities.size());
    const auto count = static_cast<Eigen::Index>(loop.rows.size());
    loop.factor.resize(static_cast<int>(count), static_cast<int>(size));
    loop.b.resize(count);
    loop.part.resize(size);
    columns = std::max(columns, size);
    largest_rank = std::max(largest_rank, count);
  }
  gathered_.resize(columns, 3);
  coupling_.resize(largest_rank, 3);
}

void DelassusReduction::addLoops(size_t law, int mark)
{
  if (loop_of_.empty())
    return;
  const auto first_loop = law_loops_.size();
  const auto end = pattern_.size();
  for (auto p = static_cast<size_t>(pattern_begin_[law]); p < end; ++p)
  {
    const int loop = loop_of_[static_cast<size_t>(pattern_[p])];
    if (loop < 0 || std::find(law_loops_.begin() + static_cast<std::ptrdiff_t>(first_loop), law_loops_.end(), loop) !=
                        law_loops_.end())
      continue;
    law_loops_.push_back(loop);
    for (const int velocity : loops_[static_cast<size_t>(loop)].velocities)
      if (flags_[static_cast<size_t>(velocity)] != mark)
      {
        flags_[static_cast<size_t>(velocity)] = mark;
        pattern_.push_back(velocity);
      }
  }
}

void DelassusReduction::analyse(const IncrementalProblem& problem)
{
  const size_t count = problem.laws.size();
  storePattern(problem.H, h_outer_, h_inner_);
  storePattern(problem.G, g_outer_, g_inner_);
  h_values_.clear();
  is_fresh_.assign(count, 1);
  types_.resize(count);
  block_offset_.assign(count + 1, 0);
  pattern_begin_.assign(count + 1, 0);
  value_begin_.assign(count + 1, 0);
  law_loop_begin_.assign(count + 1, 0);
  law_loops_.clear();
  flags_.assign(static_cast<size_t>(problem.velocities()), -1);
  work_.assign(3 * static_cast<size_t>(problem.velocities()), 0.0);
  findLoops(problem.G);
  pattern_.clear();
  std::fill(flags_.begin(), flags_.end(), -1);
  for (size_t i = 0; i < count; ++i)
  {
    const int dimension = problem.laws[i].dimension();
    const int mark = static_cast<int>(i);
    types_[i] = problem.laws[i].type;
    block_offset_[i + 1] = block_offset_[i] + dimension;
    collectPattern(problem.H, block_offset_[i], block_offset_[i + 1], mark);
    addLoops(i, mark);
    std::sort(pattern_.begin() + pattern_begin_[i], pattern_.end());
    law_loop_begin_[i + 1] = static_cast<int>(law_loops_.size());
    pattern_begin_[i + 1] = static_cast<int>(pattern_.size());
    value_begin_[i + 1] = value_begin_[i] + dimension * (pattern_begin_[i + 1] - pattern_begin_[i]);
  }
  half_rows_.resize(static_cast<size_t>(value_begin_[count]));
  preparePairs();
}

bool DelassusReduction::sameVelocities(int i, int j) const
{
  const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j);
  return std::equal(pattern_.begin() + pattern_begin_[a], pattern_.begin() + pattern_begin_[a + 1],
                    pattern_.begin() + pattern_begin_[b], pattern_.begin() + pattern_begin_[b + 1]);
}

void DelassusReduction::preparePairs()
{
  const int count = static_cast<int>(types_.size());
  const int rows = block_offset_.back();
  pairs_.clear();
  if (kind_ == OperatorKind::MATRIX_FREE)
    return;
  // Whatever a law touches it touches up to the root of the tree, so two laws meet when they share a root.
  const auto forEachRoot = [&](int i, auto visit)
  {
    const auto law = static_cast<size_t>(i);
    for (int p = pattern_begin_[law]; p < pattern_begin_[law + 1]; ++p)
    {
      const auto velocity = static_cast<size_t>(pattern_[static_cast<size_t>(p)]);
      if (factor_.parent()[velocity] < 0)
        visit(velocity);
    }
  };
  // Laws of each root, counted first; root_begin_[root] is where its list ends while it is filled.
  root_begin_.assign(flags_.size() + 1, 0);
  for (int i = 0; i < count; ++i)
    forEachRoot(i, [&](size_t root) { ++root_begin_[root]; });
  std::partial_sum(root_begin_.begin(), root_begin_.end(), root_begin_.begin());
  root_laws_.resize(static_cast<size_t>(root_begin_.back()));
  for (int i = count - 1; i >= 0; --i)
    forEachRoot(i, [&](size_t root) { root_laws_[static_cast<size_t>(--root_begin_[root])] = i; });
  meeting_begin_.assign(1, 0);
  meeting_.clear();
  mark_.assign(static_cast<size_t>(count), -1);
  double entries = 0.0;
  for (int i = 0; i < count; ++i)
  {
    meeting_.push_back(i);
    mark_[static_cast<size_t>(i)] = i;
    forEachRoot(i,
                [&](size_t root)
                {
                  for (int p = root_begin_[root]; p < root_begin_[root + 1]; ++p)
                    if (const int j = root_laws_[static_cast<size_t>(p)]; mark_[static_cast<size_t>(j)] != i)
                    {
                      mark_[static_cast<size_t>(j)] = i;
                      meeting_.push_back(j);
                    }
                });
    std::sort(meeting_.begin() + meeting_begin_.back(), meeting_.end());
    for (auto p = static_cast<size_t>(meeting_begin_.back()); p < meeting_.size(); ++p)
      entries +=
          local_.laws[static_cast<size_t>(i)].dimension() * local_.laws[static_cast<size_t>(meeting_[p])].dimension();
    meeting_begin_.push_back(static_cast<int>(meeting_.size()));
  }
  DelassusOperator& W = local_.W;
  const bool full = DelassusOperator::prefersDense(rows, entries / (static_cast<double>(rows) * rows));
  const bool dense = kind_ == OperatorKind::DENSE || (kind_ == OperatorKind::AUTOMATIC && full);
  if (dense)
  {
    W.resizeDense(local_.laws);
    W.dense().setZero();
  }
  else
    W.resizeSparse(local_.laws, meeting_begin_, meeting_);
  for (int i = 0; i < count; ++i)
    for (int p = meeting_begin_[static_cast<size_t>(i)]; p < meeting_begin_[static_cast<size_t>(i) + 1]; ++p)
    {
      const int j = meeting_[static_cast<size_t>(p)];
      if (j > i)
        break;
      const bool same = sameVelocities(i, j);
      if (dense)
        pairs_.push_back({i, j, same, &W.dense()(W.offset(i), W.offset(j)), &W.dense()(W.offset(j), W.offset(i))});
      else
        pairs_.push_back({i, j, same, W.block(i, j), W.block(j, i)});
    }
}

}  // namespace frictional_contact_sim
