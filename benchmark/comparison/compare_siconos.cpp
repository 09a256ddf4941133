/**
 * @file compare_siconos.cpp
 * @brief Command compare_siconos: our methods and Siconos's on the same local problems, judged alike.
 *
 * Not a Google Benchmark: that repeats one function in a warm loop, while this needs a search for each solver's
 * tolerance, child processes for solvers that may crash, and cold starts in turn.
 */
#include <CLI/CLI.hpp>
#include <Eigen/QR>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "comparison/isolation.h"
#include "comparison/results.h"
#include "frictional_contact_sim/math/blas_threads.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/solver/registry.h"
#include "tools/tool_support.h"

namespace
{
using namespace frictional_contact_sim;
using namespace comparison;

constexpr int LARGEST_RANK = 1000;  ///< [rows] above, the rank of W is not computed

struct Arguments
{
  std::vector<std::string> files = {PROJECT_DIR "/../shared/fclib"};
  std::vector<std::string> solvers = {"portfolio", "siconos"};
  std::vector<std::string> targets = {"1e-4", "1e-8"};
  std::string output = ".";
  std::string name = "comparison";
  MeasureOptions measure;
};

std::vector<std::string> collectFiles(const std::vector<std::string>& paths)
{
  std::vector<std::string> files;
  for (const std::string& path : paths)
  {
    if (!std::filesystem::exists(path))
      throw std::invalid_argument(path + ": does not exist, expected an FCLib file or a folder of them");
    if (!std::filesystem::is_directory(path))
    {
      files.push_back(path);
      continue;
    }
    const size_t first = files.size();
    for (const auto& entry : std::filesystem::directory_iterator(path))
      if (entry.path().extension() == ".hdf5")
        files.push_back(entry.path().string());
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
  }
  return files;
}

/** "portfolio", "ours" = all of ours, "siconos" = all of Siconos's, or a Siconos solver by its name. */
std::vector<Entry> makeEntries(const DelassusProblem& problem, const Arguments& arguments)
{
  std::vector<Entry> entries;
  for (const std::string& name : arguments.solvers)
  {
    std::vector<Entry> more;
    if (name == "ours")
      for (const SolverEntry& method : solverRegistry())
        more.push_back(ourEntry(problem, method.name));
    else if (name == "thesis")
      more = thesisEntries(problem);
    else if (name.rfind("siconos", 0) == 0)
      more = siconosEntries(problem, name == "siconos" ? std::vector<std::string>() : std::vector<std::string>{name});
    else
      more.push_back(ourEntry(problem, name));
    entries.insert(entries.end(), more.begin(), more.end());
  }
  return entries;
}

ProblemFacts describe(const std::string& file, const FclibProblem& problem, const DelassusProblem& local)
{
  ProblemFacts facts;
  facts.name = std::filesystem::path(file).stem().string();
  facts.kind = problem.kind == FclibKind::LOCAL ? "local" : "global";
  facts.dimension = problem.dimension;
  facts.contacts = problem.contacts;
  facts.rows = local.W.rows();
  facts.bilaterals =
      problem.kind == FclibKind::GLOBAL
          ? problem.global.bilaterals()
          : static_cast<int>(std::count_if(local.laws.begin(), local.laws.end(),
                                           [](const Law& law) { return law.type == LawType::BILATERAL; }));
  if (facts.rows > 0 && facts.rows <= LARGEST_RANK)
    facts.rank = static_cast<int>(Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(local.W.toDense()).rank());
  return facts;
}

void run(Arguments& arguments)
{
  arguments.measure.targets.clear();
  for (const std::string& text : arguments.targets)
    arguments.measure.targets.push_back(parseTarget(text));
  for (const std::string& name : arguments.solvers)
    if (name != "ours" && name != "thesis" && name.rfind("siconos", 0) != 0)
      createSolver(name);
  const std::vector<std::string> files = collectFiles(arguments.files);
  std::filesystem::create_directories(arguments.output);
  CsvTable csv(arguments.output + "/" + arguments.name + ".csv");
  std::vector<RatioTable> ratios;
  for (const Target& target : arguments.measure.targets)
    ratios.emplace_back(target, arguments.solvers.front() == "ours" ? "portfolio" : arguments.solvers.front());
  {
    tools::ProgressBar bar(static_cast<long>(files.size()));
    for (size_t f = 0; f < files.size(); ++f)
    {
      FclibProblem problem;
      try
      {
        problem = readFclib(files[f]);
      }
      catch (const std::runtime_error& error)
      {
        bar.clear();
        std::fprintf(stderr, "left out: %s\n", error.what());
        continue;
      }
      const DelassusProblem local = problem.kind == FclibKind::LOCAL ? problem.local : reduce(problem.global);
      const ProblemFacts facts = describe(files[f], problem, local);
      const auto table =
          measure(local, makeEntries(local, arguments), arguments.measure,
                  [&](const std::string& text) { bar.update(static_cast<long>(f), facts.name + ": " + text); });
      for (size_t t = 0; t < table.size(); ++t)
      {
        for (const Outcome& outcome : table[t])
          csv.add(facts, arguments.measure.targets[t], outcome);
        ratios[t].add(facts, table[t]);
      }
    }
  }
  for (const RatioTable& table : ratios)
    table.print();
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app(
      "Times our methods and Siconos's on the same local problems from r = 0, CPU time on one core. Each solver's own\n"
      "tolerance is tightened until an independent judge is content; its quickest storage stands for it.",
      "compare_siconos");
  app.add_option("--files", arguments.files, "FCLib files or folders of them")->capture_default_str();
  app.add_option(
         "--solvers", arguments.solvers,
         "names of our methods, 'ours' = all of them, 'thesis' = some as the thesis has them, 'siconos' = all of "
         "theirs, or e.g. 'siconos NSGS'; the first is compared")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--targets", arguments.targets, "residuals E, or thesis:1e-6 for the thesis's (5.1); loose first")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--time-limit", arguments.measure.time_limit, "CPU time of a solve [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--give-up-factor", arguments.measure.give_up_factor,
                 "a solve may last so many times the first solver's; 0: only the time limit counts")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_flag("--every-variant", arguments.measure.every_variant,
               "try every storage of a solver (default: two out of time are enough)");
  app.add_option("--samples", arguments.measure.samples, "cold starts a median is taken of")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option(
         "--sampling-time", arguments.measure.sampling_time,
         "CPU time a solver may use for its samples of one problem [s]; slow ones get fewer, at least 3; the first "
         "solver and the best of Siconos's get all below 50 ms a solve")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--output", arguments.output, "folder of the CSV")->capture_default_str();
  app.add_option("--name", arguments.name, "name of the CSV")->capture_default_str();
  return tools::runTool(app, argc, argv,
                        [&]
                        {
                          useOneBlasThread();
                          run(arguments);
                          return tools::SUCCESS;
                        });
}
