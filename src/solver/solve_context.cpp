#include "frictional_contact_sim/solver/solve_context.h"

#include "frictional_contact_sim/problem/residual.h"

namespace frictional_contact_sim
{
double SolveContext::seconds() const
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double SolveContext::residual(const DelassusProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r) const
{
  return lawResidual(problem.laws, metric, u, r);
}

}  // namespace frictional_contact_sim
