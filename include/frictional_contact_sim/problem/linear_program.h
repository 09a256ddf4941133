#pragma once
/**
 * @file linear_program.h
 * @brief min c.x, lower <= x <= upper, row_lower <= A x <= row_upper, by the simplex method of Clp, silently.
 *
 * Rows may be added, bounds, costs and entries changed after a solve; the next one starts from the last basis, which is
 * what a search that fixes one thing after another needs.
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

namespace frictional_contact_sim
{
/** @brief How a solve ended. */
enum class LinearProgramStatus
{
  OPTIMAL,
  INFEASIBLE,  ///< infeasibilityRay() says why
  UNBOUNDED,
  STOPPED  ///< iterations exhausted, or the simplex method lost its digits
};

class LinearProgram
{
public:
  LinearProgram();
  ~LinearProgram();
  LinearProgram(const LinearProgram&) = delete;
  LinearProgram& operator=(const LinearProgram&) = delete;

  static const double INFINITE;  ///< bounds from here on do not bind

  /** @return index of the new column */
  int addColumn(double lower, double upper, double cost);
  /** @return index of the new row */
  int addRow(double lower, double upper, const std::vector<int>& columns, const std::vector<double>& values);

  /**
   * @brief Solves with all rows and columns added so far.
   * @param max_iterations of the simplex method
   * @return true when an optimum was found
   */
  bool solve(int max_iterations);

  /** @brief How the last solve ended. */
  LinearProgramStatus status() const;

  /** @brief New bounds of all columns and rows; only after a solve, sizes as added so far. */
  void setBounds(const Eigen::VectorXd& column_lower, const Eigen::VectorXd& column_upper,
                 const Eigen::VectorXd& row_lower, const Eigen::VectorXd& row_upper);
  /** @brief New costs of all columns; only after a solve. */
  void setCosts(const Eigen::VectorXd& costs);
  /** @brief A new entry of A; only after a solve. */
  void setEntry(int row, int column, double value);
  /** @brief Goes on by the primal simplex method: what follows a change of costs. @return true when optimal */
  bool solvePrimal(int max_iterations);

  Eigen::VectorXd solution() const;
  /**
   * @brief Multipliers y of the rows that prove INFEASIBLE: the range of y.(A x) over the columns' bounds and that over
   * the rows' do not meet. The sign is the simplex method's business; empty when there is none.
   */
  Eigen::VectorXd infeasibilityRay() const;
  /** @brief A direction of the columns that proves UNBOUNDED: feasible for ever, cost falling; empty when there is
   * none. */
  Eigen::VectorXd unboundedRay() const;
  /** @brief c - A^T prices() of the last solve. */
  Eigen::VectorXd reducedCosts() const;
  /** @brief Multipliers of the rows: c - A^T y is 0 for columns between their bounds, y >= 0 where only a lower bound
   * holds. */
  Eigen::VectorXd prices() const;
  int iterations() const { return iterations_; }

private:
  struct Model;
  std::unique_ptr<Model> model_;
  std::vector<double> column_lower_, column_upper_, cost_;
  std::vector<double> row_lower_, row_upper_;  ///< rows not yet handed to Clp
  std::vector<int> row_starts_, row_columns_;
  std::vector<double> row_values_;
  int rows_ = 0;
  int iterations_ = 0;
  bool loaded_ = false;
};

}  // namespace frictional_contact_sim
