#pragma once
/**
 * @file lcp_lemke.h
 * @brief The incremental problem as a linear complementarity problem, solved by pivoting: exact in 2D.
 *
 *   y = A x + b,  0 <= x orthogonal y >= 0,   by laws:
 *   COULOMB_2D    x = (r_N, l+, e-)         y = (u_N, e+, l-)            r_T = l+ - l-, mu r_N = l+ + l-, u_T = e+ - e-
 *   COULOMB_3D    x = (r_N, b_1..b_K, s)    y = (u_N, s + d_k.u_T, mu r_N - sum b)      r_T = sum b_k d_k
 *   UNILATERAL    x = r, y = u              DRY_FRICTION  x = (l+, e-), y = (e+, l-), c = l+ + l-
 *   Coulomb with mu = 0 is UNILATERAL on its normal row; BILATERAL rows are eliminated first (least squares).
 * For 2D contacts A is (4.2) with the rows in the order that pairs x and y:
 *   A = [ W_NN - W_NT D, 2 W_NT, 0 ; W_TN - W_TT D, 2 W_TT, I ; D, -I, 0 ],  b = (q_N, q_T, 0),  D = diag(mu)
 * (here contact by contact, which is a permutation, and with each law's rows scaled by sqrt(rho_i)).
 *
 * form = stewart writes a planar contact as a spatial one with the two directions +-1: x = (r_N, b+, b-, s), y = (u_N,
 * s + u_T, s - u_T, mu r_N - b+ - b-). Its matrix is copositive, x^T A x = r^T W r, which (4.2) is not: where a
 * solution exists by the criterion of chapter 3, for w = 0 above all, Lemke's path cannot end on a ray (theorem 4.6;
 * Cottle, Pang, Stone 1992, 4.4.13). One unknown more a contact.
 *
 * In 3D the cone is replaced by the polyhedral cone on K = facets directions d_k; a sliding direction between two of
 * them is wrong by up to pi/K. The problem is solved again with the directions of each sliding contact turned so that
 * one opposes its slip velocity, at most `alignments` times: at a fixed point of that the answer is exact. The residual
 * is that of the exact cone in any case. Operator: W dense, of size rows x rows; LCP size 3 n (2D), (K + 2) n (3D).
 *
 * Source: Cadoux (2009), lemma 4.1 (the print exchanges two rows of (4.3)); Stewart, Trinkle (1996) and Anitescu, Potra
 * (1997) for the polyhedral cone; Stewart (1998); Lemke (1965). Departure: the alignment of facets.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/solver/lemke.h"
#include "frictional_contact_sim/solver/option_table.h"
#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
enum class LcpMethod
{
  LEMKE,
  PRINCIPAL_PIVOTING
};

/** @brief How a planar contact with friction is written. */
enum class LcpForm
{
  REDUCED,  ///< (4.2): three unknowns a contact
  STEWART  ///< four, copositive
};

struct LcpLemkeOptions
{
  LcpMethod method = LcpMethod::LEMKE;
  LcpForm form = LcpForm::REDUCED;
  int facets = 8;  ///< K, directions of the polyhedral cone in 3D, even, >= 4
  int alignments = 40;  ///< solves with turned directions after the first, >= 0
  int max_size = 2500;  ///< largest LCP tried; above it the method fails at once, >= 1
  LcpOptions pivoting;

  /** @brief What each is, as data. */
  static const OptionTable<LcpLemkeOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

/** @brief The LCP of a local problem, and the way back:  r = R x + r_0. */
struct ContactLcp
{
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  Eigen::MatrixXd R;  ///< rows x size
  Eigen::VectorXd r0;  ///< rows [N s]
};

/**
 * @brief Builds the LCP. @param angles of the first direction of each law [rad], read for COULOMB_3D only
 * @param scale multiplies each law's impulse rows: r_i = scale_i r'_i, u'_i = scale_i u_i; ones for the plain matrices
 */
ContactLcp makeContactLcp(const DelassusProblem& problem, int facets, const Eigen::VectorXd& angles,
                          const Eigen::VectorXd& scale, LcpForm form = LcpForm::REDUCED);

class LcpLemke : public Solver
{
public:
  explicit LcpLemke(const LcpLemkeOptions& options = {});
  OperatorUse operatorUse() const override { return OperatorUse::DENSE; }

protected:
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  bool align(const DelassusProblem& problem, const Eigen::VectorXd& r, double damping);

  LcpLemkeOptions options_;
  Eigen::VectorXd angles_, u_, r_;
};

}  // namespace frictional_contact_sim
