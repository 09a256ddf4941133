/**
 * @file fclib_solve.cpp
 * @brief fclib_solve FILE.hdf5: solves one friction problem in FCLib format and reports (docs/interfaces.md).
 * Exit 0 converged, 1 not converged, 2 bad input.
 */
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "frictional_contact_sim/problem/certificate/conditioning.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/registry.h"
#include "tool_support.h"

namespace
{
using namespace frictional_contact_sim;

/// Entries of W - W' above this share of the largest of W are worth a warning; below, they are round-off of who wrote
/// it.
constexpr double SYMMETRIC = 1e-9;

struct Arguments
{
  std::string file;
  std::string solver = "portfolio";
  std::vector<std::string> options;
  std::string operator_name = toString(OperatorKind::AUTOMATIC);
  std::string output;
  std::string history;
  StoppingOptions stopping;
  int repeat = 1;
  bool json = false;
  bool list = false;
};

/** Cold solves in one process; result is the last one with the median time. */
void solveRepeatedly(Solver& solver, const FclibProblem& problem, int repeat, SolverResult& result)
{
  tools::ProgressBar progress(repeat > 1 ? repeat : 0, repeat > 1 ? "" : "solving");
  std::vector<double> seconds;
  for (int k = 0; k < repeat && (k == 0 || !tools::stop_requested); ++k)
  {
    if (problem.kind == FclibKind::LOCAL)
      solver.solve(problem.local, nullptr, result);
    else
      solver.solve(problem.global, nullptr, result);
    seconds.push_back(result.seconds);
    progress.update(k + 1);
  }
  std::sort(seconds.begin(), seconds.end());
  const size_t middle = seconds.size() / 2;
  result.seconds = seconds.size() % 2 == 1 ? seconds[middle] : 0.5 * (seconds[middle - 1] + seconds[middle]);
}

/** An unsymmetric W is solved as it is; whoever wrote it should know. (That of a global problem is symmetric.) */
void warnOfAsymmetry(const std::string& file, const FclibProblem& problem)
{
  if (problem.kind != FclibKind::LOCAL || problem.local.W.rows() == 0)
    return;
  const double asymmetry = relativeAsymmetry(problem.local.W.toSparse());
  if (asymmetry > SYMMETRIC)
    std::fprintf(stderr, "warning: %s: W is not symmetric, |W - W'| is %.2g of |W|; solved as it is\n", file.c_str(),
                 asymmetry);
}

Diagnostics diagnoseAnswer(const FclibProblem& problem, const SolverResult& result)
{
  if (problem.kind == FclibKind::LOCAL)
    return diagnose(problem.local.laws, problem.local.q, result.solution.u, result.solution.r);
  DelassusReduction reduction;
  reduction.compute(problem.global, OperatorKind::MATRIX_FREE);
  return diagnose(problem.global.laws, reduction.problem().q, result.solution.u, result.solution.r);
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

bool isSameFile(const std::string& a, const std::string& b)
{
  return std::filesystem::exists(a) && std::filesystem::exists(b) && std::filesystem::equivalent(a, b);
}

void writeHistory(const Arguments& arguments, const SolverResult& result, std::ostream& file)
{
  if (arguments.history.empty())
    return;
  file << "iteration,seconds,residual\n";
  for (const HistoryEntry& entry : result.history)
    file << tools::historyRow(entry) << '\n';
  if (!file.flush())
    throw std::runtime_error("cannot write " + arguments.history);
}

int run(const Arguments& arguments)
{
  if (arguments.list)
  {
    std::cout << describeSolvers();
    return tools::SUCCESS;
  }
  if (arguments.file.empty())
    throw std::invalid_argument("FILE is missing, expected an FCLib file (see --help)");
  if (isSameFile(arguments.output, arguments.file))
    throw std::invalid_argument("--output " + arguments.output + " is FILE itself, expected another file");
  if (isSameFile(arguments.history, arguments.file))
    throw std::invalid_argument("--history " + arguments.history + " is FILE itself, expected another file");
  if (!arguments.history.empty() && arguments.history == arguments.output)
    throw std::invalid_argument("--history " + arguments.history + " is --output as well, expected another file");
  const std::unique_ptr<Solver> solver = createSolver(arguments.solver, tools::parseOptions(arguments.options));
  StoppingOptions stopping = arguments.stopping;
  stopping.operator_kind = operatorKind(arguments.operator_name);
  stopping.record_history = !arguments.history.empty();
  stopping.stop = &tools::stop_requested;
  tools::stopOnSignals();
  solver->setStopping(stopping);
  tools::expectNoFolder(arguments.file, "an FCLib file (compare_solvers takes folders)");
  const FclibProblem problem = readFclib(arguments.file);
  warnOfAsymmetry(arguments.file, problem);
  std::ofstream history;
  if (stopping.record_history)
    history = tools::openOutput(arguments.history);
  SolverResult result;
  solveRepeatedly(*solver, problem, arguments.repeat, result);
  writeAnswer(arguments, problem, result);
  writeHistory(arguments, result, history);
  report(arguments, problem, result);
  if (tools::stop_requested)
    return tools::INTERRUPTED;
  return result.status == SolverStatus::CONVERGED ? tools::SUCCESS : tools::NOT_CONVERGED;
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app(
      "Solves a frictional contact problem in FCLib format (local or global, 2D or 3D, with bilaterals).\n"
      "Exit 0: converged, 1: not converged, 2: bad input, 130: ended by SIGINT or SIGTERM, the best iterate is "
      "written.",
      "fclib_solve");
  app.add_option("FILE", arguments.file, "FCLib file (HDF5); never changed");
  app.add_option("--solver", arguments.solver, "method, one of --list-solvers")->capture_default_str();
  tools::addOptionOption(app, arguments.options, "NAME=VALUE of the method, repeated; one of --list-solvers");
  app.add_option("--operator", arguments.operator_name,
                 "storage of W: automatic, dense, sparse; matrix_free (global files, methods that use products)")
      ->capture_default_str();
  tools::addSolveOptions(app, arguments.stopping, arguments.repeat);
  app.add_option("--output", arguments.output, "write the problem with its solution here");
  app.add_option("--history", arguments.history,
                 "write the residual at every iterate the methods judged, last the answer's, to this CSV file:\n"
                 "iteration,seconds,residual (of the last solve of --repeat)");
  app.add_flag("--json", arguments.json, "one JSON object on one line");
  app.add_flag("--list-solvers", arguments.list, "list the methods with their options and leave");
  return tools::runTool(app, argc, argv, [&] { return run(arguments); });
}
