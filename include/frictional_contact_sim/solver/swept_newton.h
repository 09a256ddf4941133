#pragma once
/**
 * @file swept_newton.h
 * @brief Newton steps, each followed by sweeps of Gauss-Seidel: for problems of many contacts.
 *
 *   d     the step of solver/semismooth_newton.h (Alart-Curnier) centred at r, with alpha D
 *   r_t   P_K(r + t d), then `sweeps` conjugate sweeps (solver/gauss_seidel.h),   t = 1, 0.3, 0.1, 0.03
 *   r     <- the first r_t with E(r_t) <= sufficient E(r), else the best of them unless it is `worst` times worse than
 * r alpha <- 0.3 alpha after a sufficient full step, x 5 when no t was sufficient, from proximal_max back to
 *            proximal_restart, which is ten times smaller every time
 * The Newton step moves what is far (chains of contacts, bodies), which sweeps do slowly; after a long step a few
 * contacts of thousands have the wrong status, which a line search answers with tiny t and sweeps repair at the cost of
 * a product each. Measured on packings of 1000 contacts, 3 seeds, after 60 sweeps: 6 to 11 factorizations where the
 * line search needs 84 and more; on 3000 and more it may stall. The best iterate is returned. No key of the registry: a
 * part of the portfolio.
 *
 * Source: Silcowitz, Niebe, Erleben (2010), "Projected Gauss-Seidel subspace minimization method for interactive rigid
 * body dynamics". Departures: a Newton step with slip instead of a least-squares problem on the active rows, exact
 * blocks instead of projected rows, the acceptance rule.
 */
#include <memory>

#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/semismooth_newton.h"

namespace frictional_contact_sim
{
struct SweptNewtonOptions
{
  int sweeps = 100;  ///< after each trial step, >= 1
  double proximal_start = 1e-4;  ///< first alpha, relative to the Delassus entries [-], > 0
  double proximal_max = 1e-2;  ///< largest alpha [-]
  double proximal_restart = 3e-5;  ///< where it goes on from there, the first time [-], > 0
  double sufficient = 0.7;  ///< accepted ratio of residuals [-], in (0, 1)
  double worst = 3.0;  ///< ratio at which a trial is refused [-], >= 1

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class SweptNewton : public SemismoothNewton
{
public:
  explicit SweptNewton(const SweptNewtonOptions& options = {});

protected:
  std::unique_ptr<Solver> sibling() const override;
  void doSolve(const DelassusProblem& problem, SolverResult& result) override;

private:
  double trial(const DelassusProblem& problem, const Eigen::VectorXd& r, double t);
  double search(const DelassusProblem& problem, const Eigen::VectorXd& r, double value, double& length);
  void adaptAlpha(bool sufficient, bool full);

  SweptNewtonOptions options_;
  GaussSeidel gauss_seidel_;
  double restart_ = 0.0;  ///< alpha after proximal_max
  SolverResult swept_;  ///< the present trial
  Eigen::VectorXd found_;  ///< the best trial of a step
};

}  // namespace frictional_contact_sim
