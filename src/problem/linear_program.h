#pragma once
/**
 * @file linear_program.h
 * @brief min c.x, lower <= x <= upper, row_lower <= A x <= row_upper, by the simplex method of Clp, silently.
 *
 * Rows may be added after a solve; the next one starts from the last basis.
 */
#include <Eigen/Core>
#include <memory>
#include <vector>

namespace frictional_contact_sim
{
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

  Eigen::VectorXd solution() const;
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
