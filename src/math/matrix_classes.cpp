#include "frictional_contact_sim/math/matrix_classes.h"

#include <Eigen/Eigenvalues>
#include <cfloat>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace frictional_contact_sim
{
namespace
{
void check(const Eigen::MatrixXd& A)
{
  if (A.rows() != A.cols() || A.rows() > MOST_UNKNOWNS)
    throw std::invalid_argument("A is " + std::to_string(A.rows()) + " x " + std::to_string(A.cols()) +
                                ", expected a square matrix of at most " + std::to_string(MOST_UNKNOWNS) + " rows");
  if (!A.allFinite())
    throw std::invalid_argument("A has an entry that is not finite");
}

/**
 * Every principal minor is a product of pivots, and every pivot is the first entry of a Schur complement: with the
 * first row in or out, both of what is left. @param size of the entries that a pivot was computed from
 */
void visitMinors(const Eigen::MatrixXd& S, const Eigen::MatrixXd& size, int first, std::vector<int>& rows,
                 PMatrixReport& report)
{
  if (S.rows() == 0 || report.verdict == MatrixVerdict::NO)
    return;
  const Eigen::Index rest = S.rows() - 1;
  visitMinors(S.bottomRightCorner(rest, rest), size.bottomRightCorner(rest, rest), first + 1, rows, report);
  if (report.verdict == MatrixVerdict::NO)
    return;
  const double pivot = S(0, 0);
  rows.push_back(first);
  if (!(pivot > 64.0 * DBL_EPSILON * size(0, 0)))
  {
    const bool negative = pivot < -64.0 * DBL_EPSILON * size(0, 0) || size(0, 0) == 0.0;
    if (negative || report.verdict == MatrixVerdict::YES)
      report.indices = rows;
    report.verdict = negative ? MatrixVerdict::NO : MatrixVerdict::UNDECIDED;
  }
  else
  {
    const Eigen::MatrixXd product = S.bottomLeftCorner(rest, 1) * S.topRightCorner(1, rest) / pivot;
    const Eigen::MatrixXd left = S.bottomRightCorner(rest, rest) - product;
    const Eigen::MatrixXd left_size = size.bottomRightCorner(rest, rest) + product.cwiseAbs();
    visitMinors(left, left_size, first + 1, rows, report);
  }
  rows.pop_back();
}
}  // namespace

PMatrixReport checkPMatrix(const Eigen::MatrixXd& A)
{
  check(A);
  PMatrixReport report;
  report.verdict = MatrixVerdict::YES;
  std::vector<int> rows;
  visitMinors(A, A.cwiseAbs(), 0, rows, report);
  return report;
}

CopositivityReport checkCopositivity(const Eigen::MatrixXd& A)
{
  check(A);
  const auto n = static_cast<int>(A.rows());
  const Eigen::MatrixXd symmetric = 0.5 * (A + A.transpose());
  const double round_off = 64.0 * DBL_EPSILON * std::max(1, n) * (n > 0 ? symmetric.cwiseAbs().maxCoeff() : 0.0);
  CopositivityReport report;
  report.value = std::numeric_limits<double>::infinity();
  for (unsigned subset = 1; subset < (1u << n); ++subset)
  {
    std::vector<int> index;
    for (int i = 0; i < n; ++i)
      if (subset & (1u << i))
        index.push_back(i);
    const auto size = static_cast<Eigen::Index>(index.size());
    Eigen::MatrixXd part(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j < size; ++j)
        part(i, j) = symmetric(index[static_cast<size_t>(i)], index[static_cast<size_t>(j)]);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(part);
    for (Eigen::Index k = 0; k < size && spectrum.eigenvalues()[k] <= round_off; ++k)
    {
      Eigen::VectorXd candidate = spectrum.eigenvectors().col(k);
      candidate *= candidate.sum() < 0.0 ? -1.0 : 1.0;
      // Where the least eigenvalue is a multiple one its vectors have any sign; a smaller sub-matrix has the proof
      // then.
      candidate = candidate.cwiseMax(0.0);
      if (candidate.norm() < 0.5)
        continue;
      candidate.normalize();
      const double value = candidate.dot(part * candidate);
      if (value >= report.value)
        continue;
      report.value = value;
      report.x.setZero(n);
      for (Eigen::Index i = 0; i < size; ++i)
        report.x[index[static_cast<size_t>(i)]] = candidate[i];
    }
    if (report.value < -round_off)
      break;
  }
  if (report.value < -round_off)
    report.copositive = report.strictly = MatrixVerdict::NO;
  else
  {
    report.copositive = MatrixVerdict::YES;
    report.strictly = report.value <= round_off ? MatrixVerdict::NO : MatrixVerdict::YES;
    if (!std::isfinite(report.value))
      report.value = 0.0;
  }
  return report;
}

}  // namespace frictional_contact_sim
