#include "frictional_contact_sim/solver/semismooth_newton.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "frictional_contact_sim/problem/law_functions.h"

namespace frictional_contact_sim
{
namespace
{
/// An inner solve is good enough when its error is below this share of the proximal perturbation.
constexpr double INNER_SHARE = 0.1;
/// Relative size of the diagonal below which a W_NN counts as zero and rho falls back to the law's rho_i.
constexpr double ZERO_DIAGONAL = 1e-14;
/// A diagonal entry of at least this share of the largest in its column is taken as the pivot: less fill.
constexpr double PIVOT_THRESHOLD = 0.1;

void require(bool condition, const char* name, double value, const char* expected)
{
  if (!condition)
    throw std::invalid_argument(std::string("semismooth_newton.") + name + " is " + std::to_string(value) +
                                ", expected " + expected);
}

template <int D>
void store(const ContactFunction<D>& f, double* value, double* by_u, double* by_r)
{
  for (int i = 0; i < D; ++i)
    value[i] = f.value[i];
  if (by_u == nullptr)
    return;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
    {
      by_u[D * i + j] = f.by_u(i, j);
      by_r[D * i + j] = f.by_r(i, j);
    }
}
}  // namespace

/** Factorization of large systems; the pattern is analysed anew only when the active set changes. */
struct SemismoothNewton::Sparse
{
  using Matrix = Eigen::SparseMatrix<double>;
  Matrix matrix;
  std::vector<int> next;  ///< per column, where its next entry goes
  std::vector<int> columns, rows;  ///< pattern of the last analysis
  Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>> lu;

