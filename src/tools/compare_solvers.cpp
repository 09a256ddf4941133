/**
 * @file compare_solvers.cpp
 * @brief compare_solvers FILE_OR_FOLDER...: solves every file with every solver of a list, writes one CSV row each.
 * Exit 0 all converged, 1 a solve did not, 2 bad input (a bad file among good ones: its row says BAD_INPUT, the others
 * are done).
 */
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <vector>

#include "frictional_contact_sim/math/contact_functions.h"
#include "frictional_contact_sim/problem/delassus_reduction.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/registry.h"
#include "tool_support.h"

namespace
{
using namespace frictional_contact_sim;
namespace fs = std::filesystem;

struct Arguments
{
  std::vector<std::string> inputs;
  std::vector<std::string> solvers;
  std::vector<std::string> options;
  bool list = false;
  std::string output;
  std::string history;
  StoppingOptions stopping;
  int repeat = 1;
};

constexpr const char* HEADER =
    "file,kind,dimension,contacts,solver,status,iterations,residual,siconos_error,natural_map_1q,ac_criterion,"
    "cpu_seconds,wall_seconds,tried,message";

/** A field of RFC 4180: quoted when it needs to be. */
std::string field(const std::string& text)
{
  if (text.find_first_of(",\"\n\r") == std::string::npos)
    return text;
  std::string result = "\"";
  for (const char character : text)
  {
    if (character == '"')
      result += '"';
    result += character == '\n' || character == '\r' ? ' ' : character;
  }
  return result + '"';
}

std::string number(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

std::string joined(const std::vector<std::string>& names)
{
  std::string result;
  for (const std::string& name : names)
    result += (result.empty() ? "" : "+") + name;
  return result;
}

double median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

template <int D>
double alartCurnierSquare(double mu, const double* u, const double* r)
{
  return alartCurnier<D>(Eigen::Map<const Vector<D>>(u), Eigen::Map<const Vector<D>>(r), mu, 1.0, 1.0,
                         RadiusRule::IMPULSE)
      .squaredNorm();
}

/** Cadoux (2009), (5.1): |f_AC(u, r)|^2/(2 n d) with rho = 1, over the Coulomb contacts; 0 without any. */
double thesisCriterion(const std::vector<Law>& laws, const Solution& solution)
{
  double sum = 0.0;
  int rows = 0;
  int row = 0;
  for (const Law& law : laws)
  {
    const double* u = solution.u.data() + row;
    const double* r = solution.r.data() + row;
    if (law.type == LawType::COULOMB_3D)
      sum += alartCurnierSquare<3>(law.coefficient, u, r);
    else if (law.type == LawType::COULOMB_2D)
      sum += alartCurnierSquare<2>(law.coefficient, u, r);
    rows += law.isCoulomb() ? law.dimension() : 0;
    row += law.dimension();
  }
  return rows > 0 ? sum / (2.0 * rows) : 0.0;
}

std::vector<std::string> listFiles(const std::vector<std::string>& inputs)
{
  std::vector<std::string> files;
  for (const std::string& input : inputs)
  {
    if (!fs::is_directory(input))
    {
      files.push_back(input);
      continue;
    }
    std::vector<std::string> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(input))
      if (entry.path().extension() == ".hdf5")
        found.push_back(entry.path().string());
    if (found.empty())
      throw std::invalid_argument("folder " + input + " has no file ending in .hdf5");
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

/** FOLDER/FILE_SOLVER.csv without the file's folder and ending. */
fs::path historyPath(const std::string& folder, const std::string& file, const std::string& solver)
{
  return fs::path(folder) / (fs::path(file).stem().string() + "_" + solver + ".csv");
}

/** Makes the folder of the histories. Files of one name would write over each other's. */
void prepareHistory(const std::string& folder, const std::vector<std::string>& files)
{
  std::set<std::string> stems;
  for (const std::string& file : files)
    if (!stems.insert(fs::path(file).stem().string()).second)
      throw std::invalid_argument("--history: two files are called " + fs::path(file).filename().string() +
                                  ", expected different names");
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error) || access(folder.c_str(), W_OK) != 0)
    throw std::runtime_error("--history " + folder + " is no folder to write to");
}

/** Solves, writes rows and remembers the worst that happened. */
class Comparison
{
public:
  Comparison(const Arguments& arguments, std::ostream& output) : arguments_(arguments), output_(output)
  {
    for (const std::string& name : arguments.solvers)
    {
      StoppingOptions stopping = arguments.stopping;
      stopping.record_history = !arguments.history.empty();
      stopping.stop = &tools::stop_requested;
      solvers_.push_back(createSolver(name, tools::optionsOf(name, arguments.solvers, arguments.options)));
      solvers_.back()->setStopping(stopping);
    }
  }

  int run(const std::vector<std::string>& files)
  {
    tools::ProgressBar progress(static_cast<long>(files.size() * solvers_.size()));
    write(progress, HEADER);
    long done = 0;
    for (const std::string& file : files)
    {
      done += static_cast<long>(solvers_.size());
      try
      {
        const FclibProblem problem = readFclib(file);
        const Eigen::VectorXd q = problem.kind == FclibKind::LOCAL ? problem.local.q : reduce(problem.global).q;
        long current = done - static_cast<long>(solvers_.size());
        for (const std::unique_ptr<Solver>& solver : solvers_)
        {
          if (tools::stop_requested)
            throw std::runtime_error("interrupted");
          write(progress, solveOne(file, problem, q, *solver));
          progress.update(++current);
        }
      }
      catch (const std::exception& error)
      {
        {
          const auto lock = progress.pause();
          std::cerr << "compare_solvers: " << error.what() << '\n';
        }
        if (tools::stop_requested)
          return tools::INTERRUPTED;
        write(progress, field(file) + ",,,,,BAD_INPUT,,,,,,,,," + field(error.what()));
        exit_code_ = tools::BAD_INPUT;
      }
      progress.update(done);
    }
    return exit_code_;
  }

private:
  void write(tools::ProgressBar& progress, const std::string& line)
  {
    const auto lock = progress.pause();  // output and bar may share a terminal
    output_ << line << std::endl;
  }

