#pragma once
/**
 * @file one_contact.h
 * @brief Exact solution of the problem of one law:  u = W r + q,  (u, r) in law;  W is D x D, D <= 3, positive
 * semi-definite.
 *
 * Coulomb, 2D and 3D, q [m/s], W [1/kg]:
 *   take-off   q_N >= 0:                 r = 0
 *   sticking   r = -W^-1 q in K_mu
 *   sliding    u_N = 0, |r_T| = mu r_N, u_T = -kappa r_T, kappa > 0. With S = W_TT - W_TN W_NT / W_NN and
 *              b = q_T - W_TN q_N / W_NN:
 *                  r_T(kappa) = -(S + kappa I)^-1 b,   r_N(kappa) = -(q_N + W_NT r_T(kappa)) / W_NN
 *              and kappa is the root of mu r_N(kappa) / |r_T(kappa)| = 1. At kappa = 0 the left side is below 1
 * (sticking has failed), for large kappa it grows without bound: a root always exists. (S + kappa I)^-1 is explicit and
 * 1/|r_T| almost linear in kappa, so a safeguarded Newton takes 3 to 6 evaluations of a dozen multiplications. In 2D
 * everything is in closed form. W need not be symmetric. UNILATERAL, DRY_FRICTION, BILATERAL: closed form.
 *
 * Source: Bonnefon, Daviet (2011) give the same root as a quartic in tan(theta/2); the scalar equation in kappa needs
 * no case distinction and does not lose digits. Cadoux (2009), 4.8.2, for its use contact by contact. Where W is
 * singular its diagonal is raised by 1e-12 of the trace of W (only S, and only then).
 */
#include "frictional_contact_sim/math/cone.h"
#include "frictional_contact_sim/problem/law.h"

namespace frictional_contact_sim
{
/** @brief The impulse of a Coulomb contact. */
Vector<3> solveCoulomb(const SquareMatrix<3>& W, const Vector<3>& q, double mu);
Vector<2> solveCoulomb(const SquareMatrix<2>& W, const Vector<2>& q, double mu);

/** @brief The impulse of a one-dimensional law; W > 0 (otherwise the previous impulse is projected and returned). */
double solveOneDimensional(const Law& law, double W, double q, double previous);

}  // namespace frictional_contact_sim