  void countColumns(const DelassusProblem& problem, const std::vector<int>& position, int size);
  void analyse();
};

/** Sets the matrix's shape and column starts: one entry for every stored entry of W with active row and column. */
void SemismoothNewton::Sparse::countColumns(const DelassusProblem& problem, const std::vector<int>& position, int size)
{
  next.assign(static_cast<std::size_t>(size) + 1, 0);
  for (int i = 0; i < problem.W.blocks(); ++i)
    if (position[static_cast<std::size_t>(problem.W.offset(i))] >= 0)
      problem.W.visitRow(i,
                         [&](int column, const double*, int)
                         {
                           const int target = position[static_cast<std::size_t>(column)];
                           if (target >= 0)
                             next[static_cast<std::size_t>(target) + 1] += problem.W.dimension(i);
                         });
  std::partial_sum(next.begin(), next.end(), next.begin());
  matrix.resize(size, size);
  matrix.resizeNonZeros(next.back());
  std::copy(next.begin(), next.end(), matrix.outerIndexPtr());
}

/** Orders the columns for the factorization, when the pattern is not that of the last call. */
void SemismoothNewton::Sparse::analyse()
{
  const int* const outer = matrix.outerIndexPtr();
  const int* const inner = matrix.innerIndexPtr();
  const int* const outer_end = outer + matrix.cols() + 1;
  const int* const inner_end = inner + matrix.nonZeros();
  if (std::equal(outer, outer_end, columns.begin(), columns.end()) &&
      std::equal(inner, inner_end, rows.begin(), rows.end()))
    return;
  columns.assign(outer, outer_end);
  rows.assign(inner, inner_end);
  lu.setPivotThreshold(PIVOT_THRESHOLD);
  lu.analyzePattern(matrix);
}

void SemismoothNewtonOptions::validate() const
{
  require(proximal_start > 0.0, "proximal_start", proximal_start, "> 0");
  require(proximal_min > 0.0, "proximal_min", proximal_min, "> 0");
  require(proximal_max >= proximal_start, "proximal_max", proximal_max, ">= proximal_start");
  require(proximal_restart > 0.0, "proximal_restart", proximal_restart, "> 0");
  require(proximal_decrease > 0.0 && proximal_decrease < 1.0, "proximal_decrease", proximal_decrease, "in (0, 1)");
  require(proximal_increase > 1.0, "proximal_increase", proximal_increase, "> 1");
  require(inner_iterations >= 1, "inner_iterations", inner_iterations, ">= 1");
  require(watchdog_min >= 0.0, "watchdog_min", watchdog_min, ">= 0");
  require(line_search_steps >= 0, "line_search_steps", line_search_steps, ">= 0");
  require(line_search_memory >= 1 && line_search_memory <= 8, "line_search_memory", line_search_memory, "1 to 8");
  require(sufficient_decrease > 0.0 && sufficient_decrease < 0.5, "sufficient_decrease", sufficient_decrease,
          "in (0, 0.5)");
}

SemismoothNewton::SemismoothNewton(std::string name, const ContactMap& map, const SemismoothNewtonOptions& options)
  : Solver(std::move(name)), map_(map), options_(options), sparse_(std::make_unique<Sparse>())
{
  options_.validate();
}

SemismoothNewton::~SemismoothNewton() = default;

void SemismoothNewton::setOptions(const SemismoothNewtonOptions& options)
{
  options.validate();
  options_ = options;
  dropSiblings();
}

std::unique_ptr<Solver> SemismoothNewton::sibling() const
{
  return std::make_unique<SemismoothNewton>(name(), map_, options_);
}

void SemismoothNewton::prepare(const DelassusProblem& problem)
{
  const int rows = problem.W.rows();
  const int count = problem.W.blocks();
  for (Eigen::VectorXd* vector : {&weight_, &u_, &u_alpha_, &f_, &step_, &step_velocity_, &trial_r_, &trial_u_})
    vector->resize(rows);
  rhs_.resize(rows);
  rho_normal_.resize(count);
  rho_tangential_.resize(count);
  by_u_.resize(9 * static_cast<std::size_t>(count));
  by_r_.resize(9 * static_cast<std::size_t>(count));
  lu_.reserve(problem.W.isDense() ? rows : std::min(rows, DENSE_LIMIT));
  active_.reserve(static_cast<std::size_t>(rows));
  position_.resize(static_cast<std::size_t>(rows));
  for (int i = 0; i < count; ++i)
  {
    const double rho = stepLengths()[i];
    double normal = 0.0, tangential = 0.0;
    if (problem.W.dimension(i) == 3)
    {
      const SquareMatrix<3> W = problem.W.diagonalBlock<3>(i);
      normal = W(0, 0);
      tangential = largestEigenvalue(SquareMatrix<2>(W.bottomRightCorner<2, 2>()));
    }
    else if (problem.W.dimension(i) == 2)
    {
      const SquareMatrix<2> W = problem.W.diagonalBlock<2>(i);
      normal = W(0, 0);
      tangential = W(1, 1);
    }
    rho_normal_[i] = normal * rho > ZERO_DIAGONAL ? 1.0 / normal : rho;
    rho_tangential_[i] = tangential * rho > ZERO_DIAGONAL ? 1.0 / tangential : rho;
    weight_.segment(problem.W.offset(i), problem.W.dimension(i)).setConstant(1.0 / rho);
  }
}

double SemismoothNewton::evaluate(const DelassusProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r,
                                  bool jacobians)
{
  double merit = 0.0;
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const auto index = static_cast<std::size_t>(i);
    const int row = problem.W.offset(i);
    const Law& law = problem.laws[index];
    double* by_u = jacobians ? &by_u_[9 * index] : nullptr;
    double* by_r = jacobians ? &by_r_[9 * index] : nullptr;
    if (law.type == LawType::COULOMB_3D)
      store<3>(map_.spatial(u.segment<3>(row), r.segment<3>(row), law.coefficient, rho_normal_[i], rho_tangential_[i]),
               &f_[row], by_u, by_r);
    else if (law.type == LawType::COULOMB_2D)
      store<2>(map_.planar(u.segment<2>(row), r.segment<2>(row), law.coefficient, rho_normal_[i], rho_tangential_[i]),
               &f_[row], by_u, by_r);
    else
      store<1>(oneDimensionalFunction(law, u[row], r[row], stepLengths()[i]), &f_[row], by_u, by_r);
    for (int k = row; k < row + law.dimension(); ++k)
      merit += (f_[k] * weight_[k]) * (f_[k] * weight_[k]);
  }
  return merit;
}

