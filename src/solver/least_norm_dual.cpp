#include "least_norm_dual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frictional_contact_sim/math/cone.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double EPSILON = std::numeric_limits<double>::epsilon();
constexpr int MAX_ITERATIONS = 50;
constexpr int MAX_HALVINGS = 40;
/// The Hessian's shift over its largest diagonal entry: at least round-off, and proportional to the defect far away,
/// where faces that carry nothing yet leave it singular; vanishing with the defect it keeps convergence quadratic.
constexpr double LEAST_SHIFT = 1e-13;
constexpr double SHIFT = 1e-3;
constexpr double ARMIJO = 1e-4;
/// Of the generalized force [-].
constexpr double FORCE_TOLERANCE = 1e-12;
/// s* this near to the answer, relative to its largest entry, is the answer.
constexpr double OLD_TOLERANCE = 1e-11;
/// A search that ends in round-off has done its work with this much of the generalized force left [-].
constexpr double ENOUGH = 1e-13;
/// With less of the better s in the mix nothing is gained.
constexpr double LEAST_SHARE = 1e-3;
constexpr int REFINEMENTS = 10;
double norm(const std::vector<double>& x)
{
  double sum = 0.0;
  for (const double value : x)
    sum += value * value;
  return std::sqrt(sum);
}

template <int D>
void projectCone(const double* t, double mu, double* s)
{
  Eigen::Map<Vector<D>> result(s);
  result = projectOntoCone<D>(Eigen::Map<const Vector<D>>(t), mu);
}

void projectOntoSet(const DualSet& set, const double* t, double* s)
{
  if (set.kind == DualSet::CONE)
    set.rows == 3 ? projectCone<3>(t, set.bound, s) : projectCone<2>(t, set.bound, s);
  else
    *s = set.kind == DualSet::HALF_LINE ? std::max(*t, 0.0) : std::clamp(*t, -set.bound, set.bound);
}

}  // namespace

void DualIsland::clear(int velocities)
{
  n_ = velocities;
  m_ = 0;
  iterations_ = 0;
  sets_.clear();
  columns_.clear();
  values_.clear();
  s_star_.clear();
}

DualSet& DualIsland::addSet(int kind, int rows, double bound)
{
  DualSet set;
  set.kind = kind;
  set.rows = rows;
  set.bound = bound;
  set.first_row = m_;
  set.columns = columns_.size();
  set.values = values_.size();
  m_ += rows;
  sets_.push_back(set);
  return sets_.back();
}

void DualIsland::addColumn(int column, const double* values)
{
  columns_.push_back(column);
  values_.insert(values_.end(), values, values + sets_.back().rows);
  ++sets_.back().column_count;
}

void DualIsland::setImpulse(const double* impulse)
{
  s_star_.insert(s_star_.end(), impulse, impulse + sets_.back().rows);
}

double DualIsland::ratio() const
{
  const double length = norm(s_);
  return length > 0.0 ? norm(s_star_) / length : 1.0;
}

/** t = A y */
void DualIsland::multiply(const std::vector<double>& y, std::vector<double>& t) const
{
  for (const DualSet& set : sets_)
  {
    double sum[3] = {0.0, 0.0, 0.0};
    const double* value = values_.data() + set.values;
    for (size_t k = set.columns; k < set.columns + set.column_count; ++k)
      for (int row = 0; row < set.rows; ++row)
        sum[row] += *value++ * y[static_cast<size_t>(columns_[k])];
    std::copy(sum, sum + set.rows, t.begin() + set.first_row);
  }
}

/** gap = b - A^T s */
void DualIsland::defect(const std::vector<double>& s, std::vector<double>& gap) const
{
  gap = b_;
  for (const DualSet& set : sets_)
  {
    const double* value = values_.data() + set.values;
    const double* impulse = s.data() + set.first_row;
    for (size_t k = set.columns; k < set.columns + set.column_count; ++k)
    {
      double sum = 0.0;
      for (int row = 0; row < set.rows; ++row)
        sum += *value++ * impulse[row];
      gap[static_cast<size_t>(columns_[k])] -= sum;
    }
  }
}

void DualIsland::project()
{
  for (const DualSet& set : sets_)
    projectOntoSet(set, t_.data() + set.first_row, s_.data() + set.first_row);
}

/** Sets t, s, gap and its norm, and g, for y. */
void DualIsland::evaluate(const std::vector<double>& y)
{
  multiply(y, t_);
  project();
  defect(s_, gap_);
  gap_norm_ = norm(gap_);
  double value = 0.0;
  for (size_t k = 0; k < y.size(); ++k)
    value += b_[k] * y[k];
  for (size_t k = 0; k < s_.size(); ++k)
    value -= s_[k] * (t_[k] - 0.5 * s_[k]);
  value_ = value;
  best_value_ = std::max(best_value_, value);
}

/** Norm of what is lost in b - A^T s [the unit of s]. */
double DualIsland::roundOff() const
{
  return 4.0 * EPSILON * (load_ + norm(s_) + norm(s_star_));
}

