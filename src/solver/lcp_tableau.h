#pragma once
/**
 * @file lcp_tableau.h
 * @brief Condensed tableau of  basic + T nonbasic = b, with exchanges as rank-one updates; private to lemke.cpp and
 * principal_pivoting.cpp.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/solver/lemke.h"

namespace frictional_contact_sim
{
/** @brief Exchanges the basic variable of a row with the non-basic one of a column: n (columns) multiplications. */
inline void exchange(Eigen::MatrixXd& T, Eigen::VectorXd& b, Eigen::Index row, Eigen::Index column,
                     Eigen::VectorXd& work_column, Eigen::RowVectorXd& work_row)
{
  const double pivot = T(row, column);
  work_column = T.col(column);
  work_row = T.row(row) / pivot;
  const double value = b[row] / pivot;
  work_column[row] = 0.0;
  work_row[column] = 0.0;
  T.noalias() -= work_column * work_row;
  T.col(column) = -work_column / pivot;
  T.row(row) = work_row;
  T(row, column) = 1.0 / pivot;
  b -= value * work_column;
  b[row] = value;
}

/** @brief Throws std::invalid_argument on wrong shapes or entries that are not finite. */
void checkLcp(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options);

/** @brief x from the indices that are basic (y there is zero), by LU; sets x, y and a NUMERICAL_FAILURE. */
void solveBasis(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const std::vector<bool>& basic, LcpResult& result);

/** @brief A pivoting method from its check to its answer; Path has follow(max_pivots, pivots) and basic(). */
template <typename Path>
LcpResult followPath(const Eigen::MatrixXd& M, const Eigen::VectorXd& b, const LcpOptions& options)
{
  checkLcp(M, b, options);
  LcpResult result;
  if (b.size() == 0)
  {
    result.status = LcpStatus::SOLVED;
    return result;
  }
  Path path(M, b, options);
  const int size = static_cast<int>(b.size());
  result.status = path.follow(options.max_pivots > 0 ? options.max_pivots : 20 * size + 100, result.pivots);
  solveBasis(M, b, path.basic(), result);
  return result;
}

}  // namespace frictional_contact_sim
