#pragma once
/**
 * @file registry.h
 * @brief The one table of methods. A new solver = one file + one row.
 */
#include <memory>
#include <string>
#include <vector>

#include "frictional_contact_sim/solver/solver.h"
#include "frictional_contact_sim/solver/solver_options.h"

namespace frictional_contact_sim
{
/** @brief A row: what the table says, and how the method is made. Options are those of the table beside the method. */
struct SolverEntry
{
  const char* name;  ///< key for parameters, YAML and --solver
  std::unique_ptr<Solver> (*create)();  ///< with default options
  const char* summary;  ///< one line
  const char* reference;  ///< author, year, equation
  OperatorUse uses;  ///< what it needs of W, as create()->operatorUse() says
  const std::vector<SolverOption>& (*options)();  ///< what it can be told
  /** @brief With these options. @throws std::invalid_argument in one line that names method, option and value */
  std::unique_ptr<Solver> (*configure)(const std::string& name, const SolverOptions& options);
};

/** @brief All methods, in the order of docs/interfaces.md. */
const std::vector<SolverEntry>& solverRegistry();

/** @throws std::invalid_argument on an unknown name; the message lists the valid ones, the nearest first. */
const SolverEntry& findSolver(const std::string& name);

/** @throws std::invalid_argument also on an unknown option, or a value that it does not take */
std::unique_ptr<Solver> createSolver(const std::string& name, const SolverOptions& options = {});

/** @brief One option by itself. @throws std::invalid_argument unless the method has it and takes the value */
void checkSolverOption(const std::string& solver, const std::string& option, const std::string& value);

/** @brief All methods with their options, as --list-solvers prints them. */
std::string describeSolvers();

}  // namespace frictional_contact_sim
