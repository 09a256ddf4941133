#pragma once
/**
 * @file swept_newton.h
 * @brief Newton steps, each followed by sweeps of Gauss-Seidel: for problems of many contacts.
 *
 *   d     the step of solver/semismooth_newton.h (Alart-Curnier) centred at r, with alpha D
 *   r     <- P_K(r + d), then m conjugate sweeps (solver/gauss_seidel.h), unless E(r) became `worst` times worse
 * alpha <- 0.3 alpha and m <- 0.7 m (at least its first value) after a step with E <= sufficient E before;
 *          5 alpha and 1.5 m after another; from proximal_max back to proximal_restart, ten times smaller every time
 * The Newton step moves what is far (chains of contacts, bodies), which sweeps do slowly; after a long step a few
 * contacts of thousands have the wrong status, which a line search answers with tiny t and sweeps repair at the cost of
 * a product each. Shorter steps than d, tried before, were worse than more sweeps after the whole one.
 * Measured on packings of 3000 contacts, 5 seeds, after 60 sweeps: 10 to 20 steps on four of them, a stall at 1e-7 on
 * the fifth, which sweeps and a second start solve; 10 000 contacts may stall at 1e-6. rho_N = rho_T = rho_i here, for
 * which fewer steps were needed than for the two of semismooth_newton.h. The best iterate is returned. No key of the
 * registry: a part of the portfolio.
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
  int sweeps = 100;  ///< least of the first m, which is a tenth of the number of laws within the two limits, >= 1
  int many_sweeps = 300;  ///< largest of the first m, >= sweeps
  int max_sweeps = 1000;  ///< largest m, >= many_sweeps
  double proximal_start = 1e-3;  ///< first alpha, relative to the Delassus entries [-], > 0
  double proximal_max = 1e-3;  ///< largest alpha [-]
  double proximal_restart = 1e-5;  ///< where it goes on from there, the first time [-], > 0
  double sufficient = 0.7;  ///< accepted ratio of residuals [-], in (0, 1)
  double worst = 3.0;  ///< ratio at which a step is refused [-], >= 1

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

class SweptNewton : public SemismoothNewton
{
public:
  explicit SweptNewton(const SweptNewtonOptions& options = {});

protected:
  std::unique_ptr<Solver> sibling() const override;
  void doSolve(const DelassusProblem& problem, const SolveContext& context, SolverResult& result) override;

private:
  using SemismoothNewton::setOptions;  // would set what this method sets itself
  double sweptStep(const DelassusProblem& problem, const SolveContext& context, const Eigen::VectorXd& r);
  void adapt(bool sufficient);

  SweptNewtonOptions options_;
  GaussSeidel gauss_seidel_;
  double restart_ = 0.0;  ///< alpha after proximal_max
  double sweeps_ = 0.0;  ///< m
  int first_sweeps_ = 0;  ///< its first and least value
  SolverResult swept_;  ///< where a step ends
};

}  // namespace frictional_contact_sim
