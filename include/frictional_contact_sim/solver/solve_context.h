#pragma once
/**
 * @file solve_context.h
 * @brief What a method is told about one solve beside the problem and the guess; made by Solver::solve, passed down.
 *
 * Whoever runs a method inside another copies its own context and changes the copy (a smaller budget, another
 * tolerance): no solver writes into another one.
 */
#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/residual_metric.h"

namespace frictional_contact_sim
{
/** @brief E at an iterate that a method judged. */
struct HistoryEntry
{
  int iteration = 0;
  double seconds = 0.0;  ///< wall clock since the call of Solver::solve [s]
  double residual = 0.0;  ///< [-]
};

/**
 * @brief Work of a solve in products with its W (2 nnz flops each), so that inner iterations and factorizations count
 * as what they cost; no clock. Of islands each has its own: one does not starve the others,
 * and the whole's is that of the hardest.
 */
struct WorkMeter
{
  double spent = 0.0;  ///< [products]
  double limit = 0.0;  ///< [products], 0 = none
  bool exhausted() const { return limit > 0.0 && spent > limit; }
};

struct SolveContext
{
  const ResidualMetric& metric;  ///< rho_i and S_i of the laws, in their order
  double tolerance = 1e-8;  ///< on E [-]
  int max_iterations = 1000;
  bool cold_start = true;  ///< no guess was given; refinements of a global solve have one, whoever called it
  std::chrono::steady_clock::time_point start{};  ///< of the call of Solver::solve
  double deadline = 0.0;  ///< seconds after start when time is up, 0 = never
  std::vector<HistoryEntry>* history = nullptr;  ///< where iterates are noted; nullptr = nowhere
  int iterations_before = 0;  ///< made in this solve before the method was called, counted in the history only
  WorkMeter* work = nullptr;  ///< where work is counted; nullptr = nowhere
  const std::atomic<bool>* stop = nullptr;  ///< set from outside (a signal): end now; nullptr = never

  double seconds() const;
  bool stopped() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
  /** @brief The solve has to end: clock, work or a wish from outside. Methods say TIME_LIMIT, Solver::solve says which.
   */
  bool timeIsUp() const
  {
    return (work != nullptr && work->exhausted()) || stopped() || (deadline > 0.0 && seconds() > deadline);
  }
  /** @brief Counts work [products with W]. @return timeIsUp() */
  bool spend(double products) const
  {
    if (work != nullptr)
      work->spent += products;
    return timeIsUp();
  }
  /**
   * @brief Factorizing `rows` of the problem's rows, as products with W: (2/3 rows^3) / (2 n^2) dense; sparse factors
   * are cheaper, their fill is not known beforehand, so they count SPARSE_FACTOR at most.
   */
  static double factorization(const DelassusProblem& problem, double rows)
  {
    const double n = problem.W.rows();
    return problem.W.isDense() ? rows * rows * rows / (3.0 * n * n) : std::min(rows / 3.0, SPARSE_FACTOR);
  }
  /** @brief E at (u, r), u = W r + q given; costs no product with W. */
  double residual(const DelassusProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r) const;
  /** @brief The smallest S_i: what a method asks of an inner problem is an error in [m/s]. */
  double smallestScale() const { return metric.scales.size() == 0 ? VELOCITY_FLOOR : metric.scales.minCoeff(); }
  /** @brief Called by a method with E at each of its iterates; nothing but a comparison without history. */
  void note(int iteration, double value) const
  {
    if (history != nullptr)
      history->push_back({iterations_before + iteration, seconds(), value});
  }
  /** @brief Iteration of the last entry, where the next island goes on. */
  int notedIterations() const { return history == nullptr || history->empty() ? 0 : history->back().iteration; }

  static constexpr double SPARSE_FACTOR = 100.0;  ///< [products]
};

}  // namespace frictional_contact_sim
