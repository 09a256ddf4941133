#include "mode_cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/separation/facet_decomposition.h"
#include "mode_bounds.h"

namespace frictional_contact_sim
{
namespace
{
/// Both sides of a complementarity above this, in the units of the scaled island: worth a cut.
constexpr double VIOLATED = 1e-6;
/// What the point violates a cut by at least, over |row|.
constexpr double DEEP = 1e-7;
/// Complementarities tried at a node before it goes without a cut.
constexpr size_t ATTEMPTS = 4;

/** f(y) = row.y + constant. */
struct Affine
{
  Eigen::VectorXd row;
  double constant;

  double at(const Eigen::VectorXd& y) const { return row.dot(y) + constant; }
};

struct Pair
{
  Affine first, second;
  double violation;  ///< the smaller of both at the point
};

class Pairs
{
public:
  Pairs(const Relaxation& relaxation, const ScaledIsland& island) : relaxation_(relaxation), island_(island) {}

  void addLaw(size_t index)
  {
    const Law& law = island_.laws[index];
    const int first = island_.offsets[index];
    if (law.type == LawType::DRY_FRICTION)
    {
      add(column(first, -1.0, law.coefficient), velocity(first, -1.0));
      add(column(first, 1.0, law.coefficient), velocity(first, 1.0));
      return;
    }
    add(column(first), velocity(first));
    if (law.type != LawType::COULOMB_2D || !isFrictional(law))
      return;
    add(column(first + 1), velocity(first));
    add(column(first), velocity(first + 1));
    add(column(first + 1), velocity(first + 1, -1.0));
  }
  /** The worst first. */
  std::vector<Pair> sorted()
  {
    std::stable_sort(pairs_.begin(), pairs_.end(),
                     [](const Pair& a, const Pair& b) { return a.violation > b.violation; });
    return std::move(pairs_);
  }

private:
  Affine column(int index, double sign = 1.0, double constant = 0.0) const
  {
    return {sign * Eigen::VectorXd::Unit(relaxation_.generators().cols(), index), constant};
  }
  Affine velocity(int row, double sign = 1.0) const
  {
    return {sign * relaxation_.velocities().row(row).transpose(), sign * island_.q[row]};
  }
  void add(const Affine& first, const Affine& second)
  {
    const double violation = std::min(first.at(relaxation_.point()), second.at(relaxation_.point()));
    if (violation > VIOLATED)
      pairs_.push_back({first, second, violation});
  }

  const Relaxation& relaxation_;
  const ScaledIsland& island_;
  std::vector<Pair> pairs_;
};

/** The polyhedra of both sides, and the size of what the right-hand side of their own rows is summed from. */
struct TwoSides
{
  Disjunction sets;
  std::vector<double> sizes;
};

/** The node's relaxation in coordinates y - point of the columns that are not fixed, rows of length one. */
class LocalRelaxation
{
public:
  LocalRelaxation(const Relaxation& relaxation, double impulse_bound)
    : point_(relaxation.point()), size_(relaxation.point().size())
  {
    const Eigen::VectorXd &lower = relaxation.columnLower(), &upper = relaxation.columnUpper();
    for (Eigen::Index j = 0; j < size_; ++j)
      if (lower[j] < upper[j])
        free_.push_back(j);
      else
        point_[j] = lower[j];
    const auto n = static_cast<Eigen::Index>(free_.size());
    reach_.resize(n);
    for (Eigen::Index j = 0; j < n; ++j)
    {
      const Eigen::Index column = free_[static_cast<size_t>(j)];
      reach_[j] = std::min(impulse_bound, std::max(std::abs(lower[column]), std::abs(upper[column]))) +
                  std::abs(point_[column]);
      addRange(Eigen::VectorXd::Unit(n, j), lower[column], upper[column], point_[column], std::abs(point_[column]));
    }
    const Eigen::MatrixXd& A = relaxation.matrix();
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      addRange(restricted(A.row(i).transpose()), relaxation.rowLower()[i], relaxation.rowUpper()[i],
               A.row(i).dot(point_), A.row(i).cwiseAbs().dot(point_.cwiseAbs()));
    local_.A.resize(static_cast<Eigen::Index>(rows_.size()), n);
    local_.b.resize(local_.A.rows());
    for (Eigen::Index i = 0; i < local_.A.rows(); ++i)
    {
      local_.A.row(i) = rows_[static_cast<size_t>(i)].transpose();
      local_.b[i] = std::max(0.0, right_[static_cast<size_t>(i)]);
    }
  }

  bool empty() const { return free_.empty() || local_.A.rows() == 0; }
  TwoSides sides(const Pair& pair) const
  {
    TwoSides result = {{local_, {}}, {}};
    for (const Affine* affine : {&pair.first, &pair.second})
    {
      const Eigen::VectorXd row = restricted(affine->row);
      const double length = row.norm();
      if (!(length > 0.0))
        return {};  // the modes that are decided say the sign already
      result.sets.terms.push_back(
          {row.transpose() / length, Eigen::VectorXd::Constant(1, -affine->at(point_) / length)});
      result.sizes.push_back((affine->row.cwiseAbs().dot(point_.cwiseAbs()) + std::abs(affine->constant)) / length);
    }
    return result;
  }

