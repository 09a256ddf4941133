#pragma once
/**
 * @file outer_loop.h
 * @brief What the loops of the methods share: the best iterate, the stopping rules, the tolerance of inner problems.
 */
#include <Eigen/Core>
#include <limits>

#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
class OuterLoop
{
public:
  /**
   * @brief The result's residual becomes unknown: u of a loop's iterates is not always W r + q to the last bit.
   * @param window iterations without the best residual falling by a tenth that count as a stall; no rule by default
   */
  OuterLoop(const SolveContext& context, SolverResult& result, int window = std::numeric_limits<int>::max())
    : context_(context), result_(result), window_(window)
  {
    result.residual = UNKNOWN_RESIDUAL;
  }

  /**
   * @brief Takes note of an iterate. @return true when the method should stop, with status and message set.
   * @param residual E at r
   */
  bool record(double residual, const Eigen::VectorXd& r);
  /** @brief Forgets the stall count, not the best iterate. */
  void restart();
  /** @brief Ends with the given status. The best iterate is kept. */
  bool stop(SolverStatus status, const char* message);

  /**
   * @brief True when the iterations, the work or the time are used up, with status and message (`exhausted`, or the
   * time) set. @param products with W that the iteration before took
   */
  bool outOfBudget(const char* exhausted, double products = 1.0);

  /**
   * @brief Relative tolerance of the next inner problem: accuracy times the last residual, not below tolerance / 10.
   * Without friction the inner problem is the whole problem: to the end.
   */
  double innerTolerance(double accuracy, bool frictional) const;
  double best() const { return best_; }
  /** @brief Iterations since the residual last fell by a tenth. */
  int sinceProgress() const { return since_; }

private:
  const SolveContext& context_;
  SolverResult& result_;
  int window_;
  double last_ = 1.0;
  double run_best_ = std::numeric_limits<double>::infinity();  ///< since the last restart
  double best_ = std::numeric_limits<double>::infinity();
  double window_best_ = std::numeric_limits<double>::infinity();
  int since_ = 0;
};

}  // namespace frictional_contact_sim
