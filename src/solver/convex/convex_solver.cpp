#include "frictional_contact_sim/solver/convex/convex_solver.h"

#include <stdexcept>

#include "frictional_contact_sim/solver/convex/accelerated_gradient.h"
#include "frictional_contact_sim/solver/convex/convex_admm.h"
#include "frictional_contact_sim/solver/convex/convex_interior_point.h"
#include "frictional_contact_sim/solver/convex/projected_gradient.h"
#include "frictional_contact_sim/solver/convex/spectral_gradient.h"

namespace frictional_contact_sim
{
namespace
{
template <typename Method>
std::unique_ptr<ConvexSolver> create()
{
  return std::make_unique<Method>();
}
}  // namespace

ConvexSolver::ConvexSolver(std::string name) : name_(std::move(name))
{
}

ConvexSolver::~ConvexSolver() = default;

ConvexResult ConvexSolver::solve(const ConvexProblem& problem, const ConvexBudget& budget, Eigen::VectorXd& r,
                                 Eigen::VectorXd& u)
{
  projectOntoSets(problem, r);
  problem.W->apply(r, u);
  u += problem.c;
  ConvexResult result;
  result.error = optimalityError(problem, u, r);
  if (result.error <= budget.tolerance)
  {
    result.status = ConvexStatus::CONVERGED;
    return result;
  }
  result = doSolve(problem, budget, r, u);
  if (result.error <= budget.tolerance)
    result.status = ConvexStatus::CONVERGED;
  return result;
}

const std::vector<ConvexSolverEntry>& convexSolverRegistry()
{
  static const std::vector<ConvexSolverEntry> registry = {
      {"projected_gradient", &create<ProjectedGradient>, "Goldstein (1964), Bertsekas (1976); Cadoux (2009), 4.7.2"},
      {"accelerated_gradient", &create<AcceleratedGradient>,
       "Beck, Teboulle (2009); O'Donoghue, Candes (2015); Mazhar et al. (2015)"},
      {"spectral_gradient", &create<SpectralGradient>, "Birgin, Martinez, Raydan (2000)"},
      {"convex_admm", &create<ConvexAdmm>, "Boyd et al. (2011); He, Yang, Wang (2000)"},
      {"convex_interior_point", &create<ConvexInteriorPoint>, "Nesterov, Todd (1997); Vandenberghe (2010)"},
  };
  return registry;
}

std::unique_ptr<ConvexSolver> createConvexSolver(const std::string& name)
{
  std::string valid;
  for (const ConvexSolverEntry& entry : convexSolverRegistry())
  {
    if (name == entry.name)
      return entry.create();
    valid += valid.empty() ? "" : ", ";
    valid += entry.name;
  }
  throw std::invalid_argument("unknown convex solver '" + name + "', expected one of: " + valid);
}

}  // namespace frictional_contact_sim