bool SemismoothNewton::direction(const DelassusProblem& problem)
{
  // Laws with A_i = 0 and B_i = -I (open contacts, clipped rows) have dr_i = f_i: they leave the system.
  active_.clear();
  for (int i = 0; i < problem.W.blocks(); ++i)
  {
    const int d = problem.W.dimension(i);
    const double* by_u = &by_u_[9 * static_cast<std::size_t>(i)];
    const bool fixed = std::all_of(by_u, by_u + d * d, [](double value) { return value == 0.0; });
    for (int row = problem.W.offset(i); row < problem.W.offset(i) + d; ++row)
    {
      position_[static_cast<std::size_t>(row)] = fixed ? -1 : static_cast<int>(active_.size());
      if (!fixed)
        active_.push_back(row);
    }
    if (!fixed)
      continue;
    // B_i dr = -f with B_i = -I but for the coupling of a clipped friction to its normal impulse.
    const int row = problem.W.offset(i);
    const double* by_r = &by_r_[9 * static_cast<std::size_t>(i)];
    step_[row] = -f_[row] / by_r[0];
    for (int k = 1; k < d; ++k)
      step_[row + k] = (f_[row + k] + by_r[d * k] * step_[row]) / -by_r[d * k + k];
  }
  const auto size = static_cast<Eigen::Index>(active_.size());
  if (size == 0)
    return true;
  if (!problem.W.isDense() && size > DENSE_LIMIT ? !solveSparse(problem) : !solveDense(problem))
    return false;
  if (!rhs_.head(size).allFinite())
    return false;
  for (Eigen::Index k = 0; k < size; ++k)
    step_[active_[static_cast<std::size_t>(k)]] = rhs_[k];
  return true;
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
  const Eigen::Map<const Rows> A(&by_u_[9 * static_cast<std::size_t>(i)]);
  const Eigen::Map<const Rows> B(&by_r_[9 * static_cast<std::size_t>(i)]);
  const int row = problem.W.offset(i);
  const int first = position_[static_cast<std::size_t>(row)];
  const double shift = alpha_ * weight_[row];
  Vector<D> right = -f_.segment<D>(row);
  problem.W.visitRow(i,
                     [&](int column, const double* w, int stride)
                     {
                       Vector<D> w_column;
                       for (int k = 0; k < D; ++k)
                         w_column[k] = w[k * stride];
                       Vector<D> value = A * w_column;
                       const int target = position_[static_cast<std::size_t>(column)];
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
    const int first = position_[static_cast<std::size_t>(problem.W.offset(i))];
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

bool SemismoothNewton::solveDense(const DelassusProblem& problem)
{
  const auto size = static_cast<Eigen::Index>(active_.size());
  Eigen::Map<Eigen::MatrixXd> jacobian = lu_.start(static_cast<int>(size));
  assemble(problem, [&](int row, int column, const auto& values)
           { jacobian.col(column).template segment<std::decay_t<decltype(values)>::RowsAtCompileTime>(row) = values; });
  if (!lu_.factor())
    return false;
  lu_.solve(rhs_.head(size));
  return true;
}

bool SemismoothNewton::solveSparse(const DelassusProblem& problem)
{
  const auto size = static_cast<Eigen::Index>(active_.size());
  sparse_->countColumns(problem, position_, static_cast<int>(size));
  sparse_->next.assign(sparse_->matrix.outerIndexPtr(), sparse_->matrix.outerIndexPtr() + size);
  int* const rows = sparse_->matrix.innerIndexPtr();
  double* const entries = sparse_->matrix.valuePtr();
  assemble(problem,
           [&](int row, int column, const auto& values)
           {
             int& place = sparse_->next[static_cast<std::size_t>(column)];
             for (Eigen::Index k = 0; k < values.size(); ++k, ++place)
             {
               rows[place] = row + static_cast<int>(k);
               entries[place] = values[k];
             }
           });
  sparse_->analyse();
  sparse_->lu.factorize(sparse_->matrix);
  if (sparse_->lu.info() != Eigen::Success)
    return false;
  rhs_.head(size) = sparse_->lu.solve(rhs_.head(size));
  return true;
}

double SemismoothNewton::lineSearch(const DelassusProblem& problem, const Eigen::VectorXd& r)
{
  problem.W.apply(step_, step_velocity_);
  step_velocity_.array() += alpha_ * weight_.array() * step_.array();
  const double reference =
      *std::max_element(history_, history_ + std::min(history_count_, options_.line_search_memory));
  double best_t = 0.0;
  double best_merit = std::numeric_limits<double>::infinity();
  double t = 1.0;
  for (int k = 0; k <= options_.line_search_steps; ++k, t *= 0.5)
  {
    trial_r_ = r + t * step_;
    trial_u_ = u_alpha_ + t * step_velocity_;
    const double merit = evaluate(problem, trial_u_, trial_r_, false);
    if (merit <= (1.0 - 2.0 * options_.sufficient_decrease * t) * reference)
      return t;
    if (merit < best_merit)
    {
      best_merit = merit;
      best_t = t;
    }
  }
  // No sufficient decrease: the best of the tried ones when it is a decrease at all. Otherwise the full step: across a
  // kink the merit is no guide, refusing the step stalls (measured: 1829 steps instead of 66 on 256 spheres in a box),
  // and the budget of the inner solve bounds the excursion.
  const double otherwise = alpha_ >= options_.watchdog_min ? 1.0 : 0.0;
  return best_merit < reference ? best_t : otherwise;
}

void SemismoothNewton::keepBest(double value, const Eigen::VectorXd& r)
{
  if (value < best_value_)
  {
    best_value_ = value;
    best_r_ = r;
  }
}

SemismoothNewton::Inner SemismoothNewton::solveProximal(const DelassusProblem& problem, SolverResult& result)
{
  Eigen::VectorXd& r = result.solution.r;
  history_count_ = 0;
  for (int k = 0; k <= options_.inner_iterations; ++k)
  {
    problem.W.apply(r, u_);
    u_ += problem.q;
    const double value = residual(problem, u_, r);
    keepBest(value, r);
    if (value <= stopping().tolerance)
      return Inner::CONVERGED;
    u_alpha_.array() = u_.array() + alpha_ * weight_.array() * (r - centre_).array();
    const double merit = evaluate(problem, u_alpha_, r, true);
    if (!std::isfinite(merit))
      return Inner::FAILED;
    const double perturbation = (alpha_ * weight_.array() * (r - centre_).array()).matrix().squaredNorm();
    if (k > 0 && merit <= INNER_SHARE * INNER_SHARE * perturbation)
      return Inner::SUCCESS;
    if (k == options_.inner_iterations)
      return Inner::FAILED;
    if (result.iterations >= stopping().max_iterations || timeIsUp())
      return Inner::OUT_OF_BUDGET;
    ++result.iterations;
    history_[history_count_++ % options_.line_search_memory] = merit;
    if (!direction(problem))
      return Inner::FAILED;
    const double t = lineSearch(problem, r);
    if (t == 0.0)
      return Inner::FAILED;
    r += t * step_;
  }
  return Inner::FAILED;
}

void SemismoothNewton::doSolve(const DelassusProblem& problem, SolverResult& result)
{
  prepare(problem);
  Eigen::VectorXd& r = result.solution.r;
  best_value_ = std::numeric_limits<double>::infinity();
  best_r_ = r;
  alpha_ = options_.proximal_start;
  result.status = SolverStatus::STAGNATED;
  result.message = "no proximal parameter leads on";
  while (true)
  {
    centre_ = r;
    const Inner inner = solveProximal(problem, result);
    result.residual = best_value_;
    if (inner == Inner::CONVERGED)
    {
      result.status = SolverStatus::CONVERGED;
      return;
    }
    if (inner == Inner::OUT_OF_BUDGET)
    {
      const bool time = timeIsUp();
      result.status = time ? SolverStatus::TIME_LIMIT : SolverStatus::MAX_ITERATIONS;
      result.message = time ? "time limit reached" : "Newton iterations exhausted";
      break;
    }
    if (inner == Inner::SUCCESS)
      alpha_ = std::max(options_.proximal_decrease * alpha_, options_.proximal_min);
    else
    {
      if (alpha_ >= options_.proximal_max)
        break;
      alpha_ = std::clamp(options_.proximal_increase * alpha_, options_.proximal_restart, options_.proximal_max);
      r = centre_;
    }
  }
  r = best_r_;
}

}  // namespace frictional_contact_sim
