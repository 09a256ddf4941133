#include "search.h"

#include <algorithm>
#include <utility>

#include "mode_cuts.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double QUARTER = 1.57079632679489661923;  ///< of a turn [rad]; the first wedges are quarters
}  // namespace

Search::Search(const ScaledIsland& island, const EnumerateOptions& options, bool first,
               std::function<bool()> interrupted)
  : island_(island)
  , options_(options)
  , first_(first)
  , interrupted_(std::move(interrupted))
  , relaxation_(island, options)
{
}

SearchResult Search::run()
{
  if (!island_.consistent)
    return result_;
  Cell cell;
  cell.modes.assign(island_.laws.size(), LawMode::UNDECIDED);
  cell.centers.assign(island_.laws.size(), 0.0);
  cell.halves.assign(island_.laws.size(), 0.0);
  visit(cell);
  return result_;
}

void Search::visit(Cell& cell)
{
  if (result_.nodes >= options_.max_nodes || (interrupted_ && interrupted_()))
  {
    result_.complete = false;
    stopped_ = true;
  }
  if (stopped_)
    return;
  ++result_.nodes;
  const size_t inherited = relaxation_.cuts();
  look(cell);
  relaxation_.keepCuts(inherited);
}

/** Rounds of cuts at a node that was FEASIBLE: its point and feasibility with them. */
Feasibility Search::addCuts(const Cell& cell, Feasibility feasibility)
{
  const auto undecided = std::count(cell.modes.begin(), cell.modes.end(), LawMode::UNDECIDED);
  if (options_.cuts == EnumerationCuts::NONE ||
      static_cast<std::ptrdiff_t>(cell.modes.size()) - undecided > options_.cut_depth)
    return feasibility;
  for (int round = 0; round < options_.cuts_per_node && feasibility == Feasibility::FEASIBLE; ++round)
  {
    const std::vector<ModeCut> cuts = modeCuts(relaxation_, island_, cell, options_);
    if (cuts.empty())
      break;
    const size_t before = relaxation_.cuts();
    for (const ModeCut& cut : cuts)
      relaxation_.addCut(cut.row, cut.right_hand_side);
    result_.cuts += static_cast<long>(cuts.size());
    feasibility = relaxation_.solve(cell);
    if (feasibility != Feasibility::UNPROVED)
      continue;
    relaxation_.keepCuts(before);  // the program lost its digits with them
    return relaxation_.solve(cell);
  }
  return feasibility;
}

void Search::look(Cell& cell)
{
  Feasibility feasibility = relaxation_.solve(cell);
  if (feasibility == Feasibility::UNPROVED && relaxation_.cuts() > 0)
  {
    relaxation_.suspendCuts(true);
    feasibility = relaxation_.solve(cell);
    relaxation_.suspendCuts(false);
  }
  else if (feasibility == Feasibility::FEASIBLE)
    feasibility = addCuts(cell, feasibility);
  if (feasibility == Feasibility::INFEASIBLE)
    return;
  const bool has_point = feasibility == Feasibility::FEASIBLE;
  if (has_point && relaxation_.isContained(cell))
    return;
  const int law = nextLaw(cell, has_point);
  if (law >= 0)
    branch(cell, law, has_point);
  else if (has_point)
    closeWithoutCuts(cell);
  else
  {
    result_.complete = false;
    ++result_.unresolved;
  }
}

/** What is in a leaf is described by its modes alone. */
void Search::closeWithoutCuts(Cell& cell)
{
  if (relaxation_.cuts() == 0)
  {
    close(cell);
    return;
  }
  relaxation_.suspendCuts(true);
  const Feasibility feasibility = relaxation_.solve(cell);
  if (feasibility == Feasibility::FEASIBLE)
    close(cell);
  else if (feasibility == Feasibility::UNPROVED)
  {
    result_.complete = false;
    ++result_.unresolved;
  }
  relaxation_.suspendCuts(false);
}

/** The undecided law that the point serves worst, -1 when all are decided. */
int Search::nextLaw(const Cell& cell, bool has_point) const
{
  int next = -1;
  double worst = -1.0;
  for (size_t i = 0; i < cell.modes.size(); ++i)
  {
    const std::vector<LawMode>& modes = relaxation_.modes(static_cast<int>(i));
    if (cell.modes[i] != LawMode::UNDECIDED || modes.front() == LawMode::UNDECIDED)
      continue;
    if (!has_point)
      return static_cast<int>(i);
    double least = relaxation_.violation(static_cast<int>(i), modes.front());
    for (const LawMode mode : modes)
      least = std::min(least, relaxation_.violation(static_cast<int>(i), mode));
    if (least > worst)
    {
      worst = least;
      next = static_cast<int>(i);
    }
  }
  return next;
}

void Search::branch(Cell& cell, int law, bool has_point)
{
  const auto index = static_cast<size_t>(law);
  std::vector<LawMode> modes = relaxation_.modes(law);
  if (has_point)
  {
    std::vector<std::pair<double, LawMode>> order;
    for (const LawMode mode : modes)
      order.emplace_back(relaxation_.violation(law, mode), mode);
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (size_t k = 0; k < modes.size(); ++k)
      modes[k] = order[k].second;
  }
  for (const LawMode mode : modes)
  {
    cell.modes[index] = mode;
    if (mode != LawMode::SLIDE)
    {
      visit(cell);
      continue;
    }
    for (int quarter = 0; quarter < 4; ++quarter)
    {
      cell.centers[index] = (quarter + 0.5) * QUARTER;
      cell.halves[index] = 0.5 * QUARTER;
      visit(cell);
    }
    cell.halves[index] = 0.0;
  }
  cell.modes[index] = LawMode::UNDECIDED;
}

/** All modes are decided and the relaxation is feasible. */
void Search::close(Cell& cell)
{
  if (std::count(cell.modes.begin(), cell.modes.end(), LawMode::SLIDE) > 0)
  {
    closeWedges(cell);
    return;
  }
  bool closed = true;
  if (std::optional<Leaf> leaf = makeLeaf(relaxation_, cell, options_, closed))
    result_.leaves.push_back(std::move(*leaf));
  if (!closed)
  {
    result_.complete = false;
    ++result_.unresolved;
  }
  if (first_ && !result_.leaves.empty())
  {
    result_.complete = false;
    stopped_ = true;
  }
}

void Search::closeWedges(Cell& cell)
{
  std::optional<Leaf> leaf;
  const WedgeContent content = resolveWedges(island_, relaxation_, cell, leaf);
  if (content == WedgeContent::NONE)
    return;
  const auto widest =
      static_cast<size_t>(std::max_element(cell.halves.begin(), cell.halves.end()) - cell.halves.begin());
  if (leaf && (content == WedgeContent::ONE || first_ || cell.halves[widest] < options_.min_angle))
  {
    result_.leaves.push_back(*leaf);
    stopped_ = stopped_ || first_;
  }
  if (content == WedgeContent::ONE && !first_)
    return;
  if (stopped_ || cell.halves[widest] < options_.min_angle)
  {
    result_.complete = false;
    ++result_.unresolved;
    return;
  }
  const double center = cell.centers[widest], half = cell.halves[widest];
  cell.halves[widest] = 0.5 * half;
  for (const double sign : {-1.0, 1.0})
  {
    cell.centers[widest] = center + sign * 0.5 * half;
    visit(cell);
  }
  cell.centers[widest] = center;
  cell.halves[widest] = half;
}

}  // namespace frictional_contact_sim
