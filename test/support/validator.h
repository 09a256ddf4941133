#pragma once
/**
 * @file validator.h
 * @brief A second opinion on every answer: E of docs/residuals.md, computed densely and from scratch.
 *
 * Shares no code with math, problem or solver: reads only (M, f, H, w, laws, G, b, v, r, lambda) or (W, q, laws, r).
 * The projection on the cone is found by minimising along the boundary ray in the plane of the argument instead of by
 * the closed form's cases, eigenvalues and M^-1 come from Eigen's dense decompositions.
 */
#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
namespace test_support
{
struct Verdict
{
  double law = 0.0;  ///< E of the laws
  double dynamics = 0.0;  ///< relative momentum defect
  double bilateral = 0.0;  ///< relative violation of G v + b = 0
  double worst() const;
};

Verdict validateAnswer(const IncrementalProblem& problem, const Eigen::VectorXd& v, const Eigen::VectorXd& r,
                       const Eigen::VectorXd& lambda);
Verdict validateAnswer(const DelassusProblem& problem, const Eigen::VectorXd& r);

}  // namespace test_support
}  // namespace frictional_contact_sim
