#pragma once
/**
 * @file core_comparison.h
 * @brief The same contact as a local problem of the friction core, and what the core's solvers make of it.
 *
 *   u = W r + q,  (u_i, r_i) in COULOMB_2D,   W = F, q = (d_N, d_T), nodes interleaved (N, T):
 * relative displacement plays the part of velocity, traction that of impulse. Divided by units that make displacements
 * and W of order one.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/rolling/frictional_lcp.h"
#include "frictional_contact_sim/solver/solver_options.h"

namespace frictional_contact_sim
{
struct CoreProblem
{
  DelassusProblem problem;
  double traction_unit = 1.0;  ///< r of the core times this is a traction [Pa]
};

/** @param friction n values or one for all [-] */
CoreProblem poseForTheCore(const ContactFlexibility& flexibility, const Eigen::VectorXd& friction,
                           const Eigen::VectorXd& d_N, const Eigen::VectorXd& d_T);

struct CoreComparison
{
  std::string solver;
  std::string status;
  double difference = 0.0;  ///< largest of |r_N - r_N'|, |r_T - r_T'| over the peak pressure [-]
  int iterations = 0;
  double seconds = 0.0;  ///< CPU time [s]
};

/**
 * @brief Solves with a solver of the registry and compares with the answer of the nonsymmetric LCP.
 * @throws std::invalid_argument on an unknown name or option
 */
CoreComparison compareWithCore(const CoreProblem& core, const FrictionalContact& contact, const std::string& solver,
                               double tolerance, const SolverOptions& options = {});

}  // namespace frictional_contact_sim
