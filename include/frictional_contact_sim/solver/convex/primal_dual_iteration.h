#pragma once
/**
 * @file primal_dual_iteration.h
 * @brief One predictor-corrector iteration of the primal-dual interior point with Nesterov-Todd scaling.
 *
 *   W r + c = A^T z,   x = A r + a in Q,   z in Q,   x o z = 0          Q a product of Lorentz cones (lorentz_cone.h)
 *     CONE       x = (mu r_N, r_T)                     z = (u_N/mu, u_T)
 *     CYLINDER   x = r_N  and  x = (s, r_T)            z = u_N  and  z = (|u_T|, u_T)
 *     HALF_LINE  x = r         INTERVAL  x = (c, r)    LINE  no cone
 * With N^-1 x = N^T z = lambda the Newton step is
 *   (W + A^T N^-T N^-1 A) dr = -(W r + c - A^T z) + A^T N^-T (lambda \ d)
 *   predictor                  d = -lambda o lambda
 *   corrector (Mehrotra 1992)  d = sigma m e - lambda o lambda - dx_a o dz_a
 *
 * with m = lambda.lambda / number of cones, sigma = (1 - t_a)^3 and one step length t for r and z. Rows whose set is a
 * point (tangents at mu = 0, s = 0, c = 0) are held at zero by an infinite shift. The shifted matrix is positive
 * definite also when W is rank deficient. Operator: W explicit, one Cholesky factorization (ShiftedFactor) and two
 * solves an iteration, besides one product W r.
 *
 * The problem's c may change between two iterations (the outer s of Cadoux): it only enters the dual residual.
 * Source: Nesterov, Todd (1997); Vandenberghe (2010); Acary, Armand, Nguyen, Shpakovych (2022) for contact.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/solver/convex/convex_problem.h"
#include "frictional_contact_sim/solver/convex/lorentz_cone.h"
#include "frictional_contact_sim/solver/convex/shifted_factor.h"
#include "frictional_contact_sim/solver/option_table.h"

namespace frictional_contact_sim
{
struct PrimalDualOptions
{
  double step_fraction = 0.99;  ///< share of the way to the boundary taken [-], in (0, 1)
  double regularisation = 1e-14;  ///< added to the diagonal, relative to 1/rho_i [-], >= 0

  /** @brief What each is, as data. */
  static const OptionTable<PrimalDualOptions>& table();
  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class PrimalDualIteration
{
public:
  explicit PrimalDualIteration(const PrimalDualOptions& options = {});

  /**
   * @brief Sets the cones and an interior start; copies W.
   * @param r, u a guess and W r + c there
   * @param shift distance from the boundary [m/s]; at or above the largest |c| the guess is forgotten
   */
  void start(const ConvexProblem& problem, const Eigen::VectorXd& r, const Eigen::VectorXd& u, double shift);
  /**
   * @brief One iteration.
   * @param centring lower bound of the target sigma m [J]
   * @return the step length t, 0 when the factorization or the scaling broke down
   */
  double step(const ConvexProblem& problem, double centring = 0.0);

  const Eigen::VectorXd& r() const { return r_; }
  /** @brief W r + c with the c of the last start() or step(). */
  const Eigen::VectorXd& u() const { return u_; }
  /** @brief The independent dual velocity A^T z, in the dual set up to round-off [m/s]. */
  const Eigen::VectorXd& dualVelocity() const { return dual_; }
  /** @brief m, the mean of x.z [J]. */
  double complementarity() const;

private:
  struct Cone
  {
    int block;
    int head;  ///< row of x_0 = scale r_head, or -1 when x_0 is constant
    int tail;  ///< first row of x_T
    int dimension;
    double scale;  ///< mu, 1 for half-lines
    double constant;  ///< a_0
    LorentzScaling scaling;
    Vector<3> affine_x = Vector<3>::Zero();
    Vector<3> affine_z = Vector<3>::Zero();
    Vector<3> target = Vector<3>::Zero();
  };
  void makeCones(const ConvexProblem& problem);
  void addCone(int block, int head, int tail, int dimension, double scale, double constant);
  void startCone(const ConvexProblem& problem, Cone& cone, const Eigen::VectorXd& guess_u, double shift, double speed);
  void spectralShift(const ConvexProblem& problem);
  bool factor(const ConvexProblem& problem);
  Vector<3> toCone(const Cone& cone, const Eigen::VectorXd& rows) const;
  void fromCone(const Cone& cone, const Vector<3>& z, Eigen::VectorXd& rows) const;
  void updateDual();
  void direction();
  double longestStep() const;

  PrimalDualOptions options_;
  ShiftedFactor factor_;
  std::vector<Cone> cones_;
  struct FixedRow
  {
    int block, row;
  };
  std::vector<FixedRow> fixed_;  ///< rows held at zero
  std::vector<SquareMatrix<3>> bases_;
  Eigen::VectorXd shift_;
  double mean_step_length_ = 1.0;
  Eigen::VectorXd r_, u_, dual_, rhs_, dr_;
};

}  // namespace frictional_contact_sim
