#pragma once
/**
 * @file incremental_problem.h
 * @brief The incremental problem of one time step in Lagrangian coordinates with bilateral multipliers.
 *
 *     M v + f = H^T r + G^T lambda      u = H v + w      G v + b = 0      (u_i, r_i) in law_i
 *
 * Source: Cadoux (2009), (1.31)-(1.33) and (2.12). FCLib has the transpose of H and the opposite f; that is converted
 * in problem/fclib.h and nowhere else.
 */
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "frictional_contact_sim/problem/law.h"
#include "frictional_contact_sim/problem/law_scale.h"

namespace frictional_contact_sim
{
/// Compressed row storage, the storage of every sparse matrix of a problem.
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct IncrementalProblem
{
  SparseRows M;  ///< nv x nv, symmetric positive definite, both triangles stored [generalized kg]
  Eigen::VectorXd f;  ///< nv, -M v_k + dt (bias - applied) [N s]
  SparseRows H;  ///< rowCount(laws) x nv, contact rows (normal, tangent 1, tangent 2) [-]
  Eigen::VectorXd w;  ///< rowCount(laws), velocity of external objects plus the law's shift [m/s]
  std::vector<Law> laws;  ///< one law a contact or one-dimensional row, in the order of the rows of H
  SparseRows G;  ///< nb x nv, bilateral rows (may have zero rows)
  Eigen::VectorXd b;  ///< nb [m/s]
  std::vector<LawScale> scales;  ///< one a law, from a simulation; empty: a bare problem
  std::vector<LawScale> bilateral_scales;  ///< the same of the rows of G

  int velocities() const { return static_cast<int>(f.size()); }
  int rows() const { return static_cast<int>(w.size()); }
  int bilaterals() const { return static_cast<int>(b.size()); }
};

/** @brief Unknowns of an incremental problem. A local problem leaves v and lambda empty. */
struct Solution
{
  Eigen::VectorXd v;  ///< nv, generalized velocities at the end of the step
  Eigen::VectorXd u;  ///< rows, relative velocities [m/s]
  Eigen::VectorXd r;  ///< rows, impulses [N s]
  Eigen::VectorXd lambda;  ///< nb, bilateral impulses [N s]
};

/**
 * @brief Checks shapes, finiteness, signs of coefficients.
 * @throws std::invalid_argument naming the field, what was found and what was expected.
 */
void validate(const IncrementalProblem& problem);

}  // namespace frictional_contact_sim
