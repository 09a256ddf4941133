/**
 * @file semismooth_newton_step.cpp
 * @brief The linear system of a Newton step: inactive laws eliminated, the rest factored dense or sparse.
 */
#include <algorithm>
#include <numeric>

#include "frictional_contact_sim/solver/semismooth_newton.h"
#include "frictional_contact_sim/solver/sparse_lu.h"

namespace frictional_contact_sim
{
namespace
{
/// Largest alpha whose effect on the step is taken out again: larger ones are there to shorten the step.
constexpr double REFINE_MAX = 1e-5;
}  // namespace

/** The system when it is factored sparse. */
struct SemismoothNewton::Sparse
{
  SparseLu lu;
  std::vector<int> next;  ///< per column, where its next entry goes

  void countColumns(const DelassusProblem& problem, const std::vector<int>& position, int size);
};

/** Sets the matrix's shape and column starts: one entry for every stored entry of W with active row and column. */
void SemismoothNewton::Sparse::countColumns(const DelassusProblem& problem, const std::vector<int>& position, int size)
{
  next.assign(static_cast<size_t>(size) + 1, 0);
  for (int i = 0; i < problem.W.blocks(); ++i)
    if (position[static_cast<size_t>(problem.W.offset(i))] >= 0)
      problem.W.visitRow(i,
                         [&](int column, const double*, int)
                         {
                           const int target = position[static_cast<size_t>(column)];
                           if (target >= 0)
                             next[static_cast<size_t>(target) + 1] += problem.W.dimension(i);
                         });
  std::partial_sum(next.begin(), next.end(), next.begin());
  SparseLu::Matrix& matrix = lu.matrix();
  matrix.resize(size, size);
  matrix.resizeNonZeros(next.back());
  std::copy(next.begin(), next.end(), matrix.outerIndexPtr());
}

// Where Sparse is complete.
SemismoothNewton::SemismoothNewton(std::string name, const ContactMap& map, const SemismoothNewtonOptions& options)
  : Solver(std::move(name)), map_(map), options_(options), sparse_(std::make_unique<Sparse>())
{
  options_.validate();
}

SemismoothNewton::~SemismoothNewton() = default;

bool SemismoothNewton::direction(const DelassusProblem& problem)
{
  // Laws with A_i = 0 and B_i = -I (open contacts, clipped rows) have dr_i = f_i: they leave the system.
  active_.clear();
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int d = problem.W.dimension(i);
    const double* by_u = &by_u_[9 * static_cast<size_t>(i)];
    const bool fixed = std::all_of(by_u, by_u + d * d, [](double value) { return value == 0.0; });
    for (int row = problem.W.offset(i); row < problem.W.offset(i) + d; ++row)
    {
      position_[static_cast<size_t>(row)] = fixed ? -1 : static_cast<int>(active_.size());
      if (!fixed)
        active_.push_back(row);
    }
    if (!fixed)
      continue;
    // B_i dr = -f with B_i = -I but for the coupling of a clipped friction to its normal impulse.
    const int row = problem.W.offset(i);
    const double* by_r = &by_r_[9 * static_cast<size_t>(i)];
    step_[row] = -f_[row] / by_r[0];
    for (int k = 1; k < d; ++k)
      step_[row + k] = (f_[row + k] + by_r[d * k] * step_[row]) / -by_r[d * k + k];
  }
  const auto size = static_cast<Eigen::Index>(active_.size());
  if (size == 0)
    return true;
  if (!(isSparse(problem) ? factorSparse(problem) : factorDense(problem)))
    return false;
  substitute(problem);
  if (!rhs_.head(size).allFinite())
    return false;
  for (Eigen::Index k = 0; k < size; ++k)
    step_[active_[static_cast<size_t>(k)]] = rhs_[k];
  if (perturbation_ == 0.0 && alpha_ <= REFINE_MAX)
    refine(problem);
  return true;
}

/**
 * One step of iterated Tikhonov regularisation, d <- d + (J + alpha A D)^-1 alpha A D d: the error that alpha leaves in
 * the step, of order alpha, becomes one of order alpha^2, for one more substitution. At a centre only: elsewhere the
 * step is that of the proximal problem.
 */
