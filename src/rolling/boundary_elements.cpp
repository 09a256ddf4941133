#include "frictional_contact_sim/rolling/boundary_elements.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
constexpr double PI = 3.14159265358979323846;

/// Integrals over s in [s1, s2] of powers of s, d and r^2 = s^2 + d^2, needed by both kernels.
struct LineIntegrals
{
  double angle;  ///< int d/r^2
  double log_r;  ///< int ln r
  double log_ratio;  ///< int s/r^2
  double twist;  ///< [s d/r^2]
  double drop;  ///< [d^2/r^2]
};

LineIntegrals integrateLine(double s1, double s2, double d, bool on_element, double length_unit)
{
  const double r1 = s1 * s1 + d * d, r2 = s2 * s2 + d * d;  // squares
  LineIntegrals line{};
  // The angle under which the element is seen, with the sign of d; stable for small d beside the element.
  line.angle = on_element ? 0.0 : std::atan2(d * (s2 - s1), d * d + s1 * s2);
  const double log1 = r1 > 0.0 ? 0.5 * std::log(r1) - std::log(length_unit) : 0.0;
  const double log2 = r2 > 0.0 ? 0.5 * std::log(r2) - std::log(length_unit) : 0.0;
  line.log_r = s2 * log2 - s1 * log1 - (s2 - s1) + d * line.angle;
  line.log_ratio = log2 - log1;
  line.twist = s2 * d / r2 - s1 * d / r1;
  line.drop = d * d / r2 - d * d / r1;
  return line;
}
}  // namespace

KernelIntegrals integrateKernels(const Eigen::Vector2d& point, const Eigen::Vector2d& begin, const Eigen::Vector2d& end,
                                 bool on_element, const PlaneStrainMaterial& material, double length_unit)
{
  const double length = (end - begin).norm();
  const Eigen::Vector2d t = (end - begin) / length;
  const Eigen::Vector2d n(t.y(), -t.x());
  const double d = on_element ? 0.0 : (begin - point).dot(n);
  const double s1 = (begin - point).dot(t);
  const LineIntegrals line = integrateLine(s1, s1 + length, d, on_element, length_unit);
  const double nu = material.poisson_ratio;

  // In the frame (t, n) of the element: r,t = s/r and r,n = d/r.
  const double displacement_factor = 1.0 / (8.0 * PI * material.shearModulus() * (1.0 - nu));
  Eigen::Matrix2d U;
  U(0, 0) = -(3.0 - 4.0 * nu) * line.log_r + (length - d * line.angle);
  U(1, 1) = -(3.0 - 4.0 * nu) * line.log_r + d * line.angle;
  U(0, 1) = U(1, 0) = d * line.log_ratio;

  const double traction_factor = -1.0 / (4.0 * PI * (1.0 - nu));
  Eigen::Matrix2d T;
  T(0, 0) = (1.0 - 2.0 * nu) * line.angle + line.angle - line.twist;
  T(1, 1) = (1.0 - 2.0 * nu) * line.angle + line.angle + line.twist;
  const double skew = (1.0 - 2.0 * nu) * line.log_ratio;
  T(0, 1) = -line.drop - skew;
  T(1, 0) = -line.drop + skew;

  Eigen::Matrix2d frame;  // columns t, n
  frame << t, n;
  return {displacement_factor * frame * U * frame.transpose(), traction_factor * frame * T * frame.transpose()};
}

BoundaryMatrices assembleBoundaryMatrices(const Contour& contour, const PlaneStrainMaterial& material,
                                          double length_unit)
{
  contour.validate();
  material.validate();
  const Eigen::Index n = contour.size();
  if (length_unit <= 0.0)
    length_unit = 8.0 * (contour.begin.rowwise().maxCoeff() - contour.begin.rowwise().minCoeff()).maxCoeff();
  BoundaryMatrices matrices;
  matrices.H.resize(2 * n, 2 * n);
  matrices.G.resize(2 * n, 2 * n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i)
    {
      const KernelIntegrals kernel =
          integrateKernels(contour.middle(i), contour.begin.col(j), contour.end.col(j), i == j, material, length_unit);
      matrices.G.block<2, 2>(2 * i, 2 * j) = kernel.displacement;
      matrices.H.block<2, 2>(2 * i, 2 * j) = kernel.traction;
      if (i == j)
        matrices.H.block<2, 2>(2 * i, 2 * j) += 0.5 * Eigen::Matrix2d::Identity();
    }
  return matrices;
}

BoundarySolution solveBoundaryProblem(const BoundaryMatrices& matrices, const std::vector<bool>& displacement_given,
                                      const Eigen::VectorXd& given)
{
  const Eigen::Index n = matrices.H.rows();
  if (given.size() != n || static_cast<Eigen::Index>(displacement_given.size()) != n)
    throw std::invalid_argument("boundary values: found " + std::to_string(given.size()) + ", expected " +
                                std::to_string(n));
  // Unknown tractions are counted in units that give both kinds of columns the same size.
  const double unit = matrices.H.norm() / matrices.G.norm();
  Eigen::MatrixXd A = matrices.H;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k)
    if (displacement_given[static_cast<size_t>(k)])
    {
      A.col(k) = -unit * matrices.G.col(k);
      right -= matrices.H.col(k) * given[k];
    }
    else
      right += matrices.G.col(k) * given[k];
  const Eigen::VectorXd unknown = A.partialPivLu().solve(right);
  BoundarySolution solution{given, given};
  for (Eigen::Index k = 0; k < n; ++k)
    if (displacement_given[static_cast<size_t>(k)])
      solution.t[k] = unit * unknown[k];
    else
      solution.u[k] = unknown[k];
  return solution;
}

}  // namespace frictional_contact_sim
