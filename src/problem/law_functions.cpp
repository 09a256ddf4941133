#include "frictional_contact_sim/problem/law_functions.h"

#include <cmath>

namespace frictional_contact_sim
{
namespace
{
template <int D>
double coulombError(double mu, const double* u_data, const double* r_data, double rho, double* e)
{
  // Take-off, the law of most contacts of loose heaps: 0 - P(-u~) is exactly zero.
  if (u_data[0] >= 0.0 && Eigen::Map<const Vector<D>>(r_data).isZero(0.0) &&
      Eigen::Map<const Vector<D>>(u_data).allFinite())
  {
    if (e != nullptr)
      Eigen::Map<Vector<D>>(e, D).setZero();
    return 0.0;
  }
  const Vector<D> u = deSaxce<D>(Eigen::Map<const Vector<D>>(u_data), mu);
  const Vector<D> r = Eigen::Map<const Vector<D>>(r_data);
  // Divided by rho before projecting (the cone is a cone): no huge intermediate values when rho is large.
  const Vector<D> scaled = r / rho;
  const Vector<D> error = scaled - projectOntoCone<D>(scaled - u, mu);
  if (e != nullptr)
    Eigen::Map<Vector<D>>(e, D) = error;
  return error.norm();
}
}  // namespace

void projectImpulse(const Law& law, double* r)
{
  if (law.type == LawType::COULOMB_3D)
  {
    Eigen::Map<Vector<3>> impulse(r);
    impulse = projectOntoCone<3>(impulse, law.coefficient);
  }
  else if (law.type == LawType::COULOMB_2D)
  {
    Eigen::Map<Vector<2>> impulse(r);
    impulse = projectOntoCone<2>(impulse, law.coefficient);
  }
  else
    *r = projectOntoLaw(law, *r);
}

double deSaxceShift(const Law& law, const double* u)
{
  if (law.type == LawType::COULOMB_3D)
    return law.coefficient * std::hypot(u[1], u[2]);
  if (law.type == LawType::COULOMB_2D)
    return law.coefficient * std::abs(u[1]);
  return 0.0;
}

double naturalMapError(const Law& law, const double* u, const double* r, double rho, double* e)
{
  if (law.type == LawType::COULOMB_3D)
    return coulombError<3>(law.coefficient, u, r, rho, e);
  if (law.type == LawType::COULOMB_2D)
    return coulombError<2>(law.coefficient, u, r, rho, e);
  const double error = law.type == LawType::BILATERAL ? *u : (*r - projectOntoLaw(law, *r - rho * *u)) / rho;
  if (e != nullptr)
    *e = error;
  return std::abs(error);
}

double largestEigenvalue(const SquareMatrix<1>& block)
{
  return block(0, 0);
}

double largestEigenvalue(const SquareMatrix<2>& block)
{
  const double mean = 0.5 * (block(0, 0) + block(1, 1));
  return mean + std::hypot(0.5 * (block(0, 0) - block(1, 1)), 0.5 * (block(0, 1) + block(1, 0)));
}

double largestEigenvalue(const SquareMatrix<3>& block)
{
  // Trigonometric form of the cubic's roots (Smith 1961): for symmetric matrices always three real ones.
  const double xy = 0.5 * (block(0, 1) + block(1, 0));
  const double xz = 0.5 * (block(0, 2) + block(2, 0));
  const double yz = 0.5 * (block(1, 2) + block(2, 1));
  const double mean = block.trace() / 3.0;
  const double a = block(0, 0) - mean;
  const double b = block(1, 1) - mean;
  const double c = block(2, 2) - mean;
  const double spread = std::sqrt((a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0);
  if (!(spread > 0.0))
    return mean;
  const double determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
  const double cosine = std::clamp(determinant / (2.0 * spread * spread * spread), -1.0, 1.0);
  return mean + 2.0 * spread * std::cos(std::acos(cosine) / 3.0);
}

}  // namespace frictional_contact_sim
