#pragma once
/**
 * @file judge.h
 * @brief What "solved" means, the same for both sides: judged from W, q, mu and the impulses alone.
 *
 *   RESIDUAL   E <= value, E of docs/residuals.md by test/support/validator.h (shares no code with the solvers)
 *   THESIS     1/(2 n d) |f_AC(u, r)|^2 < value with rho = 1, Cadoux (2009), (5.1), f_AC of (1.23), (1.24); Coulomb
 * only
 */
#include <string>

#include "frictional_contact_sim/problem/delassus_problem.h"

namespace comparison
{
enum class Criterion
{
  RESIDUAL,
  THESIS
};

struct Target
{
  Criterion criterion = Criterion::RESIDUAL;
  double value = 1e-8;

  /** @brief "1e-08" or "thesis 1e-06". */
  std::string label() const;
};

/** @brief Reads "1e-8" or "thesis:1e-6". @throws std::invalid_argument */
Target parseTarget(const std::string& text);

struct Judgement
{
  double residual = 0.0;  ///< E
  double thesis = 0.0;  ///< (5.1)

  bool meets(const Target& target) const;
};

Judgement judge(const frictional_contact_sim::DelassusProblem& problem, const Eigen::VectorXd& r);

}  // namespace comparison