  /**
   * d.(y - point) <= e in the columns of the relaxation, e the largest that the multipliers of a term leave open.
   * @return an infinite e when they prove nothing
   */
  ModeCut proved(const TwoSides& sides, const Eigen::VectorXd& direction,
                 const std::vector<Eigen::VectorXd>& multipliers) const
  {
    const double gamma =
        8.0 * std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(size_ + local_.A.rows()));
    double most = -std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < sides.sizes.size(); ++k)
    {
      const Polyhedron term = sides.sets.term(k);
      const Eigen::VectorXd u = multipliers[k].cwiseMax(0.0);
      const Eigen::VectorXd rest = direction - term.A.transpose() * u;
      const Eigen::VectorXd terms = direction.cwiseAbs() + term.A.cwiseAbs().transpose() * u;
      double size = u.dot(term.b.cwiseAbs());  // of what is summed: round-off is gamma times it
      for (size_t i = 0; i < sizes_.size(); ++i)
        size += u[static_cast<Eigen::Index>(i)] * sizes_[i];
      size += u[u.size() - 1] * sides.sizes[k];
      most = std::max(most, term.b.dot(u) + gamma * size + (rest.cwiseAbs() + gamma * terms).dot(reach_));
    }
    ModeCut cut = {Eigen::VectorXd::Zero(size_), 0.0};
    for (size_t j = 0; j < free_.size(); ++j)
      cut.row[free_[j]] = direction[static_cast<Eigen::Index>(j)];
    cut.right_hand_side = cut.row.dot(point_) + most + gamma * cut.row.cwiseAbs().dot(point_.cwiseAbs());
    return cut;
  }

  Eigen::VectorXd restricted(const Eigen::VectorXd& row) const
  {
    Eigen::VectorXd result(static_cast<Eigen::Index>(free_.size()));
    for (size_t j = 0; j < free_.size(); ++j)
      result[static_cast<Eigen::Index>(j)] = row[free_[j]];
    return result;
  }

private:
  /** lower <= row.y <= upper, `value` the row's at the point, `size` of the terms it is summed from. */
  void addRange(const Eigen::VectorXd& row, double lower, double upper, double value, double size)
  {
    const double length = row.norm();
    if (!(length > 0.0))
      return;
    for (const double sign : {1.0, -1.0})
    {
      const double bound = sign > 0.0 ? upper : -lower;
      if (!(bound < UNBOUNDED))
        continue;
      rows_.emplace_back(sign / length * row);
      right_.push_back((bound - sign * value) / length);
      sizes_.push_back((std::abs(bound) + size) / length);
    }
  }

  Eigen::VectorXd point_;
  Eigen::Index size_;
  std::vector<Eigen::Index> free_;
  Eigen::VectorXd reach_;  ///< most |y - point| of the free columns in the proofs
  std::vector<Eigen::VectorXd> rows_;
  std::vector<double> right_, sizes_;
  Polyhedron local_;
};

struct Direction
{
  Eigen::VectorXd value;
  std::vector<Eigen::VectorXd> multipliers;
};

std::vector<Direction> directions(const Disjunction& disjunction, EnumerationCuts kind)
{
  std::vector<Direction> result;
  if (kind == EnumerationCuts::MOST_VIOLATED)
  {
    const ViolatedCut cut = mostViolatedCut(disjunction, Normalisation::LIFT_AND_PROJECT);
    if (cut.found)
      result.push_back({cut.direction, cut.multipliers});
    return result;
  }
  DecompositionOptions options;
  options.bound_factor = 0.0;
  options.nearest.max_calls = 200;
  const FacetDecomposition found = decomposeDeepestCut(disjunction, options);
  Direction deepest = {Eigen::VectorXd::Zero(disjunction.dimension()), {}};
  for (const FacetCut& cut : found.cuts)
  {
    if (kind == EnumerationCuts::FACETS && !cut.is_ray)  // rays are the relaxation's own rows
      result.push_back({cut.direction, cut.multipliers});
    deepest.value += cut.weight * cut.direction;
    for (size_t k = 0; k < cut.multipliers.size(); ++k)
    {
      if (deepest.multipliers.size() <= k)
        deepest.multipliers.emplace_back(Eigen::VectorXd::Zero(cut.multipliers[k].size()));
      deepest.multipliers[k] += cut.weight * cut.multipliers[k];
    }
  }
  if (kind == EnumerationCuts::DEEPEST && !found.cuts.empty())
    result.push_back(deepest);
  return result;
}
}  // namespace

std::vector<ModeCut> modeCuts(const Relaxation& relaxation, const ScaledIsland& island, const Cell& cell,
                              const EnumerateOptions& options)
{
  Pairs pairs(relaxation, island);
  for (size_t i = 0; i < cell.modes.size(); ++i)
    if (cell.modes[i] == LawMode::UNDECIDED && relaxation.modes(static_cast<int>(i)).front() != LawMode::UNDECIDED)
      pairs.addLaw(i);
  const std::vector<Pair> violated = pairs.sorted();
  std::vector<ModeCut> cuts;
  if (violated.empty())
    return cuts;
  const LocalRelaxation local(relaxation, options.impulse_bound);
  for (size_t k = 0; k < std::min(violated.size(), ATTEMPTS) && cuts.empty() && !local.empty(); ++k)
  {
    const TwoSides sides = local.sides(violated[k]);
    if (sides.sizes.empty())
      continue;
    for (const Direction& direction : directions(sides.sets, options.cuts))
    {
      const ModeCut cut = local.proved(sides, direction.value, direction.multipliers);
      if (std::isfinite(cut.right_hand_side) &&
          cut.row.dot(relaxation.point()) - cut.right_hand_side > DEEP * cut.row.norm())
        cuts.push_back({cut.row / cut.row.norm(), cut.right_hand_side / cut.row.norm()});
    }
  }
  return cuts;
}

}  // namespace frictional_contact_sim
