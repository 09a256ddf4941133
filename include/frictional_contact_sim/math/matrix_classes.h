#pragma once
/**
 * @file matrix_classes.h
 * @brief Classes of square matrices that decide how many solutions y = A x + b, 0 <= x orthogonal y >= 0 has.
 *
 *   P-matrix      all principal minors positive: exactly one solution for every b (theorem 4.3)
 *   copositive    x^T A x >= 0 for every x >= 0; strictly: > 0 but for x = 0, and there is a solution for every b
 *                 (theorem 4.5); with b >= 0 on { x >= 0, A x >= 0, x^T A x = 0 } there is one for that b (theorem 4.6)
 *
 * Both are decided by all principal sub-matrices, so for small n only: minors by Schur complements, 2^n in all
 * (Tsatsomeros, Li 2000); A is copositive if and only if no principal sub-matrix of (A + A^T)/2 has a positive
 * eigenvector with a negative eigenvalue (Kaplan 2000). Neither test looks at more than 2^MOST_UNKNOWNS of them.
 *
 * Source: Cadoux (2009), section 4.1; Cottle, Pang, Stone (1992), theorems 3.3.7, 3.8.5, 3.8.6.
 */
#include <Eigen/Core>
#include <vector>

namespace frictional_contact_sim
{
constexpr int MOST_UNKNOWNS = 16;

enum class MatrixVerdict
{
  YES,
  NO,
  UNDECIDED  ///< a value is zero to round-off
};

struct PMatrixReport
{
  MatrixVerdict verdict = MatrixVerdict::UNDECIDED;
  std::vector<int> indices;  ///< NO, UNDECIDED: rows of a principal minor that is not positive
};
/** @throws std::invalid_argument unless A is square, finite and at most MOST_UNKNOWNS large */
PMatrixReport checkPMatrix(const Eigen::MatrixXd& A);

struct CopositivityReport
{
  MatrixVerdict copositive = MatrixVerdict::UNDECIDED;
  MatrixVerdict strictly = MatrixVerdict::UNDECIDED;
  Eigen::VectorXd x;  ///< >= 0, of length 1, with the least x^T A x that was met; the proof of NO
  double value = 0.0;  ///< x^T A x
};
/** @throws as checkPMatrix */
CopositivityReport checkCopositivity(const Eigen::MatrixXd& A);

}  // namespace frictional_contact_sim
