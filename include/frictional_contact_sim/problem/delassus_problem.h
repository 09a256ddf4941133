#pragma once
/**
 * @file delassus_problem.h
 * @brief The local problem: u = W r + q, (u_i, r_i) in law_i.   Source: Cadoux (2009), (1.34).
 *
 * W = H M^-1 H^T is symmetric positive semi-definite (rows x rows); q = w - H M^-1 f [m/s]. Bilateral rows of a global
 * problem appear as BILATERAL laws.
 */
#include <Eigen/Core>
#include <vector>

#include "frictional_contact_sim/problem/delassus_operator.h"
#include "frictional_contact_sim/problem/incremental_problem.h"
#include "frictional_contact_sim/problem/law.h"

namespace frictional_contact_sim
{
struct DelassusProblem
{
  DelassusOperator W;  ///< rows x rows; dense when small, block-sparse otherwise
  Eigen::VectorXd q;  ///< rows, free relative velocity [m/s]
  std::vector<Law> laws;  ///< in the order of the rows
  std::vector<LawScale> scales;  ///< one a law, from a simulation; empty: a bare problem
};

/** @throws std::invalid_argument naming the field, what was found and what was expected. */
void validate(const DelassusProblem& problem);

}  // namespace frictional_contact_sim
