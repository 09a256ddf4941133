#include "frictional_contact_sim/problem/law_functions.h"

#include <cmath>

namespace frictional_contact_sim
{
namespace
{
template <int D>
double length(double x, double y)
{
  return D == 3 ? std::sqrt(x * x + y * y) : std::abs(x);
}

/// r/rho - P(r/rho - u~), the projection written out: this runs for every contact in every iteration of every method.
/// Divided by rho before projecting (the cone is a cone): no huge intermediate values when rho is large.
template <int D>
double coulombError(double mu, const double* u, const double* r, double rho, double* e)
{
  const double u1 = u[1], u2 = D == 3 ? u[D - 1] : 0.0;
  const double shifted = u[0] + mu * length<D>(u1, u2);
  const double inverse = 1.0 / rho;
  const double r0 = inverse * r[0], r1 = inverse * r[1], r2 = D == 3 ? inverse * r[D - 1] : 0.0;
  const double y0 = r0 - shifted, y1 = r1 - u1, y2 = r2 - u2;
  const double tangential = length<D>(y1, y2);
  double e0 = r0, e1 = r1, e2 = r2;  // y in the polar cone: its projection is zero
  if (y0 >= 0.0 && tangential <= mu * y0)
  {
    e0 = shifted;
    e1 = u1;
    e2 = u2;
  }
  else if (!(mu * tangential <= -y0))
  {
    const double t = (y0 + mu * tangential) / (1.0 + mu * mu);
    const double turn = mu * t / tangential;
    e0 = r0 - t;
    e1 = r1 - turn * y1;
    e2 = r2 - turn * y2;
  }
  if (e != nullptr)
  {
    e[0] = e0;
    e[1] = e1;
    if (D == 3)
      e[D - 1] = e2;
  }
  return std::sqrt(e0 * e0 + e1 * e1 + e2 * e2);
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
  const double x = *r - rho * *u;
  // projectOntoLaw would turn a NaN into the zero of an open row.
  const double error = law.type == LawType::BILATERAL ? *u : std::isnan(x) ? x : (*r - projectOntoLaw(law, x)) / rho;
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
  const double half = 0.5 * (block(0, 0) - block(1, 1));
  const double coupling = 0.5 * (block(0, 1) + block(1, 0));
  return mean + std::sqrt(half * half + coupling * coupling);
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
