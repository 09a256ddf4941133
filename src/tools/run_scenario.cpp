// run_scenario FILE.yaml: runs a scenario in process, as fast as it can, and says how it went.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/simulation/csv_recorder.h"
#include "frictional_contact_sim/simulation/scenario_files.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/simulator.h"
#include "frictional_contact_sim/simulation/state_file.h"
#include "frictional_contact_sim/solver/registry.h"
#include "run_report.h"
#include "tool_support.h"

namespace fcs = frictional_contact_sim;
using fcs::tools::RunSummary;
using fcs::tools::stop_requested;

namespace
{
struct Options
{
  std::string file;
  double duration = -1.0;
  double time_step = -1.0;
  std::string solver;
  std::vector<std::string> solver_options;
  bool list_solvers = false;
  std::string output;
  bool json_output = false;
  bool summary = false;
  int repeat = 1;
  std::string dump;
  int dump_every = 1;
  bool dump_local = false;
  std::string on_failure;
  bool no_fallback = false;
  std::string load_state;
  std::string save_state;
};

const std::string START = "impact at the start";

/** NAME_CONTACTS_STEP.hdf5 of the step just done, whatever became of its solve; steps without rows have no problem.
 *  @return its path, or empty */
std::string dumpProblem(const fcs::Simulator& simulator, const Options& options)
{
  const fcs::IncrementalProblem& problem = simulator.problem();
  if (problem.rows() == 0)
    return "";
  const fcs::StepSummary& report = simulator.report();
  const std::string& name = simulator.scenario().name;
  const std::string step = std::to_string(report.step);
  fcs::FclibInfo info;
  info.title = name + " step " + step;
  info.description = "one time step of " + std::to_string(report.dt) +
                     " s; w (q) contains the shift of the normal law (gap/dt, restitution); joint limits, bounded "
                     "servos and dry joint friction are encoded as problem/fclib.h says; no solution is stored";
  const std::string path = options.dump + "/" + name + "_" + std::to_string(report.contacts) + "_" + step + ".hdf5";
  if (options.dump_local)
    fcs::writeFclib(path, fcs::reduce(problem), info);
  else
    fcs::writeFclib(path, problem, info);
  return path;
}

/** @return false when the run ends with the outcome: it failed, and the policy is not to go on. */
bool judge(const fcs::Simulator& simulator, const Options& options, const std::string& what, RunSummary& summary,
           fcs::tools::ProgressBar& progress)
{
  const fcs::StepOutcome& outcome = simulator.outcome();
  if (outcome.converged() || outcome.status == fcs::SolverStatus::STOPPED_BY_USER)
    return outcome.taken;
  ++summary.failed_steps;
  summary.worst_residual = std::max(summary.worst_residual, outcome.residual);
  const fcs::FailurePolicy policy = simulator.failurePolicy();
  summary.ended = policy == fcs::FailurePolicy::STOP || policy == fcs::FailurePolicy::PAUSE;
  const std::string file = summary.ended && !options.dump.empty() ? dumpProblem(simulator, options) : "";
  const auto lock = progress.pause();
  if (summary.ended || what == START)
    std::cerr << "run_scenario: " << what << " at " << simulator.time() << " s: " << toString(outcome.status)
              << ", residual " << outcome.residual << ", " << outcome.message
              << (file.empty() ? "" : ", problem in " + file)
              << (summary.ended ? "; ended, as failure: {policy: " + std::string(toString(policy)) +
                                      "} says (--on-failure hold or accept goes on)"
                                : "")
              << '\n';
  return !summary.ended;
}

long countSteps(const fcs::Scenario& scenario)
{
  const double count = std::round(scenario.duration / scenario.time_step);
  if (!(count < 1e12) || (count < 1.0 && scenario.duration > 0.0))
    throw std::invalid_argument("duration / time_step is " + std::to_string(count) + " steps, expected 1 to 1e12");
  return static_cast<long>(count);
}

/** @param repeat number of this run, from 0: all have one bar */
RunSummary run(fcs::Simulator& simulator, const Options& options, int repeat, fcs::tools::ProgressBar& progress)
{
  RunSummary summary;
  summary.loading_seconds = simulator.loadingSeconds();
  const long total = countSteps(simulator.scenario());
  bool going = judge(simulator, options, START, summary, progress);
  std::unique_ptr<fcs::CsvRecorder> recorder;
  if (!options.output.empty())
    recorder = std::make_unique<fcs::CsvRecorder>(options.output);
  if (recorder)
    recorder->record(simulator, false);
  const auto start = std::chrono::steady_clock::now();
  while (going && summary.steps < total && !stop_requested)
  {
    const bool taken = simulator.step().taken;
    const fcs::StepSummary& report = simulator.report();
    going = judge(simulator, options, "step " + std::to_string(report.step), summary, progress);
    if (!options.dump.empty() && !summary.ended && !stop_requested && (summary.steps + 1) % options.dump_every == 0)
      dumpProblem(simulator, options);
    if (!taken)
      continue;
    summary.worst_residual = std::max(summary.worst_residual, report.residual);
    summary.max_penetration = std::max(summary.max_penetration, report.max_penetration);
    summary.max_bilateral_violation = std::max(summary.max_bilateral_violation, report.bilateral_violation);
    if (recorder)
      recorder->record(simulator, true);
    if (summary.steps++ % 100 == 0)
      progress.update(repeat * total + summary.steps);
  }
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (recorder)
    recorder->close();
  summary.hash = simulator.stateHash();
  return summary;
}

fcs::Scenario load(const Options& options)
{
  fcs::Scenario scenario = fcs::loadScenarioFile(fcs::findScenario(options.file));
  if (std::isnan(options.duration) || std::isnan(options.time_step))
    throw std::invalid_argument("--duration and --time-step take finite numbers");
  if (options.duration >= 0.0)
    scenario.duration = options.duration;
  if (options.time_step > 0.0)
    scenario.time_step = options.time_step;
  if (!options.solver.empty() && options.solver != scenario.solver)
  {
    scenario.solver = options.solver;
    scenario.solver_options.clear();  // the file's are of another method
  }
  for (const auto& [name, value] : fcs::tools::parseOptions(options.solver_options))
    scenario.solver_options[name] = value;
  if (!options.on_failure.empty())
    scenario.failure.policy = fcs::parseFailurePolicy(options.on_failure);
  scenario.failure.fallback = scenario.failure.fallback && !options.no_fallback;
  scenario.stopping.stop = &stop_requested;
  return scenario;
}

int runAll(const Options& options)
{
  if (options.list_solvers)
  {
    std::cout << fcs::describeSolvers();
    return fcs::tools::SUCCESS;
  }
  if (options.file.empty())
    throw std::invalid_argument("FILE is missing, expected a scenario (see --help)");
  const fcs::Scenario scenario = load(options);
  if (!options.dump.empty())
    fcs::tools::makeFolder(options.dump);
  std::unique_ptr<fcs::Simulator> simulator;
  std::vector<RunSummary> runs;
  auto progress = std::make_unique<fcs::tools::ProgressBar>(options.repeat * countSteps(scenario), scenario.name);
  for (int i = 0; i < options.repeat && (i == 0 || !stop_requested); ++i)
  {
    simulator = std::make_unique<fcs::Simulator>(scenario);
    if (i == 0)
      for (const std::string& warning : simulator->warnings())
      {
        const auto lock = progress->pause();
        std::cerr << "warning: " << warning << '\n';
      }
    if (!options.load_state.empty())
      fcs::loadState(*simulator, options.load_state);
    runs.push_back(run(*simulator, options, i, *progress));
  }
  progress.reset();
  const bool identical = std::all_of(
      runs.begin(), runs.end(), [&](const RunSummary& summary) { return summary.hash == runs.front().hash; });
  std::sort(runs.begin(), runs.end(), [](const RunSummary& a, const RunSummary& b) { return a.seconds < b.seconds; });
  const RunSummary& median = runs[runs.size() / 2];
  if (options.summary || (!options.json_output && isatty(STDOUT_FILENO) != 0))
    std::cout << fcs::tools::summarize(*simulator, median, identical);
  else
    std::cout << fcs::tools::describe(*simulator, median, identical).dump(options.json_output ? -1 : 2) << '\n';
  if (!options.save_state.empty())
    fcs::saveState(*simulator, options.save_state);
  if (stop_requested)
    std::cerr << "run_scenario: interrupted after " << median.steps << " steps\n";
  if (stop_requested)
    return fcs::tools::INTERRUPTED;
  return median.failed_steps == 0 ? fcs::tools::SUCCESS : fcs::tools::NOT_CONVERGED;
}
}  // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app(
      "Runs a scenario as fast as it can. On a terminal it prints a summary, else one JSON object. Exit 0: every step "
      "converged, 1: one did "
      "not, 2: bad input, 130: ended by SIGINT or SIGTERM (files and JSON are of the steps done).",
      "run_scenario");
  app.add_option("FILE", options.file, "scenario (YAML), or the name of one in config/scenarios");
  app.add_option("--duration", options.duration, "simulated time instead of the file's [s]")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--time-step", options.time_step, "instead of the file's [s]")
      ->check(CLI::Range(fcs::timeStepRange().lower, fcs::timeStepRange().upper));
  app.add_option("--solver", options.solver, "registry name instead of the file's");
  fcs::tools::addOptionOption(app, options.solver_options,
                              "NAME=VALUE of the method, repeated, besides the file's; one of --list-solvers");
  app.add_flag("--list-solvers", options.list_solvers, "list the methods with their options and leave");
  app.add_option("--on-failure", options.on_failure,
                 "instead of the file's failure policy: stop (default) and pause end the run at the first failed step "
                 "with the state before it, hold and accept go on and count them")
      ->check(CLI::IsMember({"stop", "pause", "hold", "accept"}));
  app.add_flag("--no-fallback", options.no_fallback, "no other method is tried where the solver fails");
  app.add_option("--output", options.output, "folder for states.csv, joints.csv, contacts.csv, steps.csv");
  CLI::Option* line = app.add_flag("--json", options.json_output, "the JSON object on one line, on a terminal too");
  app.add_flag("--summary", options.summary,
               "what stands where, and whether the run can be trusted, in a few lines; the default on a terminal")
      ->excludes(line);
  app.add_option("--repeat", options.repeat,
                 "runs; the median time is printed, and whether all runs gave the same bits")
      ->check(CLI::Range(1, 100000));
  CLI::Option* dump = app.add_option("--dump", options.dump,
                                     "folder for the friction problems of steps as FCLib files "
                                     "SCENARIO_CONTACTS_STEP.hdf5, converged or not");
  app.add_option("--dump-every", options.dump_every, "steps N, 2N, 3N, ... are dumped")
      ->check(CLI::Range(1, 1000000000))
      ->needs(dump);
  app.add_flag("--dump-local", options.dump_local,
               "dump the local problem (W, q) instead of the global one (M, f, H, w)")
      ->needs(dump);
  app.add_option("--save-state", options.save_state, "file for the state at the end: --load-state goes on from it");
  app.add_option("--load-state", options.load_state,
                 "start from this state of the same bodies instead of the scenario's start; --duration is then what is "
                 "simulated further")
      ->check(CLI::ExistingFile);
  return fcs::tools::runTool(app, argc, argv,
                             [&]
                             {
                               fcs::tools::stopOnSignals();
                               return runAll(options);
                             });
}
