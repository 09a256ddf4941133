/**
 * @file fclib_solve.cpp
 * @brief Command fclib_solve: solves one FCLib file and reports. INTERFACES.md, section 3.
 * Exit 0 converged, 1 not converged, 2 bad input.
 */
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/registry.h"

namespace
{
using namespace frictional_contact_sim;

constexpr int CONVERGED = 0;
constexpr int NOT_CONVERGED = 1;
constexpr int BAD_INPUT = 2;

struct Arguments
{
  std::string file;
  std::string solver = "portfolio";
  std::string output;
  StoppingOptions stopping;
  int repeat = 1;
  bool json = false;
  bool list = false;
};

void listSolvers()
{
  for (const SolverEntry& entry : solverRegistry())
    std::printf("%-16s %s (%s)\n", entry.name, entry.summary, entry.reference);
}

/** Cold solves in one process; result is the last one with the median time. */
void solveRepeatedly(Solver& solver, const FclibProblem& problem, int repeat, SolverResult& result)
{
  std::vector<double> seconds;
  for (int k = 0; k < repeat; ++k)
  {
    if (problem.kind == FclibKind::LOCAL)
      solver.solve(problem.local, nullptr, result);
    else
      solver.solve(problem.global, nullptr, result);
    seconds.push_back(result.seconds);
  }
  std::sort(seconds.begin(), seconds.end());
  const std::size_t middle = seconds.size() / 2;
  result.seconds = seconds.size() % 2 == 1 ? seconds[middle] : 0.5 * (seconds[middle - 1] + seconds[middle]);
}

Diagnostics diagnoseAnswer(const FclibProblem& problem, const SolverResult& result)
{
  if (problem.kind == FclibKind::LOCAL)
    return diagnose(problem.local.laws, problem.local.q, result.solution.u, result.solution.r);
  return diagnose(problem.global.laws, reduce(problem.global).q, result.solution.u, result.solution.r);
}

void report(const Arguments& arguments, const FclibProblem& problem, const SolverResult& result)
{
  const Diagnostics diagnostics = diagnoseAnswer(problem, result);
  const char* kind = problem.kind == FclibKind::LOCAL ? "local" : "global";
  if (arguments.json)
  {
    const nlohmann::ordered_json line = {{"file", arguments.file},
                                         {"kind", kind},
                                         {"contacts", problem.contacts},
                                         {"dimension", problem.dimension},
                                         {"solver", arguments.solver},
                                         {"status", toString(result.status)},
                                         {"iterations", result.iterations},
                                         {"residual", result.residual},
                                         {"siconos_error", diagnostics.siconos_error},
                                         {"natural_map_1q", diagnostics.natural_map_1q},
                                         {"seconds", result.seconds},
                                         {"tried", result.tried},
                                         {"message", result.message}};
    std::cout << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
    return;
  }
  std::printf("%s: %s, %d contacts in %dD, %s %s after %d iterations, residual %.3g, %.3g s%s%s\n",
              arguments.file.c_str(), kind, problem.contacts, problem.dimension, arguments.solver.c_str(),
              toString(result.status), result.iterations, result.residual, result.seconds,
              result.message.empty() ? "" : ": ", result.message.c_str());
}

void writeAnswer(const Arguments& arguments, const FclibProblem& problem, const SolverResult& result)
{
  if (arguments.output.empty())
    return;
  if (problem.kind == FclibKind::LOCAL)
    writeFclib(arguments.output, problem.local, problem.info, &result.solution);
  else
    writeFclib(arguments.output, problem.global, problem.info, &result.solution);
}

int run(const Arguments& arguments)
{
  if (arguments.list)
  {
    listSolvers();
    return CONVERGED;
  }
  if (arguments.file.empty())
    throw std::invalid_argument("FILE is missing, expected an FCLib file (see --help)");
  if (!arguments.output.empty() && std::filesystem::exists(arguments.output) &&
      std::filesystem::exists(arguments.file) && std::filesystem::equivalent(arguments.output, arguments.file))
    throw std::invalid_argument("--output " + arguments.output + " is FILE itself, expected another file");
  const std::unique_ptr<Solver> solver = createSolver(arguments.solver);
  solver->setStopping(arguments.stopping);
  const FclibProblem problem = readFclib(arguments.file);
  SolverResult result;
  solveRepeatedly(*solver, problem, arguments.repeat, result);
  writeAnswer(arguments, problem, result);
  report(arguments, problem, result);
  return result.status == SolverStatus::CONVERGED ? CONVERGED : NOT_CONVERGED;
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app(
      "Solves a frictional contact problem in FCLib format (local or global, 2D or 3D, with bilaterals).\n"
      "Exit 0: converged, 1: not converged, 2: bad input.");
  app.add_option("FILE", arguments.file, "FCLib file (HDF5); never changed");
  app.add_option("--solver", arguments.solver, "method, one of --list-solvers")->capture_default_str();
  app.add_option("--tolerance", arguments.stopping.tolerance, "on the residual E [-]")->capture_default_str();
  app.add_option("--max-iterations", arguments.stopping.max_iterations, "iterations of the method")
      ->capture_default_str();
  app.add_option("--time-limit", arguments.stopping.time_limit, "wall clock of a solve [s], 0 = none")
      ->capture_default_str();
  app.add_option("--repeat", arguments.repeat, "cold solves; seconds is their median")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--output", arguments.output, "write the problem with its solution here");
  app.add_flag("--json", arguments.json, "one JSON object on one line");
  app.add_flag("--list-solvers", arguments.list, "list the methods and leave");
  try
  {
    app.parse(argc, argv);
    return run(arguments);
  }
  catch (const CLI::ParseError& error)
  {
    if (error.get_exit_code() == 0)
      return app.exit(error);
    std::cerr << "fclib_solve: " << error.what() << "\n";
    return BAD_INPUT;
  }
  catch (const std::exception& error)
  {
    std::cerr << "fclib_solve: " << error.what() << "\n";
    return BAD_INPUT;
  }
}
