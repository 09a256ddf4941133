#include "frictional_contact_sim/solver/dense_lu.h"

#include <algorithm>
#include <cmath>

namespace frictional_contact_sim
{
void DenseLu::reserve(int size)
{
  const auto count = static_cast<std::size_t>(size);
  if (values_.size() < count * count)
    values_.resize(count * count);
  if (pivots_.size() < count)
    pivots_.resize(count);
}

Eigen::Map<Eigen::MatrixXd> DenseLu::start(int size)
{
  size_ = size;
  std::fill_n(values_.begin(), static_cast<std::ptrdiff_t>(size) * size, 0.0);
  return {values_.data(), size, size};
}

/** Chooses the pivot of column k, exchanges whole rows and scales the column below it. */
bool DenseLu::eliminate(int k)
{
  double* column = values_.data() + static_cast<std::ptrdiff_t>(k) * size_;
  int pivot = k;
  for (int i = k + 1; i < size_; ++i)
    if (std::abs(column[i]) > std::abs(column[pivot]))
      pivot = i;
  pivots_[static_cast<std::size_t>(k)] = pivot;
  if (!(std::abs(column[pivot]) > 0.0) || !std::isfinite(column[pivot]))
    return false;
  if (pivot != k)
    for (double* entry = values_.data(); entry != values_.data() + static_cast<std::ptrdiff_t>(size_) * size_;
         entry += size_)
      std::swap(entry[k], entry[pivot]);
  const double inverse = 1.0 / column[k];
  for (int i = k + 1; i < size_; ++i)
    column[i] *= inverse;
  return true;
}

bool DenseLu::factor()
{
  for (int k = 0; k < size_; k += 2)
  {
    if (!eliminate(k))
      return false;
    if (k + 1 == size_)
      break;
    const double* first = values_.data() + static_cast<std::ptrdiff_t>(k) * size_;
    double* second = values_.data() + static_cast<std::ptrdiff_t>(k + 1) * size_;
    const double factor = second[k];
    for (int i = k + 1; i < size_; ++i)
      second[i] -= factor * first[i];
    if (!eliminate(k + 1))
      return false;
    for (int j = k + 2; j < size_; ++j)
    {
      double* column = values_.data() + static_cast<std::ptrdiff_t>(j) * size_;
      const double a = column[k];
      column[k + 1] -= a * first[k + 1];
      const double b = column[k + 1];
      if (a == 0.0 && b == 0.0)
        continue;
      for (int i = k + 2; i < size_; ++i)
        column[i] -= a * first[i] + b * second[i];
    }
  }
  return true;
}

void DenseLu::solve(Eigen::Ref<Eigen::VectorXd> x) const
{
  for (int k = 0; k < size_; ++k)
    std::swap(x[k], x[pivots_[static_cast<std::size_t>(k)]]);
  const Eigen::Map<const Eigen::MatrixXd> lu(values_.data(), size_, size_);
  for (int k = 0; k < size_; ++k)
  {
    const double value = x[k];
    for (int i = k + 1; i < size_; ++i)
      x[i] -= value * lu(i, k);
  }
  for (int k = size_ - 1; k >= 0; --k)
  {
    x[k] /= lu(k, k);
    const double value = x[k];
    for (int i = 0; i < k; ++i)
      x[i] -= value * lu(i, k);
  }
}

}  // namespace frictional_contact_sim
