#include "frictional_contact_sim/problem/mass_factor.h"

#include <suitesparse/amd.h>
// LDL's header forgets to say that it is C.
extern "C"
{
#include <suitesparse/ldl.h>
}

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
bool MassFactor::samePattern(const SparseRows& M) const
{
  const auto size = static_cast<size_t>(M.rows());
  const auto entries = static_cast<size_t>(M.nonZeros());
  return outer_.size() == size + 1 && inner_.size() == entries &&
         std::equal(outer_.begin(), outer_.end(), M.outerIndexPtr()) &&
         std::equal(inner_.begin(), inner_.end(), M.innerIndexPtr());
}

void MassFactor::analyse(const SparseRows& M)
{
  const int size = static_cast<int>(M.rows());
  const auto count = static_cast<size_t>(size);
  outer_.assign(M.outerIndexPtr(), M.outerIndexPtr() + size + 1);
  inner_.assign(M.innerIndexPtr(), M.innerIndexPtr() + M.nonZeros());
  for (std::vector<int>* array : {&permutation_, &inverse_permutation_, &parent_, &counts_, &flags_, &pattern_})
    array->assign(count, 0);
  column_begin_.assign(count + 1, 0);
  inverse_root_pivots_.resize(size);
  permuted_.resize(size);
  if (size == 0)
    return;
  // M is symmetric with both triangles stored, so its compressed rows are its compressed columns.
  if (amd_order(size, outer_.data(), inner_.data(), permutation_.data(), nullptr, nullptr) < AMD_OK)
    throw std::invalid_argument("M: pattern is not a valid compressed matrix");
  const auto symbolic = [&]
  {
    ldl_symbolic(size, outer_.data(), inner_.data(), column_begin_.data(), parent_.data(), counts_.data(),
                 flags_.data(), permutation_.data(), inverse_permutation_.data());
    return column_begin_[count];
  };
  // A tree numbered from its root has no fill when eliminated from its leaves; AMD, approximate, may miss that.
  const int amd_fill = symbolic();
  const std::vector<int> amd_permutation = permutation_;
  for (size_t k = 0; k < count; ++k)
    permutation_[k] = size - 1 - static_cast<int>(k);
  if (symbolic() > amd_fill)
  {
    permutation_ = amd_permutation;
    symbolic();
  }
  const auto fill = static_cast<size_t>(column_begin_[count]);
  row_indices_.resize(fill);
  values_.resize(fill);
  pivots_.resize(count);
  work_.assign(count, 0.0);
  root_.resize(count);
  for (size_t k = count; k-- > 0;)
    root_[k] = parent_[k] < 0 ? static_cast<int>(k) : root_[static_cast<size_t>(parent_[k])];
  factored_.clear();
  changed_.assign(count, 1);
}

void MassFactor::findChanges(const SparseRows& M)
{
  const double* const values = M.valuePtr();
  const auto differs = [&](int begin, int end)
  {
    return std::memcmp(values + begin, factored_.data() + begin, sizeof(double) * static_cast<size_t>(end - begin)) !=
           0;
  };
  if (!factored_.empty())  // else all have changed: analyse()
  {
    std::fill(changed_.begin(), changed_.end(), 0);
    if (!differs(0, static_cast<int>(M.nonZeros())))
      return;
    for (size_t row = 0; row < root_.size(); ++row)
      if (differs(outer_[row], outer_[row + 1]))
        changed_[static_cast<size_t>(root_[static_cast<size_t>(inverse_permutation_[row])])] = 1;
  }
  factored_.assign(values, values + M.nonZeros());
}

