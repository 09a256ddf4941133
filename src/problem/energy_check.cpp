#include "frictional_contact_sim/problem/energy_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frictional_contact_sim
{
namespace
{
constexpr double FACTOR = 10.0;  ///< of the tolerance
constexpr double ROUND_OFF = 64.0 * std::numeric_limits<double>::epsilon();

double kineticEnergy(const IncrementalProblem& problem, const Eigen::VectorXd& v)
{
  double energy = 0.0;
  for (int i = 0; i < problem.M.outerSize(); ++i)
    for (SparseRows::InnerIterator entry(problem.M, i); entry; ++entry)
      energy += 0.5 * v[i] * entry.value() * v[entry.col()];
  return energy;
}

/** sum_i |r_i| (|H_i| |v| + |w_i|) */
double largestTerms(const IncrementalProblem& problem, const Solution& solution)
{
  double sum = 0.0;
  for (int i = 0; i < problem.rows(); ++i)
  {
    double speed = std::abs(problem.w[i]);
    for (SparseRows::InnerIterator entry(problem.H, i); entry; ++entry)
      speed += std::abs(entry.value() * solution.v[entry.col()]);
    sum += std::abs(solution.r[i]) * speed;
  }
  return sum;
}
}  // namespace

EnergyCheck checkEnergy(const IncrementalProblem& problem, const Solution& solution, double free_energy,
                        double tolerance)
{
  EnergyCheck check;
  check.work = solution.r.dot(solution.u);
  check.bound = FACTOR * tolerance * free_energy;
  if (!check.holds())
    check.bound = FACTOR * tolerance * std::max(free_energy, kineticEnergy(problem, solution.v)) +
                  ROUND_OFF * largestTerms(problem, solution);
  return check;
}

}  // namespace frictional_contact_sim
