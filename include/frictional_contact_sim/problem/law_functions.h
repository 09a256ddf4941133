#pragma once
/**
 * @file law_functions.h
 * @brief Functions of one law: projection on its set of impulses, De Saxce shift, natural-map error, Alart-Curnier
 * function with Jacobians. All work on the law's 1 to 3 rows, nothing is allocated.
 *
 *   set of impulses P     COULOMB  K_mu    UNILATERAL  [0, inf)    DRY_FRICTION  [-c, c]    BILATERAL  R
 *   natural map           e_i = (r_i - P(r_i - rho_i u~_i)) / rho_i   [m/s], zero exactly when (u_i, r_i) is in the law
 *
 * u~ = u but for Coulomb, where u~ = u + mu |u_T| e_N. For one-dimensional laws the natural map and the Alart-Curnier
 * function (f = P(r - rho u) - r) are the same up to the factor -rho.
 *
 * Source: Cadoux (2009), (1.22)-(1.29), (4.8).
 */
#include <algorithm>

#include "frictional_contact_sim/math/contact_functions.h"
#include "frictional_contact_sim/problem/law.h"

namespace frictional_contact_sim
{
/** @brief Projection of x on a one-dimensional law's set of impulses. */
inline double projectOntoLaw(const Law& law, double x)
{
  if (law.type == LawType::UNILATERAL)
    return x > 0.0 ? x : 0.0;
  if (law.type == LawType::DRY_FRICTION)
    return std::clamp(x, -law.coefficient, law.coefficient);
  return x;
}

/** @brief Derivative of projectOntoLaw: 1 inside, 0 where it is clipped. */
inline double projectionSlope(const Law& law, double x)
{
  if (law.type == LawType::UNILATERAL)
    return x > 0.0 ? 1.0 : 0.0;
  if (law.type == LawType::DRY_FRICTION)
    return std::abs(x) < law.coefficient ? 1.0 : 0.0;
  return 1.0;
}

/** @brief Projects the law's impulse r (dimension() values) in place on the law's set. */
void projectImpulse(const Law& law, double* r);

/** @brief De Saxce's shift mu |u_T| of the normal component; 0 for one-dimensional laws [m/s]. */
double deSaxceShift(const Law& law, const double* u);

/**
 * @brief Natural-map error e_i of one law.
 * @param rho step length 1/lambda_max(W_ii) [kg], > 0
 * @param e the error's dimension() components [m/s], may be nullptr
 * @return its Euclidean norm [m/s]
 */
double naturalMapError(const Law& law, const double* u, const double* r, double rho, double* e = nullptr);

/** @brief Largest eigenvalue of the symmetric part of a law's diagonal block (D x D, given by rows). */
double largestEigenvalue(const SquareMatrix<1>& block);
double largestEigenvalue(const SquareMatrix<2>& block);
double largestEigenvalue(const SquareMatrix<3>& block);

/** @brief f = P(r - rho u) - r of a one-dimensional law with its derivatives. */
inline ContactFunction<1> oneDimensionalFunction(const Law& law, double u, double r, double rho)
{
  ContactFunction<1> f;
  const double x = r - rho * u;
  const double slope = projectionSlope(law, x);
  f.value[0] = projectOntoLaw(law, x) - r;
  f.by_u(0, 0) = -rho * slope;
  f.by_r(0, 0) = slope - 1.0;
  return f;
}

}  // namespace frictional_contact_sim