void MassFactor::factorRow(int k)
{
  // Pattern of row k of L in topological order: paths of the elimination tree from the entries of M.
  const auto size = static_cast<int>(parent_.size());
  const auto row = static_cast<size_t>(permutation_[static_cast<size_t>(k)]);
  int top = size;
  flags_[static_cast<size_t>(k)] = k;
  counts_[static_cast<size_t>(k)] = 0;
  for (auto p = static_cast<size_t>(outer_[row]); p < static_cast<size_t>(outer_[row + 1]); ++p)
  {
    int i = inverse_permutation_[static_cast<size_t>(inner_[p])];
    if (i > k)
      continue;
    work_[static_cast<size_t>(i)] += factored_[p];
    int length = 0;
    for (; flags_[static_cast<size_t>(i)] != k; i = parent_[static_cast<size_t>(i)])
    {
      pattern_[static_cast<size_t>(length++)] = i;
      flags_[static_cast<size_t>(i)] = k;
    }
    while (length > 0)
      pattern_[static_cast<size_t>(--top)] = pattern_[static_cast<size_t>(--length)];
  }
  double pivot = work_[static_cast<size_t>(k)];
  work_[static_cast<size_t>(k)] = 0.0;
  for (; top < size; ++top)
  {
    const auto i = static_cast<size_t>(pattern_[static_cast<size_t>(top)]);
    const double value = work_[i];
    work_[i] = 0.0;
    const auto end = static_cast<size_t>(column_begin_[i] + counts_[i]);
    for (auto p = static_cast<size_t>(column_begin_[i]); p < end; ++p)
      work_[static_cast<size_t>(row_indices_[p])] -= values_[p] * value;
    const double entry = value / pivots_[i];
    pivot -= entry * value;
    row_indices_[end] = k;
    values_[end] = entry;
    ++counts_[i];
  }
  pivots_[static_cast<size_t>(k)] = pivot;
}

bool MassFactor::compute(const SparseRows& M)
{
  const bool is_new = !samePattern(M);
  if (is_new)
    analyse(M);
  const int size = static_cast<int>(M.rows());
  if (size == 0)
    return is_new;
  findChanges(M);
  for (int k = 0; k < size; ++k)
  {
    if (!hasChanged(k))
      continue;
    factorRow(k);
    const double pivot = pivots_[static_cast<size_t>(k)];
    if (!(pivot > 0.0) || !std::isfinite(pivot))
    {
      outer_.clear();
      throw std::invalid_argument("M is not positive definite: pivot of row " +
                                  std::to_string(permutation_[static_cast<size_t>(k)]) + " is " +
                                  std::to_string(pivot) + ", expected > 0");
    }
    inverse_root_pivots_[k] = 1.0 / std::sqrt(pivot);
  }
  return is_new;
}

void MassFactor::halfSolve(const Eigen::VectorXd& b, Eigen::VectorXd& x) const
{
  const int size = this->size();
  x.resize(size);
  for (int k = 0; k < size; ++k)
    x[k] = b[permutation_[static_cast<size_t>(k)]];
  for (int k = 0; k < size; ++k)
  {
    const double value = x[k];
    const auto column = static_cast<size_t>(k);
    for (auto p = static_cast<size_t>(column_begin_[column]); p < static_cast<size_t>(column_begin_[column + 1]); ++p)
      x[row_indices_[p]] -= values_[p] * value;
  }
  x.array() *= inverse_root_pivots_.array();
}

void MassFactor::transposedHalfSolve(const Eigen::VectorXd& x, Eigen::VectorXd& v) const
{
  const int size = this->size();
  permuted_.array() = x.array() * inverse_root_pivots_.array();
  for (int k = size - 1; k >= 0; --k)
  {
    const auto column = static_cast<size_t>(k);
    double value = permuted_[k];
    for (auto p = static_cast<size_t>(column_begin_[column]); p < static_cast<size_t>(column_begin_[column + 1]); ++p)
      value -= values_[p] * permuted_[row_indices_[p]];
    permuted_[k] = value;
  }
  v.resize(size);
  for (int k = 0; k < size; ++k)
    v[permutation_[static_cast<size_t>(k)]] = permuted_[k];
}

}  // namespace frictional_contact_sim
