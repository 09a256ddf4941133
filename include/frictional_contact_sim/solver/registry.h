#pragma once
/**
 * @file registry.h
 * @brief The one table of methods. A new solver = one file + one row.
 */
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/solver/solver.h"

namespace frictional_contact_sim
{
struct SolverEntry
{
  const char* name;  ///< key for parameters, YAML and --solver
  std::unique_ptr<Solver> (*create)();  ///< with default options
  const char* summary;  ///< one line
  const char* reference;  ///< author, year, equation
  OperatorUse uses;  ///< what it needs of W, as create()->operatorUse() says
};

/** @brief All methods, in the order of docs/interfaces.md. */
const std::vector<SolverEntry>& solverRegistry();

/** @throws std::invalid_argument on an unknown name; the message lists the valid ones. */
std::unique_ptr<Solver> createSolver(const std::string& name);

}  // namespace frictional_contact_sim
