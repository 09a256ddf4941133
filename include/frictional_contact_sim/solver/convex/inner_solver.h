#pragma once
/**
 * @file inner_solver.h
 * @brief The convex solvers by name, for methods that solve a convex problem in every iteration.
 */
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/solver/convex/convex_solver.h"

namespace frictional_contact_sim
{
enum class InnerSolver
{
  SPECTRAL_GRADIENT,
  PROJECTED_GRADIENT,
  ACCELERATED_GRADIENT,
  ADMM,
  INTERIOR_POINT
};

/** @brief Of the constants, in their order: spectral_gradient, projected_gradient, ... */
const std::vector<std::string>& innerSolverNames();

/** @brief With its default options. */
std::unique_ptr<ConvexSolver> createInnerSolver(InnerSolver which);

}  // namespace frictional_contact_sim
