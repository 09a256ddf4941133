#include "frictional_contact_sim/solver/convex/convex_problem.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "frictional_contact_sim/math/cone.h"

namespace frictional_contact_sim
{
namespace
{
SimpleSet oneDimensionalSet(const Law& law)
{
  if (law.type == LawType::UNILATERAL)
    return {SetType::HALF_LINE, 1, 0.0};
  if (law.type == LawType::DRY_FRICTION)
    return {SetType::INTERVAL, 1, law.coefficient};
  return {SetType::LINE, 1, 0.0};
}

void prepare(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths, ConvexProblem& convex)
{
  convex.W = &problem.W;
  convex.c = problem.q;
  convex.step_lengths = step_lengths;
  convex.sets.resize(problem.laws.size());
}

template <int D>
void projectOntoConeOrCylinder(const SimpleSet& set, double* data)
{
  Eigen::Map<Vector<D>> r(data);
  if (set.type == SetType::CONE)
  {
    r = projectOntoCone<D>(r, set.parameter);
    return;
  }
  r[0] = std::max(r[0], 0.0);
  r.template tail<D - 1>() = projectOntoBall<D - 1>(r.template tail<D - 1>(), set.parameter);
}
}  // namespace

void makeConeProblem(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths, ConvexProblem& convex)
{
  prepare(problem, step_lengths, convex);
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    const Law& law = problem.laws[i];
    convex.sets[i] =
        law.isCoulomb() ? SimpleSet{SetType::CONE, law.dimension(), law.coefficient} : oneDimensionalSet(law);
  }
}

void makeCylinderProblem(const DelassusProblem& problem, const Eigen::VectorXd& step_lengths,
                         const Eigen::VectorXd& thresholds, ConvexProblem& convex)
{
  prepare(problem, step_lengths, convex);
  for (size_t i = 0; i < problem.laws.size(); ++i)
  {
    const Law& law = problem.laws[i];
    const double threshold = thresholds[static_cast<Eigen::Index>(i)];
    convex.sets[i] =
        law.isCoulomb() ? SimpleSet{SetType::CYLINDER, law.dimension(), threshold} : oneDimensionalSet(law);
  }
}

void fillMetric(const ConvexProblem& problem, Metric metric, Eigen::VectorXd& diagonal)
{
  diagonal.setOnes(problem.W->rows());
  if (metric == Metric::BLOCK)
    for (int i = 0; i < problem.W->blocks(); ++i)
      diagonal.segment(problem.W->offset(i), problem.W->dimension(i)).setConstant(problem.step_lengths[i]);
}

void projectOntoSet(const SimpleSet& set, double* r)
{
  switch (set.type)
  {
    case SetType::CONE:
    case SetType::CYLINDER:
      if (set.dimension == 3)
        projectOntoConeOrCylinder<3>(set, r);
      else
        projectOntoConeOrCylinder<2>(set, r);
      return;
    case SetType::HALF_LINE:
      *r = std::max(*r, 0.0);
      return;
    case SetType::INTERVAL:
      *r = std::clamp(*r, -set.parameter, set.parameter);
      return;
    case SetType::LINE:
      return;
  }
}

void projectOntoSets(const ConvexProblem& problem, Eigen::VectorXd& r)
{
  for (int i = 0; i < problem.W->blocks(); ++i)
    projectOntoSet(problem.sets[static_cast<size_t>(i)], r.data() + problem.W->offset(i));
}

double optimalityError(const ConvexProblem& problem, const Eigen::VectorXd& u, const Eigen::VectorXd& r)
{
  double largest = 0.0;
  for (int i = 0; i < problem.W->blocks(); ++i)
  {
    // Scaled by 1/rho before projecting, so that a huge rho does not swallow u.
    const double inverse = 1.0 / problem.step_lengths[i];
    SimpleSet set = problem.sets[static_cast<size_t>(i)];
    if (set.type == SetType::CYLINDER || set.type == SetType::INTERVAL)
      set.parameter *= inverse;
    const int first = problem.W->offset(i);
    std::array<double, 3> scaled{}, projected{};
    for (int k = 0; k < set.dimension; ++k)
    {
      scaled[static_cast<size_t>(k)] = inverse * r[first + k];
      projected[static_cast<size_t>(k)] = scaled[static_cast<size_t>(k)] - u[first + k];
    }
    projectOntoSet(set, projected.data());
    double square = 0.0;
    for (int k = 0; k < set.dimension; ++k)
      square += std::pow(scaled[static_cast<size_t>(k)] - projected[static_cast<size_t>(k)], 2);
    // Not std::max: a NaN must not be lost.
    if (!(square <= largest) && !std::isnan(largest))
      largest = square;
  }
  return std::sqrt(largest);
}

}  // namespace frictional_contact_sim
