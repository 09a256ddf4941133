#include "frictional_contact_sim/solver/least_norm.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "least_norm_dual.h"

namespace frictional_contact_sim
{
namespace
{
/// Rows whose remainder in the factor of A A^T is below this are combinations of the others. Far above the round-off of
/// W, which other rows that nearly depend on each other magnify: to look at an independent island costs time, no more.
constexpr double RANK_TOLERANCE = 1e-9;
/// The cubic test pays up to here, and where rows are so many times fewer than the velocities they touch: nodes of an
/// elastic mesh, whose search is cubic in velocities. Other islands are looked at as if they were dependent. One that
/// is not keeps its r*.
constexpr int GRAM_ROWS = 96;
constexpr size_t GRAM_VELOCITIES = 4;
/// As RANK_TOLERANCE, of the velocities that only one law touches; a stricter one, since this is only a shortcut.
constexpr double OWN_TOLERANCE = 1e-6;

void requireSize(const char* name, Eigen::Index found, Eigen::Index expected)
{
  if (found != expected)
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(found) + " entries, expected " +
                                std::to_string(expected));
}

double tangential(const double* x, int dimension)
{
  return dimension == 3 ? std::hypot(x[1], x[2]) : std::abs(x[1]);
}

/**
 * @param least pivots up to this are none, a row each: not relative to the row of W, which is round-off where bilateral
 * rows hold it
 * @return whether the matrix, rows x rows, is singular; overwritten. Whole columns are subtracted, no sum waits for
 * itself.
 */
bool isSingular(double* matrix, int rows, const double* least)
{
  for (int k = 0; k < rows; ++k)
  {
    const double* column = matrix + k * rows;
    if (!(column[k] > least[k]))
      return true;
    const double inverse = 1.0 / column[k];
    for (int j = k + 1; j < rows; ++j)
    {
      if (column[j] == 0.0)  // laws that do not meet: most, in a large island
        continue;
      const double factor = inverse * column[j];
      double* other = matrix + j * rows;
      for (int i = j; i < rows; ++i)
        other[i] -= factor * column[i];
    }
  }
  return false;
}
}  // namespace

LeastNorm::LeastNorm() : dual_(std::make_unique<DualIsland>()), reduction_(std::make_unique<DelassusReduction>())
{
}

LeastNorm::~LeastNorm() = default;

bool LeastNorm::makeMember(const Law& law, const double* u, const double* r, double threshold, Member& member)
{
  member.dimension = law.dimension();
  member.rows = 1;
  member.bound = law.coefficient;
  member.direction[0] = 1.0;
  member.direction[1] = member.direction[2] = 0.0;
  member.kind = law.type == LawType::DRY_FRICTION ? DualSet::INTERVAL : DualSet::HALF_LINE;
  if (!law.isCoulomb())
    return law.type == LawType::DRY_FRICTION ? std::abs(*u) <= threshold && law.coefficient > 0.0
                                             : law.type == LawType::UNILATERAL && *u <= threshold;
  if (!(u[0] <= threshold))
    return false;
  if (law.coefficient == 0.0)
    return true;
  if (tangential(u, member.dimension) <= threshold)
  {
    member.kind = DualSet::CONE;
    member.rows = member.dimension;
    return true;
  }
  double square = 0.0;
  for (int k = 0; k < member.dimension; ++k)
    square += r[k] * r[k];
  if (!(square > 0.0))
    return false;
  for (int k = 0; k < member.dimension; ++k)
    member.direction[k] = r[k] / std::sqrt(square);
  return true;
}

/** The laws whose impulses may change. */
void LeastNorm::classify(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds, const Solution& solution)
{
  members_.clear();
  int row = 0;
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    Member member;
    member.law = static_cast<int>(i);
    member.row = row;
    if (makeMember(problem.laws[i], solution.u.data() + row, solution.r.data() + row,
                   thresholds[static_cast<Eigen::Index>(i)], member))
      members_.push_back(member);
    row += problem.laws[i].dimension();
  }
}

