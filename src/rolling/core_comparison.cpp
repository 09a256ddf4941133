#include "frictional_contact_sim/rolling/core_comparison.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <stdexcept>

#include "frictional_contact_sim/solver/registry.h"

namespace frictional_contact_sim
{
CoreProblem poseForTheCore(const ContactFlexibility& flexibility, const Eigen::VectorXd& friction,
                           const Eigen::VectorXd& d_N, const Eigen::VectorXd& d_T)
{
  const ContactFlexibility& F = flexibility;
  const Eigen::Index n = F.size();
  if (n == 0 || d_N.size() != n || d_T.size() != n || (friction.size() != n && friction.size() != 1))
    throw std::invalid_argument("core problem: found " + std::to_string(d_N.size()) + " and " +
                                std::to_string(d_T.size()) + " displacements and " + std::to_string(friction.size()) +
                                " friction values for " + std::to_string(n) + " nodes");
  const double unit = F.NN.cwiseAbs().rowwise().sum().maxCoeff();
  const double depth = std::max(-d_N.minCoeff(), d_T.cwiseAbs().maxCoeff());
  if (!(depth > 0.0))
    throw std::invalid_argument("core problem: nothing is pressed in or moved");
  CoreProblem core;
  core.traction_unit = depth / unit;
  core.problem.q.resize(2 * n);
  Eigen::MatrixXd W(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    core.problem.laws.push_back({LawType::COULOMB_2D, friction[friction.size() == 1 ? 0 : i]});
    core.problem.q.segment<2>(2 * i) << d_N[i] / depth, d_T[i] / depth;
    for (Eigen::Index j = 0; j < n; ++j)
      W.block<2, 2>(2 * i, 2 * j) << F.NN(i, j) / unit, F.NT(i, j) / unit, F.TN(i, j) / unit, F.TT(i, j) / unit;
  }
  core.problem.W.assign(W, core.problem.laws);
  return core;
}

CoreComparison compareWithCore(const CoreProblem& core, const FrictionalContact& contact, const std::string& solver,
                               double tolerance, const SolverOptions& options)
{
  const std::unique_ptr<Solver> method = createSolver(solver, options);
  StoppingOptions stopping;
  stopping.tolerance = tolerance;
  stopping.max_iterations = 100000;
  method->setStopping(stopping);
  const std::clock_t start = std::clock();
  const SolverResult result = method->solve(core.problem);
  CoreComparison comparison;
  comparison.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  comparison.solver = solver;
  comparison.status = toString(result.status);
  comparison.iterations = result.iterations;
  for (Eigen::Index i = 0; i < contact.r_N.size(); ++i)
    comparison.difference =
        std::max({comparison.difference, std::abs(result.solution.r[2 * i] * core.traction_unit - contact.r_N[i]),
                  std::abs(result.solution.r[2 * i + 1] * core.traction_unit - contact.r_T[i])});
  comparison.difference /= std::max(contact.r_N.maxCoeff(), std::numeric_limits<double>::min());
  return comparison;
}

}  // namespace frictional_contact_sim
