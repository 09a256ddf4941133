#include "existence_certificate.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace frictional_contact_sim
{
namespace
{
constexpr double EPSILON = std::numeric_limits<double>::epsilon();  // twice the unit round-off, so generous

/** A number with a bound on its error. */
struct Bounded
{
  double value = 0.0;
  double error = 0.0;
};

/** Row j of A times x, plus offset. */
Bounded rowValue(const SparseRows& A, int j, const Eigen::VectorXd& x, double offset)
{
  Bounded result;
  double products = 0.0;
  int count = 0;
  for (SparseRows::InnerIterator entry(A, j); entry; ++entry, ++count)
  {
    const double product = entry.value() * x[entry.col()];
    result.value += product;
    products += std::abs(product);
  }
  result.value += offset;
  // Without products the value is the offset itself, exactly: that is how w = 0 is certified by v = 0.
  if (products > 0.0)
    result.error = (count + 2) * EPSILON * (products + std::abs(offset));
  return result;
}

double rowNorm(const SparseRows& A, int j)
{
  return A.row(j).norm();
}
}  // namespace

BilateralCorrection::BilateralCorrection(const ContactKinematics& kinematics) : kinematics_(kinematics)
{
  if (kinematics.E.rows() > 0)
    pseudo_inverse_ = Eigen::MatrixXd(kinematics.E).completeOrthogonalDecomposition().pseudoInverse();
}

double BilateralCorrection::apply(Eigen::VectorXd& v) const
{
  if (kinematics_.E.rows() == 0)
    return 0.0;
  const Eigen::VectorXd defect = kinematics_.E * v + kinematics_.b;
  v -= pseudo_inverse_ * defect;
  double squares = 0.0;
  for (int j = 0; j < kinematics_.E.rows(); ++j)
  {
    const Bounded row = rowValue(kinematics_.E, j, v, kinematics_.b[j]);
    squares += (std::abs(row.value) + row.error) * (std::abs(row.value) + row.error);
  }
  // The Frobenius norm is above the largest singular value, with room for its own round-off.
  return 1.01 * pseudo_inverse_.norm() * std::sqrt(squares);
}

double verifiedMargin(const ContactKinematics& kinematics, const Eigen::VectorXd& v, double distance)
{
  double margin = std::numeric_limits<double>::infinity();
  for (const DualCone& cone : kinematics.cones)
  {
    const Bounded normal = rowValue(kinematics.H, cone.row, v, kinematics.w[cone.row]);
    double value = normal.value - normal.error - rowNorm(kinematics.H, cone.row) * distance * (1.0 + 1e-12);
    if (cone.dimension > 1 && cone.friction > 0.0)
    {
      double squares = 0.0;
      for (int j = cone.row + 1; j < cone.row + cone.dimension; ++j)
      {
        const Bounded tangent = rowValue(kinematics.H, j, v, kinematics.w[j]);
        const double largest =
            std::abs(tangent.value) + tangent.error + rowNorm(kinematics.H, j) * distance * (1.0 + 1e-12);
        squares += largest * largest;
      }
      value -= cone.friction * std::sqrt(squares) * (1.0 + 8.0 * EPSILON);
      value -= 2.0 * EPSILON * std::abs(normal.value);
    }
    margin = std::min(margin, value);
  }
  return margin;
}

double roundOffMissing(const ContactKinematics& kinematics, const Eigen::VectorXd& v, double distance, double& change)
{
  double worst = 0.0;
  change = 0.0;
  for (const DualCone& cone : kinematics.cones)
  {
    double missing = 0.0, size = 0.0, squares = 0.0;
    for (int j = cone.row; j < cone.row + cone.dimension; ++j)
    {
      const Bounded row = rowValue(kinematics.H, j, v, kinematics.w[j]);
      const double slack = row.error + rowNorm(kinematics.H, j) * distance * (1.0 + 1e-12);
      double products = std::abs(kinematics.w[j]);
      for (SparseRows::InnerIterator entry(kinematics.H, j); entry; ++entry)
        products += std::abs(entry.value() * v[entry.col()]);
      if (j == cone.row)
      {
        missing = -(row.value - slack);
        size = products;
      }
      else if (cone.friction > 0.0)
      {
        squares += (std::abs(row.value) + slack) * (std::abs(row.value) + slack);
        size += cone.friction * products;
      }
    }
    missing += cone.friction * std::sqrt(squares) * (1.0 + 8.0 * EPSILON);
    if (missing <= 0.0)
      continue;
    change = std::max(change, missing);
    worst = std::max(worst, size > 0.0 ? missing / (EPSILON * size) : std::numeric_limits<double>::infinity());
  }
  return worst;
}

Eigen::VectorXd contradiction(const ContactKinematics& kinematics)
{
  const Eigen::MatrixXd E = kinematics.E;
  const Eigen::VectorXd nearest = E.completeOrthogonalDecomposition().solve(Eigen::VectorXd(-kinematics.b));
  Eigen::VectorXd lambda = -(kinematics.b + E * nearest);
  const double size = lambda.norm();
  if (size > 0.0)
    lambda /= size;
  return lambda;
}

double verifiedExclusion(const ContactKinematics& kinematics, Eigen::VectorXd& r, const Eigen::VectorXd& lambda)
{
  for (const DualCone& cone : kinematics.cones)
  {
    r[cone.row] = std::max(0.0, r[cone.row]);
    const double length = r.segment(cone.row + 1, cone.dimension - 1).norm();
    const double allowed = cone.friction * r[cone.row] * (1.0 - 16.0 * EPSILON);
    if (length > allowed)
      r.segment(cone.row + 1, cone.dimension - 1) *= allowed / length * (1.0 - 16.0 * EPSILON);
  }
  double value = 0.0, magnitude = 0.0;
  for (Eigen::Index j = 0; j < r.size(); ++j)
  {
    value += r[j] * kinematics.w[j];
    magnitude += std::abs(r[j] * kinematics.w[j]);
  }
  for (Eigen::Index j = 0; j < lambda.size(); ++j)
  {
    value += lambda[j] * kinematics.b[j];
    magnitude += std::abs(lambda[j] * kinematics.b[j]);
  }
  const auto terms = static_cast<double>(r.size() + lambda.size() + 2);
  value += terms * EPSILON * magnitude;
  if (!(value < 0.0))
    return 0.0;
  const Eigen::VectorXd z = kinematics.H.transpose() * r + kinematics.E.transpose() * lambda;
  const Eigen::VectorXd sizes =
      kinematics.H.cwiseAbs().transpose() * r.cwiseAbs() + kinematics.E.cwiseAbs().transpose() * lambda.cwiseAbs();
  const double slope = z.lpNorm<1>() + terms * EPSILON * sizes.sum();
  return slope > 0.0 ? -value / slope : std::numeric_limits<double>::infinity();
}

}  // namespace frictional_contact_sim
