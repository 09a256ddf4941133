#include "frictional_contact_sim/problem/certificate/conditioning.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace frictional_contact_sim
{
namespace
{
/// Negative eigenvalues of W, over rows and the largest entry, that count as round-off of who wrote it.
constexpr double INDEFINITE = 1e-8;

/** Rows of laws that are not BILATERAL. */
std::vector<Eigen::Index> contactRows(const std::vector<Law>& laws)
{
  std::vector<Eigen::Index> rows;
  Eigen::Index row = 0;
  for (const Law& law : laws)
  {
    for (int k = 0; k < law.dimension(); ++k)
      if (law.type != LawType::BILATERAL)
        rows.push_back(row + k);
    row += law.dimension();
  }
  return rows;
}

/// Independent rows up to which singular values are found by rotations, with all digits; beyond, from the eigenvalues
/// of W, where a condition above 1e15 is not told from a lower rank.
constexpr int MOST_ROTATED = 150;
constexpr int MOST_SWEEPS = 40;

/**
 * Singular values to full relative accuracy: QR with column pivoting, then one-sided Jacobi rotations on the columns of
 * R^T until they are orthogonal (Drmac, Veselic 2008, without its preconditioning refinements).
 */
Eigen::VectorXd singularValues(const Eigen::MatrixXd& A)
{
  if (A.size() == 0)
    return Eigen::VectorXd(0);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(A);
  const Eigen::Index rank = factor.rank();
  Eigen::MatrixXd R = factor.matrixR().topRows(rank).template triangularView<Eigen::Upper>();
  if (rank > MOST_ROTATED)
  {
    const Eigen::MatrixXd gram = R * R.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(gram, Eigen::EigenvaluesOnly);
    return spectrum.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  }
  Eigen::MatrixXd X = R.transpose();
  bool rotated = true;
  for (int sweep = 0; sweep < MOST_SWEEPS && rotated; ++sweep)
  {
    rotated = false;
    for (Eigen::Index i = 0; i < rank; ++i)
      for (Eigen::Index j = i + 1; j < rank; ++j)
      {
        const double a = X.col(i).squaredNorm(), b = X.col(j).squaredNorm(), c = X.col(i).dot(X.col(j));
        if (std::abs(c) <= 1e-14 * std::sqrt(a * b))
          continue;
        rotated = true;
        const double zeta = (b - a) / (2.0 * c);
        const double t = (zeta >= 0.0 ? 1.0 : -1.0) / (std::abs(zeta) + std::hypot(1.0, zeta));
        const double cosine = 1.0 / std::hypot(1.0, t);
        const Eigen::VectorXd column = cosine * (X.col(i) - t * X.col(j));
        X.col(j) = cosine * (t * X.col(i) + X.col(j));
        X.col(i) = column;
      }
  }
  return X.colwise().norm().transpose();
}

/** @param values not negative, in any order. @param floor share of the largest that counts as zero */
Conditioning fromSpectrum(const Eigen::VectorXd& values, Eigen::Index rows, double floor, double power)
{
  Conditioning result;
  result.rows = static_cast<int>(rows);
  result.rank = 0;
  const double largest = values.size() > 0 ? values.maxCoeff() : 0.0;
  double smallest = largest;
  for (const double value : values)
    if (value > floor * largest)
    {
      ++result.rank;
      smallest = std::min(smallest, value);
    }
  if (result.rank > 0)
    result.condition = std::pow(largest / smallest, power);
  return result;
}
double largestEntry(const SparseRows& matrix)
{
  double largest = 0.0;
  for (Eigen::Index k = 0; k < matrix.nonZeros(); ++k)
    largest = std::max(largest, std::abs(matrix.valuePtr()[k]));
  return largest;
}
}  // namespace

Conditioning conditioning(const IncrementalProblem& problem, int max_rows)
{
  const std::vector<Eigen::Index> rows = contactRows(problem.laws);
  Conditioning result;
  result.rows = static_cast<int>(rows.size());
  if (result.rows > max_rows || problem.velocities() > max_rows)
    return result;
  const Eigen::LLT<Eigen::MatrixXd> factor{Eigen::MatrixXd(problem.M)};
  if (factor.info() != Eigen::Success)
    throw std::invalid_argument("M is not positive definite");
  const Eigen::MatrixXd H = problem.H;
  Eigen::MatrixXd transposed(problem.velocities(), result.rows);  // Z^T = C^-1 H^T
  for (size_t k = 0; k < rows.size(); ++k)
    transposed.col(static_cast<Eigen::Index>(k)) = H.row(rows[k]);
  factor.matrixL().solveInPlace(transposed);
  if (transposed.size() == 0)
    return fromSpectrum(Eigen::VectorXd(), result.rows, 0.0, 2.0);
  return fromSpectrum(singularValues(transposed), result.rows, 0.0, 2.0);
}

Conditioning conditioning(const DelassusProblem& problem, int max_rows)
{
  const std::vector<Eigen::Index> rows = contactRows(problem.laws);
  Conditioning result;
  result.rows = static_cast<int>(rows.size());
  if (result.rows > max_rows)
    return result;
  if (rows.empty())
    return fromSpectrum(Eigen::VectorXd(), 0, 0.0, 1.0);
  const Eigen::MatrixXd W = problem.W.toDense();
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd symmetric(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      symmetric(i, j) = 0.5 * (W(rows[static_cast<size_t>(i)], rows[static_cast<size_t>(j)]) +
                               W(rows[static_cast<size_t>(j)], rows[static_cast<size_t>(i)]));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(symmetric, Eigen::EigenvaluesOnly);
  return fromSpectrum(spectrum.eigenvalues(), count, DBL_EPSILON * static_cast<double>(count), 1.0);
}

double relativeAsymmetry(const SparseRows& W)
{
  const double largest = largestEntry(W);
  return largest > 0.0 ? largestEntry(W - SparseRows(W.transpose())) / largest : 0.0;
}

double delassusDefect(const SparseRows& W)
{
  const double largest = largestEntry(W);
  if (largest == 0.0)
    return 0.0;
  const double asymmetry = relativeAsymmetry(W);
  // Such a shift makes what is semi-definite, but for round-off, definite.
  const Eigen::SparseMatrix<double> symmetric = 0.5 * (W + SparseRows(W.transpose()));
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;
  factor.setShift(static_cast<double>(W.rows()) * std::max(INDEFINITE, asymmetry) * largest);
  factor.compute(symmetric);
  return factor.info() == Eigen::Success ? asymmetry : std::numeric_limits<double>::infinity();
}

}  // namespace frictional_contact_sim
