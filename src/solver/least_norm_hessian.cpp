// The Hessian of solver/least_norm_dual.h: A^T (dP) A, dense or sparse.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "frictional_contact_sim/math/cone.h"
#include "least_norm_dual.h"

namespace frictional_contact_sim
{
namespace
{
/// Beyond so many velocities a Hessian with fewer entries than this share is kept sparse.
constexpr int DENSE_VELOCITIES = 64;
constexpr double DENSE_SHARE = 0.3;

/// H += A_i^T D A_i, given by add(entry of the lower triangle's pair (p, q), value); q <= p of the set's columns.
template <int D, typename Add>
void addBlock(const DualSet& set, const double* values, const SquareMatrix<D>& derivative, bool whole, Add add)
{
  const auto count = static_cast<int>(set.column_count);
  for (int p = 0; p < count; ++p)
  {
    const Vector<D> a = Eigen::Map<const Vector<D>>(values + p * D);
    const Vector<D> left = whole ? a : Vector<D>(derivative * a);
    for (int q = 0; q <= p; ++q)
      add(p, q, left.dot(Eigen::Map<const Vector<D>>(values + q * D)));
  }
}
}  // namespace

template <typename Add>
void DualIsland::addHessian(bool whole, Add add) const
{
  for (const DualSet& set : sets_)
  {
    const double* t = t_.data() + set.first_row;
    const double* values = values_.data() + set.values;
    const auto addPair = [&](int p, int q, double value) { add(set, p, q, value); };
    if (set.kind == DualSet::CONE && set.rows == 3)
    {
      SquareMatrix<3> derivative;
      const bool inside = whole || inCone<3>(Eigen::Map<const Vector<3>>(t), set.bound);
      if (!inside)
        derivative = coneProjectionJacobian<3>(Eigen::Map<const Vector<3>>(t), set.bound);
      if (inside || !derivative.isZero(0.0))
        addBlock<3>(set, values, derivative, inside, addPair);
    }
    else if (set.kind == DualSet::CONE)
    {
      const SquareMatrix<2> derivative = coneProjectionJacobian<2>(Eigen::Map<const Vector<2>>(t), set.bound);
      if (whole || !derivative.isZero(0.0))
        addBlock<2>(set, values, derivative, whole, addPair);
    }
    else if (whole || (set.kind == DualSet::HALF_LINE ? *t > 0.0 : std::abs(*t) < set.bound))
      addBlock<1>(set, values, SquareMatrix<1>::Identity(), true, addPair);
  }
}

bool DualIsland::useSparse() const
{
  if (n_ <= DENSE_VELOCITIES)
    return false;
  // An upper bound of the entries, without fill.
  double entries = 0.0;
  for (const DualSet& set : sets_)
    entries += static_cast<double>(set.column_count) * static_cast<double>(set.column_count);
  return entries < DENSE_SHARE * n_ * n_;
}

/** Lays matrix_ out for the columns of the sets, unless it is so already. */
void DualIsland::prepareSparse()
{
  bool same = pattern_columns_ == columns_ && pattern_ends_.size() == sets_.size() + 1 &&
              pattern_ends_.back() == static_cast<size_t>(n_);
  for (size_t i = 0; same && i < sets_.size(); ++i)
    same = pattern_ends_[i] == sets_[i].columns + sets_[i].column_count;
  if (same)
    return;
  pattern_columns_ = columns_;
  pattern_ends_.clear();
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < n_; ++k)
    entries.emplace_back(k, k, 1.0);
  for (const DualSet& set : sets_)
  {
    pattern_ends_.push_back(set.columns + set.column_count);
    for (size_t p = set.columns; p < pattern_ends_.back(); ++p)
      for (size_t q = set.columns; q < pattern_ends_.back(); ++q)
        entries.emplace_back(columns_[p], columns_[q], 1.0);
  }
  pattern_ends_.push_back(static_cast<size_t>(n_));
  matrix_.resize(n_, n_);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  matrix_.makeCompressed();
  const auto find = [this](int row, int column)
  {
    const int* begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[row];
    const int* end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[row + 1];
    return static_cast<int>(std::lower_bound(begin, end, column) - matrix_.innerIndexPtr());
  };
  position_.clear();
  for (const DualSet& set : sets_)
    for (size_t p = set.columns; p < set.columns + set.column_count; ++p)
      for (size_t q = set.columns; q <= p; ++q)
      {
        position_.push_back(find(columns_[p], columns_[q]));
        position_.push_back(find(columns_[q], columns_[p]));
      }
  diagonal_.resize(static_cast<size_t>(n_));
  for (int k = 0; k < n_; ++k)
    diagonal_[static_cast<size_t>(k)] = find(k, k);
}

/**
 * Factors the Hessian, or A^T A (whole; sets scale_ too), plus shift times scale_ on the diagonal.
 * @return false when it is not positive definite
 */
bool DualIsland::factorHessian(bool whole, double shift)
{
  if (!sparse_)
  {
    hessian_.assign(static_cast<size_t>(n_) * static_cast<size_t>(n_), 0.0);
    addHessian(whole,
               [this](const DualSet& set, int p, int q, double value)
               {
                 const int* column = columns_.data() + set.columns;
                 hessian_[static_cast<size_t>(column[p] + column[q] * n_)] += value;
               });
    Eigen::Map<Eigen::MatrixXd> map(hessian_.data(), n_, n_);
    if (whole)
      scale_ = map.diagonal().maxCoeff();
    map.diagonal().array() += shift * scale_;
    Eigen::Ref<Eigen::MatrixXd> matrix(map);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
    return factor.info() == Eigen::Success;
  }
  double* values = matrix_.valuePtr();
  std::fill(values, values + matrix_.nonZeros(), 0.0);
  const DualSet* last = nullptr;
  size_t base = 0;
  addHessian(whole,
             [&](const DualSet& set, int p, int q, double value)
             {
               if (last != &set)
               {
                 // Sets without a derivative are passed over.
                 for (const DualSet* skipped = last == nullptr ? sets_.data() : last; skipped != &set; ++skipped)
                   base += skipped->column_count * (skipped->column_count + 1);
                 last = &set;
               }
               const size_t pair = base + static_cast<size_t>(p * (p + 1) + 2 * q);
               values[position_[pair]] += value;
               if (p != q)
                 values[position_[pair + 1]] += value;
             });
  if (whole)
    scale_ = 0.0;
  for (const int k : diagonal_)
    scale_ = whole ? std::max(scale_, values[k]) : scale_;
  for (const int k : diagonal_)
    values[k] += shift * scale_;
  try
  {
    factor_.compute(matrix_);
  }
  catch (const std::invalid_argument&)
  {
    return false;
  }
  return true;
}

void DualIsland::solveHessian(const std::vector<double>& right, std::vector<double>& x)
{
  x = right;
  Eigen::Map<Eigen::VectorXd> solution(x.data(), n_);
  if (!sparse_)
  {
    const Eigen::Map<const Eigen::MatrixXd> factor(hessian_.data(), n_, n_);
    factor.triangularView<Eigen::Lower>().solveInPlace(solution);
    factor.triangularView<Eigen::Lower>().transpose().solveInPlace(solution);
    return;
  }
  right_ = solution;
  factor_.halfSolve(right_, half_);
  factor_.transposedHalfSolve(half_, solution_);
  solution = solution_;
}

}  // namespace frictional_contact_sim
