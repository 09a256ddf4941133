#include "frictional_contact_sim/solver/dense_lu.h"

#include <algorithm>
#include <cmath>

#include "frictional_contact_sim/math/vector_clones.h"

namespace frictional_contact_sim
{
namespace
{
/**
 * Chooses the pivot of column k, exchanges whole rows and scales the column below it. The diagonal keeps the pivots'
 * reciprocals: a substitution then divides by nothing.
 */
inline bool eliminate(double* values, int size, int k, int& pivot)
{
  double* column = values + static_cast<std::ptrdiff_t>(k) * size;
  pivot = k;
  for (int i = k + 1; i < size; ++i)
    if (std::abs(column[i]) > std::abs(column[pivot]))
      pivot = i;
  const double inverse = 1.0 / column[pivot];
  if (!std::isfinite(inverse) || !std::isfinite(column[pivot]))
    return false;
  if (pivot != k)
    for (double* entry = values; entry != values + static_cast<std::ptrdiff_t>(size) * size; entry += size)
      std::swap(entry[k], entry[pivot]);
  for (int i = k + 1; i < size; ++i)
    column[i] *= inverse;
  column[k] = inverse;
  return true;
}

/** Two columns at a time: the rest of the matrix is read and written half as often. */
VECTOR_CLONES bool factorColumns(double* values, int* pivots, int size)
{
  for (int k = 0; k < size; k += 2)
  {
    if (!eliminate(values, size, k, pivots[k]))
      return false;
    if (k + 1 == size)
      break;
    const double* first = values + static_cast<std::ptrdiff_t>(k) * size;
    double* second = values + static_cast<std::ptrdiff_t>(k + 1) * size;
    const double factor = second[k];
    for (int i = k + 1; i < size; ++i)
      second[i] -= factor * first[i];
    if (!eliminate(values, size, k + 1, pivots[k + 1]))
      return false;
    for (int j = k + 2; j < size; ++j)
    {
      double* column = values + static_cast<std::ptrdiff_t>(j) * size;
      const double a = column[k];
      column[k + 1] -= a * first[k + 1];
      const double b = column[k + 1];
      if (a == 0.0 && b == 0.0)
        continue;
      for (int i = k + 2; i < size; ++i)
        column[i] -= a * first[i] + b * second[i];
    }
  }
  return true;
}

VECTOR_CLONES void substitute(const double* values, const int* pivots, int size, double* x)
{
  for (int k = 0; k < size; ++k)
    std::swap(x[k], x[pivots[k]]);
  const double* column = values;
  for (int k = 0; k < size; ++k, column += size)
  {
    const double value = x[k];
    for (int i = k + 1; i < size; ++i)
      x[i] -= value * column[i];
  }
  for (int k = size - 1; k >= 0; --k)
  {
    column -= size;
    x[k] *= column[k];
    const double value = x[k];
    for (int i = 0; i < k; ++i)
      x[i] -= value * column[i];
  }
}
}  // namespace

void DenseLu::reserve(int size)
{
  const auto count = static_cast<size_t>(size);
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

bool DenseLu::factor()
{
  return factorColumns(values_.data(), pivots_.data(), size_);
}

void DenseLu::solve(Eigen::Ref<Eigen::VectorXd> x) const
{
  substitute(values_.data(), pivots_.data(), size_, x.data());
}

}  // namespace frictional_contact_sim