/** Members island by island, each in ascending order, by their first member. */
void LeastNorm::findIslands(const DelassusReduction& reduction, int velocities)
{
  const int count = static_cast<int>(members_.size());
  sets_.reset(count);
  toucher_.assign(static_cast<size_t>(velocities), -1);
  shared_.assign(static_cast<size_t>(velocities), 0);
  int islands = count;
  for (int i = 0; i < count; ++i)
  {
    const int law = members_[static_cast<size_t>(i)].law;
    for (const int* column = reduction.halfRowBegin(law); column != reduction.halfRowEnd(law); ++column)
    {
      int& toucher = toucher_[static_cast<size_t>(*column)];
      if (toucher < 0)
      {
        toucher = i;
        continue;
      }
      shared_[static_cast<size_t>(*column)] = 1;
      if (islands > 1)
        islands -= sets_.unite(i, toucher) ? 1 : 0;
    }
  }
  begin_.assign(static_cast<size_t>(islands) + 1, 0);
  order_.resize(members_.size());
  if (islands <= 1)
  {
    std::iota(order_.begin(), order_.end(), 0);
    begin_.back() = count;
    return;
  }
  island_of_member_.resize(members_.size());
  int next = 0;
  for (int i = 0; i < count; ++i)
  {
    const int first = sets_.root(i);
    const int island = first == i ? next++ : island_of_member_[static_cast<size_t>(first)];
    island_of_member_[static_cast<size_t>(i)] = island;
    ++begin_[static_cast<size_t>(island) + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  for (int i = 0; i < count; ++i)
    order_[static_cast<size_t>(begin_[static_cast<size_t>(island_of_member_[static_cast<size_t>(i)])]++)] = i;
  std::copy_backward(begin_.begin(), begin_.end() - 1, begin_.end());
  begin_[0] = 0;
}

/** Entries of x that the island touches, ascending; place_ says where. */
void LeastNorm::findVelocities(const DelassusReduction& reduction, size_t first, size_t last)
{
  used_.clear();
  for (size_t k = first; k < last; ++k)
  {
    const int law = member(k).law;
    for (const int* column = reduction.halfRowBegin(law); column != reduction.halfRowEnd(law); ++column)
      if (place_[static_cast<size_t>(*column)] < 0)
      {
        place_[static_cast<size_t>(*column)] = 0;
        used_.push_back(*column);
      }
  }
  std::sort(used_.begin(), used_.end());
  for (size_t k = 0; k < used_.size(); ++k)
    place_[static_cast<size_t>(used_[k])] = static_cast<int>(k);
}

void LeastNorm::forgetVelocities()
{
  for (const int column : used_)
    place_[static_cast<size_t>(column)] = -1;
}

/** Whether the cubic test of an island pays. @param rows of it that do not stand alone */
bool LeastNorm::isCheap(const DelassusReduction& reduction, size_t first, size_t last, int rows)
{
  if (rows <= GRAM_ROWS)
    return true;
  findVelocities(reduction, first, last);
  forgetVelocities();
  return GRAM_VELOCITIES * static_cast<size_t>(rows) <= used_.size();
}

/**
 * Whether the velocities that no other law touches (the joints of one's own leg) make its rows independent of all
 * others: a combination of rows that vanishes has no share of it.
 */
bool LeastNorm::standsAlone(const DelassusReduction& reduction, const Member& mine) const
{
  double gram[9] = {};
  const double* value = reduction.halfRowValues(mine.law);
  for (const int* column = reduction.halfRowBegin(mine.law); column != reduction.halfRowEnd(mine.law);
       ++column, value += mine.dimension)
  {
    if (shared_[static_cast<size_t>(*column)] != 0)
      continue;
    double scaled[3] = {};
    contract(mine, value, 1, scaled);
    for (int a = 0; a < mine.rows; ++a)
      for (int b = a; b < mine.rows; ++b)
        gram[a * mine.rows + b] += scaled[a] * scaled[b];
  }
  const double least = OWN_TOLERANCE / reduction.stepLengths()[mine.law];
  const double bounds[3] = {least, least, least};
  return !isSingular(gram, mine.rows, bounds);
}

/** One value for every degree of freedom of the member's impulse, from one for every row. */
void LeastNorm::contract(const Member& mine, const double* value, int stride, double* result)
{
  if (mine.rows == mine.dimension)
  {
    for (int c = 0; c < mine.dimension; ++c)
      result[c] = value[c * stride];
    return;
  }
  *result = 0.0;
  for (int c = 0; c < mine.dimension; ++c)
    *result += value[c * stride] * mine.direction[c];
}

/** gram_ = the rows of W of the members kept, contracted to the rays of sliding contacts. */
void LeastNorm::fillGram(const DelassusReduction& reduction, int rows)
{
  const DelassusOperator& W = reduction.problem().W;
  gram_.assign(static_cast<size_t>(rows) * static_cast<size_t>(rows), 0.0);
  int row = 0;
  for (const int k : kept_)
  {
    const Member& mine = members_[static_cast<size_t>(k)];
    law_member_[static_cast<size_t>(mine.law)] = k;
    law_row_[static_cast<size_t>(mine.law)] = row;
    row += mine.rows;
  }
  for (const int k : kept_)
  {
    const Member& mine = members_[static_cast<size_t>(k)];
    double* target = gram_.data() + law_row_[static_cast<size_t>(mine.law)] * rows;
    W.visitRow(mine.law,
               [&](int column, const double* value, int stride)
               {
                 const auto law = static_cast<size_t>(W.blockOf(column));
                 if (law_member_[law] < 0)
                   return;
                 const Member& other = members_[static_cast<size_t>(law_member_[law])];
                 const int offset = column - other.row;
                 const bool full = other.rows == other.dimension;
                 double entry[3];
                 contract(mine, value, stride, entry);
                 for (int a = 0; a < mine.rows; ++a)
                   target[a * rows + law_row_[law] + (full ? offset : 0)] +=
                       full ? entry[a] : entry[a] * other.direction[offset];
               });
  }
  for (const int k : kept_)
    law_member_[static_cast<size_t>(members_[static_cast<size_t>(k)].law)] = -1;
}

bool LeastNorm::isDependent(const DelassusReduction& reduction, size_t first, size_t last)
{
  kept_.clear();
  int rows = 0;
  for (size_t k = first; k < last; ++k)
    if (!standsAlone(reduction, member(k)))
    {
      kept_.push_back(order_[k]);
      rows += member(k).rows;
    }
  if (kept_.empty())
    return false;
  if (reduction.problem().W.isMatrixFree() || !isCheap(reduction, first, last, rows))
    return true;
  fillGram(reduction, rows);
  size_t row = gram_.size();
  gram_.resize(row + static_cast<size_t>(rows));  // least pivots behind it
  for (const int k : kept_)
    for (int a = 0; a < members_[static_cast<size_t>(k)].rows; ++a)
      gram_[row++] = RANK_TOLERANCE / reduction.stepLengths()[members_[static_cast<size_t>(k)].law];
  return isSingular(gram_.data(), rows, gram_.data() + static_cast<size_t>(rows) * static_cast<size_t>(rows));
}

/** The island in scaled impulses. */
void LeastNorm::gather(const DelassusReduction& reduction, size_t first, size_t last, const Solution& solution)
{
  dual_->clear(static_cast<int>(used_.size()));
  for (size_t k = first; k < last; ++k)
  {
    const Member& mine = member(k);
    const double root = std::sqrt(reduction.stepLengths()[mine.law]);
    dual_->addSet(mine.kind, mine.rows, mine.kind == DualSet::INTERVAL ? mine.bound / root : mine.bound);
    const double* value = reduction.halfRowValues(mine.law);
    for (const int* column = reduction.halfRowBegin(mine.law); column != reduction.halfRowEnd(mine.law);
         ++column, value += mine.dimension)
    {
      double scaled[3];
      contract(mine, value, 1, scaled);
      for (int c = 0; c < mine.rows; ++c)
        scaled[c] *= root;
      dual_->addColumn(place_[static_cast<size_t>(*column)], scaled);
    }
    double impulse[3];
    contract(mine, solution.r.data() + mine.row, 1, impulse);
    for (int c = 0; c < mine.rows; ++c)
      impulse[c] /= root;
    dual_->setImpulse(impulse);
  }
}

void LeastNorm::scatter(const DelassusReduction& reduction, size_t first, size_t last, Solution& solution) const
{
  for (size_t k = first; k < last; ++k)
  {
    const Member& mine = member(k);
    const double root = std::sqrt(reduction.stepLengths()[mine.law]);
    const double* s = dual_->impulse(k - first);
    const bool ray = mine.rows < mine.dimension;
    // What is not along the ray (a frictionless contact's tangential round-off) is part of the force that is kept.
    for (int c = 0; c < mine.dimension; ++c)
      if (!ray || mine.direction[c] != 0.0)
        solution.r[mine.row + c] = root * (ray ? *s * mine.direction[c] : s[c]);
  }
}

void LeastNorm::improveIsland(const DelassusReduction& reduction, size_t first, size_t last, Solution& solution,
                              Report& report)
{
  if (!isDependent(reduction, first, last))
    return;
  findVelocities(reduction, first, last);
  int rows = 0;
  for (size_t k = first; k < last; ++k)
    rows += member(k).rows;
  ++report.dependent_islands;
  gather(reduction, first, last, solution);
  const bool exact = rows <= EXACT_ROWS;
  const DualIsland::Outcome outcome = dual_->solve(exact);
  report.iterations += dual_->iterations();
  report.inexact_islands += exact && !dual_->isOptimal() ? 1 : 0;
  if (outcome == DualIsland::Outcome::CHANGED)
  {
    ++report.changed_islands;
    report.largest_ratio = std::max(report.largest_ratio, dual_->ratio());
    scatter(reduction, first, last, solution);
    for (const int column : used_)
      changed_[static_cast<size_t>(column)] = 1;
  }
  forgetVelocities();
}

/** lambda of the changed islands; that of the others keeps its bits. */
void LeastNorm::recoverMultipliers(const IncrementalProblem& problem, DelassusReduction& reduction, Solution& solution)
{
  if (problem.bilaterals() == 0)
    return;
  lambda_ = solution.lambda;
  reduction.recoverMultipliers(problem, solution);
  for (int row = 0; row < problem.bilaterals(); ++row)
  {
    bool changed = false;
    for (SparseRows::InnerIterator entry(problem.G, row); entry; ++entry)
      changed = changed || changed_[static_cast<size_t>(reduction.permuted(static_cast<int>(entry.col())))] != 0;
    if (!changed)
      solution.lambda[row] = lambda_[row];
  }
}

LeastNorm::Report LeastNorm::improve(const IncrementalProblem& problem, DelassusReduction& reduction,
                                     const Eigen::VectorXd& thresholds, Solution& solution)
{
  requireSize("thresholds", thresholds.size(), static_cast<Eigen::Index>(problem.laws.size()));
  requireSize("solution.r", solution.r.size(), problem.rows());
  requireSize("solution.u", solution.u.size(), problem.rows());
  requireSize("solution.lambda", solution.lambda.size(), problem.bilaterals());
  Report report;
  classify(problem, thresholds, solution);
  if (members_.empty() || !solution.r.allFinite())
    return report;
  findIslands(reduction, problem.velocities());
  place_.assign(static_cast<size_t>(problem.velocities()), -1);
  changed_.assign(static_cast<size_t>(problem.velocities()), 0);
  law_member_.assign(problem.laws.size(), -1);
  law_row_.resize(problem.laws.size());
  for (size_t island = 0; island + 1 < begin_.size(); ++island)
    improveIsland(reduction, static_cast<size_t>(begin_[island]), static_cast<size_t>(begin_[island + 1]), solution,
                  report);
  if (report.changed_islands > 0)
    recoverMultipliers(problem, reduction, solution);
  return report;
}

LeastNorm::Report LeastNorm::improve(const IncrementalProblem& problem, const Eigen::VectorXd& thresholds,
                                     Solution& solution)
{
  reduction_->compute(problem);
  return improve(problem, *reduction_, thresholds, solution);
}

}  // namespace frictional_contact_sim