void SemismoothNewton::refine(const DelassusProblem& problem)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int row = problem.W.offset(i);
    const int first = position_[static_cast<size_t>(row)];
    if (first < 0)
      continue;
    const int d = problem.W.dimension(i);
    const double* by_u = &by_u_[9 * static_cast<size_t>(i)];
    for (int k = 0; k < d; ++k)
      rhs_[first + k] = alpha_ * weight_[row] * std::inner_product(by_u + d * k, by_u + d * (k + 1), &step_[row], 0.0);
  }
  substitute(problem);
  for (size_t k = 0; k < active_.size(); ++k)
    step_[active_[k]] += rhs_[static_cast<Eigen::Index>(k)];
}

/**
 * The rows of law i in the reduced system, D rows: calls sink(column, D values) for every active column of W,
 * ascending, with A_i (W_ij + alpha D) + B_i, and moves the columns of inactive laws, whose step is known, to the
 * right-hand side.
 */
template <int D, typename Sink>
void SemismoothNewton::reducedRows(const DelassusProblem& problem, int i, Sink sink)
{
  using Rows = Eigen::Matrix<double, D, D, Eigen::RowMajor>;
  const Eigen::Map<const Rows> A(&by_u_[9 * static_cast<size_t>(i)]);
  const Eigen::Map<const Rows> B(&by_r_[9 * static_cast<size_t>(i)]);
  const int row = problem.W.offset(i);
  const int first = position_[static_cast<size_t>(row)];
  const double shift = alpha_ * weight_[row];
  Vector<D> right = -f_.segment<D>(row);
  problem.W.visitRow(i,
                     [&](int column, const double* w, int stride)
                     {
                       Vector<D> w_column;
                       for (int k = 0; k < D; ++k)
                         w_column[k] = w[k * stride];
                       Vector<D> value = A * w_column;
                       const int target = position_[static_cast<size_t>(column)];
                       if (target < 0)
                       {
                         right -= value * step_[column];
                         return;
                       }
                       if (column >= row && column < row + D)
                         value += B.col(column - row) + shift * A.col(column - row);
                       sink(target, value);
                     });
  rhs_.segment<D>(first) = right;
}

template <typename Sink>
void SemismoothNewton::assemble(const DelassusProblem& problem, Sink sink)
{
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int first = position_[static_cast<size_t>(problem.W.offset(i))];
    if (first < 0)
      continue;
    const auto add = [&](int column, const auto& values) { sink(first, column, values); };
    if (problem.W.dimension(i) == 3)
      reducedRows<3>(problem, i, add);
    else if (problem.W.dimension(i) == 2)
      reducedRows<2>(problem, i, add);
    else
      reducedRows<1>(problem, i, add);
  }
}

bool SemismoothNewton::isSparse(const DelassusProblem& problem) const
{
  return !problem.W.isDense() && active_.size() > DENSE_LIMIT;
}

bool SemismoothNewton::factorDense(const DelassusProblem& problem)
{
  const auto size = static_cast<Eigen::Index>(active_.size());
  Eigen::Map<Eigen::MatrixXd> jacobian = lu_.start(static_cast<int>(size));
  assemble(problem, [&](int row, int column, const auto& values)
           { jacobian.col(column).template segment<std::decay_t<decltype(values)>::RowsAtCompileTime>(row) = values; });
  return lu_.factor();
}

bool SemismoothNewton::factorSparse(const DelassusProblem& problem)
{
  const auto size = static_cast<Eigen::Index>(active_.size());
  sparse_->countColumns(problem, position_, static_cast<int>(size));
  SparseLu::Matrix& matrix = sparse_->lu.matrix();
  sparse_->next.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + size);
  int* const rows = matrix.innerIndexPtr();
  double* const entries = matrix.valuePtr();
  assemble(problem,
           [&](int row, int column, const auto& values)
           {
             int& place = sparse_->next[static_cast<size_t>(column)];
             for (Eigen::Index k = 0; k < values.size(); ++k, ++place)
             {
               rows[place] = row + static_cast<int>(k);
               entries[place] = values[k];
             }
           });
  return sparse_->lu.factor();
}

/** The active part of rhs_ by the factors of factorDense or factorSparse. */
void SemismoothNewton::substitute(const DelassusProblem& problem)
{
  const auto size = static_cast<Eigen::Index>(active_.size());
  if (isSparse(problem))
    sparse_->lu.solve(rhs_.head(size));
  else
    lu_.solve(rhs_.head(size));
}

}  // namespace frictional_contact_sim
