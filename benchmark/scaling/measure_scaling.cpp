/**
 * @file measure_scaling.cpp
 * @brief Command measure_scaling: time and memory of methods on granular packings of growing size.
 *
 * Packings of balls on a lattice (problem/rigid_families.h), one child process a size and method. Timed, CPU time of
 * one core, cold: the reduction to W, and the whole call solve(global problem) with everything a first call allocates.
 * Memory is what the process grows by while it solves, at its peak, the problem itself not counted. E is the package's
 * own: the independent validator is dense and serves up to DENSE_CONTACTS contacts.
 */
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "comparison/isolation.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/rigid_families.h"
#include "frictional_contact_sim/solver/registry.h"
#include "support/validator.h"
#include "tools/tool_support.h"

namespace
{
using namespace frictional_contact_sim;
using namespace comparison;

constexpr int DENSE_CONTACTS = 300;
constexpr double KILL_FACTOR = 2.0;  ///< one factorization may outlast the limit: the process is ended then
constexpr double REPEAT_TIME = 0.5;  ///< short solves are repeated for so long and the least time kept [s]

struct Arguments
{
  std::vector<int> contacts = {10, 100, 1000, 3000, 10000, 50000};
  std::vector<std::string> solvers = {"portfolio", "haslinger", "gauss_seidel"};
  double tolerance = 1e-8;
  double time_limit = 120.0;
  std::string output = ".";
};

struct Row
{
  int velocities, iterations;
  bool converged;
  double residual, validator, reduction, solve, megabytes;
  char status[32];
};

/** Resident memory of this process, now [MB]. */
double residentMemory()
{
  std::ifstream file("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  file >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/** Largest it has been [MB]. */
double peakMemory()
{
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1e3;
}

void fill(const Arguments& arguments, const std::string& name, int contacts, Row& row)
{
  const IncrementalProblem problem = granularProblem(contacts, 0, {});
  row.velocities = problem.velocities();
  StoppingOptions stopping;
  stopping.tolerance = arguments.tolerance;
  stopping.max_iterations = 1000000;
  stopping.time_limit = arguments.time_limit;
  const double before = residentMemory();
  limitCpuTime(KILL_FACTOR * arguments.time_limit + 5.0);
  double used = 0.0;
  row.solve = row.reduction = 1e300;
  SolverResult result;
  do
  {
    const std::unique_ptr<Solver> solver = createSolver(name);
    solver->setStopping(stopping);
    result = SolverResult();
    const double start = cpuTime();
    solver->solve(problem, nullptr, result);
    const double seconds = cpuTime() - start;
    row.solve = std::min(row.solve, seconds);
    used += seconds;
    row.megabytes = std::max(row.megabytes, peakMemory() - before);
  } while (used < REPEAT_TIME);
  row.iterations = result.iterations;
  row.converged = result.status == SolverStatus::CONVERGED;
  row.residual = result.residual;
  std::snprintf(row.status, sizeof(row.status), "%s", toString(result.status));
  used = 0.0;
  do
  {
    DelassusReduction reduction;
    const double start = cpuTime();
    reduction.compute(problem);
    const double seconds = cpuTime() - start;
    row.reduction = std::min(row.reduction, seconds);
    used += seconds;
  } while (used < 0.2 * REPEAT_TIME);
  row.validator = -1.0;
  if (contacts <= DENSE_CONTACTS)
    row.validator =
        test_support::validateAnswer(problem, result.solution.v, result.solution.r, result.solution.lambda).worst();
}

void run(const Arguments& arguments)
{
  for (const std::string& name : arguments.solvers)
    createSolver(name);
  std::filesystem::create_directories(arguments.output);
  std::ofstream csv(arguments.output + "/scaling.csv");
  if (!csv)
    throw std::runtime_error(arguments.output + "/scaling.csv: cannot be written");
  csv << "contacts,velocities,solver,status,residual,validator,iterations,reduction_seconds,seconds,megabytes\n";
  tools::ProgressBar bar(static_cast<long>(arguments.contacts.size() * arguments.solvers.size()));
  long done = 0;
  for (const std::string& name : arguments.solvers)
    for (const int contacts : arguments.contacts)
    {
      bar.update(done++, name + " with " + std::to_string(contacts) + " contacts");
      SharedMemory memory(sizeof(Row));
      Row& row = *memory.as<Row>();
      const Ending ending = runIsolated([&] { fill(arguments, name, contacts, row); });
      csv << contacts << ',' << row.velocities << ',' << name << ','
          << (ending == Ending::FINISHED     ? row.status
              : ending == Ending::TIME_LIMIT ? toString(SolverStatus::TIME_LIMIT)
                                             : "CRASHED")
          << ',' << row.residual << ',' << row.validator << ',' << row.iterations << ',' << row.reduction << ','
          << row.solve << ',' << row.megabytes << std::endl;
    }
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app("Time and memory of methods on granular packings of growing size; writes scaling.csv.",
               "measure_scaling");
  app.add_option("--contacts", arguments.contacts, "sizes")->delimiter(',')->capture_default_str();
  app.add_option("--solvers", arguments.solvers, "our methods")->delimiter(',')->capture_default_str();
  app.add_option("--tolerance", arguments.tolerance, "on E [-]")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--time-limit", arguments.time_limit, "of a solve [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--output", arguments.output, "folder of the CSV")->capture_default_str();
  return tools::runTool(app, argc, argv,
                        [&]
                        {
                          run(arguments);
                          return tools::SUCCESS;
                        });
}