  /** @return a row */
  std::string solveOne(const std::string& file, const FclibProblem& problem, const Eigen::VectorXd& q, Solver& solver)
  {
    const bool local = problem.kind == FclibKind::LOCAL;
    SolverResult result;
    std::vector<double> cpu, wall;
    std::ostringstream row;
    row << field(file) << ',' << (local ? "local" : "global") << ',' << problem.dimension << ',' << problem.contacts
        << ',' << solver.name() << ',';
    try
    {
      for (int k = 0; k < arguments_.repeat; ++k)
      {
        const double start = tools::threadSeconds();
        if (local)
          solver.solve(problem.local, nullptr, result);
        else
          solver.solve(problem.global, nullptr, result);
        cpu.push_back(tools::threadSeconds() - start);
        wall.push_back(result.seconds);
      }
    }
    catch (const std::exception& error)
    {
      // The file was good: it is this method that cannot take the problem (or not this size).
      exit_code_ = std::max(exit_code_, tools::NOT_CONVERGED);
      row << "REFUSED,,,,,,,,," << field(error.what());
      return row.str();
    }
    const std::vector<Law>& laws = local ? problem.local.laws : problem.global.laws;
    const Diagnostics diagnostics = diagnose(laws, q, result.solution.u, result.solution.r);
    row << toString(result.status) << ',' << result.iterations << ',' << number(result.residual) << ','
        << number(diagnostics.siconos_error) << ',' << number(diagnostics.natural_map_1q) << ','
        << number(thesisCriterion(laws, result.solution)) << ',' << number(median(cpu)) << ',' << number(median(wall))
        << ',' << field(joined(result.tried)) << ',' << field(result.message);
    if (result.status != SolverStatus::CONVERGED)
      exit_code_ = std::max(exit_code_, tools::NOT_CONVERGED);
    if (!arguments_.history.empty())
      writeHistory(file, solver.name(), result.history);
    return row.str();
  }

  void writeHistory(const std::string& file, const std::string& solver, const std::vector<HistoryEntry>& history)
  {
    std::ofstream output = tools::openOutput(historyPath(arguments_.history, file, solver).string());
    output << "iteration,seconds,residual,file,solver\n";
    for (const HistoryEntry& entry : history)
      output << tools::historyRow(entry) << ',' << field(file) << ',' << solver << '\n';
  }

  const Arguments& arguments_;
  std::ostream& output_;
  std::vector<std::unique_ptr<Solver>> solvers_;
  int exit_code_ = tools::SUCCESS;
};

int run(Arguments& arguments)
{
  if (arguments.list)
  {
    std::cout << describeSolvers();
    return tools::SUCCESS;
  }
  if (arguments.inputs.empty())
    throw std::invalid_argument("FILES are missing, expected FCLib files (see --help)");
  if (arguments.solvers.empty())
    for (const SolverEntry& entry : solverRegistry())
      arguments.solvers.emplace_back(entry.name);
  const std::vector<std::string> files = listFiles(arguments.inputs);
  std::ofstream file;
  // Looks at all names and options before a file is touched.
  Comparison comparison(arguments, arguments.output.empty() ? std::cout : file);
  if (!arguments.output.empty())
  {
    for (const std::string& input : files)
      if (fs::exists(arguments.output) && fs::exists(input) && fs::equivalent(arguments.output, input))
        throw std::invalid_argument("--output " + arguments.output + " is an input itself, expected another file");
    file = tools::openOutput(arguments.output);
  }
  if (!arguments.history.empty())
    prepareHistory(arguments.history, files);
  tools::stopOnSignals();
  return comparison.run(files);
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  arguments.stopping.time_limit = 10.0;
  CLI::App app(
      "Solves FCLib problems with several methods, cold start each, and writes one CSV row a solve. A method that\n"
      "cannot take a problem gets status REFUSED, a file that cannot be read one row BAD_INPUT; the rest goes on.\n"
      "Exit 0: all converged, 1: a solve did not, 2: bad input, 130: ended by SIGINT or SIGTERM with the rows done.",
      "compare_solvers");
  app.add_option("FILES", arguments.inputs, "FCLib files, or folders of *.hdf5; never changed");
  app.add_option("--solvers", arguments.solvers, "names separated by commas (default: all; see fclib_solve)")
      ->delimiter(',');
  tools::addOptionOption(app, arguments.options,
                         "SOLVER.NAME=VALUE, or NAME=VALUE for all of --solvers, repeated; see --list-solvers");
  app.add_flag("--list-solvers", arguments.list, "list the methods with their options and leave");
  tools::addSolveOptions(app, arguments.stopping, arguments.repeat);
  app.add_option("--output", arguments.output, "CSV file (default: standard output)");
  app.add_option("--history", arguments.history,
                 "folder for one CSV a solve, FILE_SOLVER.csv: the residual at every iterate the method judged, last\n"
                 "the answer's: iteration,seconds,residual,file,solver (of the last solve of --repeat)");
  return frictional_contact_sim::tools::runTool(app, argc, argv, [&] { return run(arguments); });
}
