#pragma once
/**
 * @file tool_support.h
 * @brief What several command-line tools share: exit codes, clocks, options, the frame of main().
 */
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/solver/solver.h"
#include "frictional_contact_sim/solver/solver_options.h"
#include "progress_bar.h"

namespace frictional_contact_sim
{
namespace tools
{
/// docs/interfaces.md: 0 all well, 1 something did not converge, 2 bad input.
constexpr int SUCCESS = 0;
constexpr int NOT_CONVERGED = 1;
constexpr int BAD_INPUT = 2;
constexpr int INTERRUPTED = 130;  ///< SIGINT or SIGTERM: what is done is written, as the shell's convention has it

/** @brief Set by the first SIGINT or SIGTERM after stopOnSignals(); a solve that has it ends (StoppingOptions::stop).
 */
inline std::atomic<bool> stop_requested{false};

/** @brief A second signal ends the process at once. */
inline void stopOnSignals()
{
  struct sigaction action
  {
  };
  action.sa_handler = [](int) { stop_requested = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/** @brief CPU time of this thread [s]; does not count what other processes take. */
inline double threadSeconds()
{
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/** @brief --tolerance, --max-iterations, --time-limit and --repeat of the tools that solve FCLib files. */
inline void addSolveOptions(CLI::App& app, StoppingOptions& stopping, int& repeat)
{
  app.add_option("--tolerance", stopping.tolerance, "on the residual E [-]")->capture_default_str();
  app.add_option("--max-iterations", stopping.max_iterations, "iterations of a method")->capture_default_str();
  app.add_option("--time-limit", stopping.time_limit, "wall clock of a solve [s], 0 = none")->capture_default_str();
  app.add_option("--repeat", repeat, "cold solves; times are their medians")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
}

/** @brief --option, which may be given again and again. */
inline void addOptionOption(CLI::App& app, std::vector<std::string>& options, const std::string& text)
{
  app.add_option("--option", options, text)->type_name("NAME=VALUE")->allow_extra_args(false);
}

/** @brief Arguments NAME=VALUE as options of a method. @throws std::invalid_argument in one line */
inline SolverOptions parseOptions(const std::vector<std::string>& arguments)
{
  SolverOptions options;
  for (const std::string& argument : arguments)
  {
    const size_t equal = argument.find('=');
    if (equal == 0 || equal == std::string::npos)
      throw std::invalid_argument("--option: found '" + argument + "', expected NAME=VALUE");
    if (!options.emplace(argument.substr(0, equal), argument.substr(equal + 1)).second)
      throw std::invalid_argument("--option: found " + argument.substr(0, equal) + " twice, expected once");
  }
  return options;
}

/**
 * @brief Of arguments SOLVER.NAME=VALUE those of one solver among several; NAME=VALUE goes for all.
 * @throws std::invalid_argument in one line, also where SOLVER is not among them
 */
inline SolverOptions optionsOf(const std::string& solver, const std::vector<std::string>& solvers,
                               const std::vector<std::string>& arguments)
{
  SolverOptions options;
  for (const auto& [name, value] : parseOptions(arguments))
  {
    const size_t dot = name.find('.');
    const std::string owner = dot == std::string::npos ? solver : name.substr(0, dot);
    if (std::find(solvers.begin(), solvers.end(), owner) == solvers.end())
      throw std::invalid_argument("--option: found " + name + ", " + didYouMean(owner, solvers) +
                                  "expected one of the solvers compared: " + joinNames(solvers));
    if (owner == solver)
      options[dot == std::string::npos ? name : name.substr(dot + 1)] = value;
  }
  return options;
}

/** @brief Opens a file to write, before work is spent on what it will hold. @throws std::runtime_error in one line */
inline std::ofstream openOutput(const std::string& path)
{
  std::ofstream file(path);
  if (!file)
    throw std::runtime_error("cannot write " + path +
                             (std::filesystem::is_directory(path) ? ": it is a folder, expected a file" : ""));
  return file;
}

/** @brief The columns iteration,seconds,residual of a solve; the residual with all its digits. */
inline std::string historyRow(const HistoryEntry& entry)
{
  char text[80];
  std::snprintf(text, sizeof(text), "%d,%.9g,%.17g", entry.iteration, entry.seconds, entry.residual);
  return text;
}

/** @brief A file that is to be read. @throws std::invalid_argument in one line where it is a folder */
inline void expectNoFolder(const std::string& path, const std::string& kind)
{
  if (std::filesystem::is_directory(path))
    throw std::invalid_argument(path + ": is a folder, expected " + kind);
}

/** @brief Makes a folder for results. @throws std::invalid_argument in one line where that cannot be */
inline void makeFolder(const std::string& path)
{
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error)
    throw std::invalid_argument(path + ": " + error.message() + ", expected a folder for the results");
}

/**
 * @brief Parses, runs, and turns every exception into one line and BAD_INPUT. run() returns the exit code. Every tool
 * has --version.
 */
template <typename Run>
int runTool(CLI::App& app, int argc, char** argv, const Run& run)
{
  app.set_version_flag("--version", app.get_name() + " " + FRICTIONAL_CONTACT_SIM_VERSION, "print it and leave");
  try
  {
    app.parse(argc, argv);
    return run();
  }
  catch (const CLI::ParseError& error)
  {
    if (error.get_exit_code() == 0)
      return app.exit(error);
    std::cerr << app.get_name() << ": " << error.what() << '\n';
  }
  catch (const std::exception& error)
  {
    std::cerr << app.get_name() << ": " << error.what() << '\n';
  }
  return BAD_INPUT;
}

}  // namespace tools
}  // namespace frictional_contact_sim