/** From y along step_: y, t, s, gap of the point found. @return false: there is none, all is as before */
bool DualIsland::search(double slope)
{
  const double gap = gap_norm_, value = value_;
  double length = 1.0;
  for (int k = 0; k < MAX_HALVINGS; ++k, length *= 0.5)
  {
    for (size_t i = 0; i < y_.size(); ++i)
      trial_[i] = y_[i] + length * step_[i];
    evaluate(trial_);
    // Near the optimum g is round-off, the defect is not; it is half of what it was soon enough.
    if (value_ >= value + ARMIJO * length * slope || gap_norm_ <= 0.5 * gap)
    {
      y_.swap(trial_);
      return true;
    }
  }
  evaluate(y_);
  return false;
}

/** Semismooth Newton from y; evaluate(y) was called. @return whether the defect is round-off */
bool DualIsland::newton()
{
  while (gap_norm_ > roundOff() && iterations_ < MAX_ITERATIONS)
  {
    const double shift = std::max(LEAST_SHIFT, SHIFT * std::min(1.0, gap_norm_ / load_));
    ++iterations_;
    if (!factorHessian(false, shift))
      return false;
    solveHessian(gap_, step_);
    double slope = 0.0;
    for (size_t i = 0; i < step_.size(); ++i)
      slope += step_[i] * gap_[i];
    if (!std::isfinite(slope) || !search(slope))
      break;
  }
  return gap_norm_ <= ENOUGH * load_ + 4.0 * roundOff();
}

bool DualIsland::isOld() const
{
  double largest = 0.0, farthest = 0.0;
  for (size_t k = 0; k < s_.size(); ++k)
  {
    largest = std::max(largest, std::abs(s_star_[k]));
    farthest = std::max(farthest, std::abs(s_star_[k] - s_[k]));
  }
  return farthest <= OLD_TOLERANCE * largest;
}

/** Takes the defect out of s, in turn by the shortest change of s and by projection. */
void DualIsland::refine()
{
  best_s_ = s_;
  double best = gap_norm_;
  if (!factorHessian(true, LEAST_SHIFT))
    return;
  for (int k = 0; k < REFINEMENTS && gap_norm_ > roundOff(); ++k)
  {
    solveHessian(gap_, step_);
    multiply(step_, t_);
    for (size_t i = 0; i < s_.size(); ++i)
      t_[i] += s_[i];
    project();
    defect(s_, gap_);
    gap_norm_ = norm(gap_);
    if (gap_norm_ < best)
    {
      best = gap_norm_;
      best_s_ = s_;
    }
  }
  s_ = best_s_;
  gap_norm_ = best;
}

/** Mixes s with s* where its defect asks for it. @return whether s is worth having */
bool DualIsland::accept()
{
  const double allowed = FORCE_TOLERANCE * load_ + 4.0 * roundOff();
  if (!std::isfinite(gap_norm_))
    return false;
  if (gap_norm_ > allowed)
  {
    const double share = allowed / gap_norm_;
    if (share < LEAST_SHARE)
      return false;
    optimal_ = false;
    for (size_t k = 0; k < s_.size(); ++k)
      s_[k] = s_star_[k] + share * (s_[k] - s_star_[k]);
  }
  // Near the optimum the norm is flat: what differs in the ninth digit is as long, up to round-off.
  return norm(s_) < (optimal_ ? 1.0 + 16.0 * EPSILON : 1.0) * norm(s_star_);
}

/** y of the least-norm s without laws; where that is within the laws it is the answer. */
bool DualIsland::start()
{
  sparse_ = useSparse();
  if (sparse_)
    prepareSparse();
  if (!factorHessian(true, LEAST_SHIFT))
    return false;
  solveHessian(b_, y_);
  best_value_ = 0.0;
  evaluate(y_);
  return true;
}

DualIsland::Outcome DualIsland::solve(bool exact)
{
  const auto n = static_cast<size_t>(n_), m = static_cast<size_t>(m_);
  for (std::vector<double>* vector : {&y_, &step_, &trial_, &gap_})
    vector->resize(n);
  t_.resize(m);
  s_ = s_star_;
  b_.assign(n, 0.0);
  defect(s_star_, gap_);
  for (size_t k = 0; k < n; ++k)
    b_[k] = -gap_[k];
  load_ = norm(b_);
  const double length = norm(s_star_);
  optimal_ = length == 0.0;
  if (optimal_)
    return Outcome::AS_IT_WAS;
  if (load_ <= roundOff())
  {
    // Nothing but self-stress.
    optimal_ = true;
    s_.assign(m, 0.0);
    return Outcome::CHANGED;
  }
  if (start())
  {
    const auto nearEnough = [&] { return !exact && length * length <= 4.0 * best_value_; };
    optimal_ = !nearEnough() && newton();
    if (!nearEnough() && !isOld())
    {
      if (!optimal_)
        refine();
      if (accept())
        return Outcome::CHANGED;
      optimal_ = false;
    }
  }
  s_ = s_star_;
  return Outcome::AS_IT_WAS;
}

}  // namespace frictional_contact_sim
