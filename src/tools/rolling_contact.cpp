// rolling_contact FILE.yaml: solves a rolling contact case, prints a summary, writes CSV files and creep curves.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>

#include "frictional_contact_sim/rolling/closed_forms.h"
#include "frictional_contact_sim/rolling/core_comparison.h"
#include "frictional_contact_sim/rolling/rolling_case.h"
#include "frictional_contact_sim/solver/registry.h"
#include "tool_support.h"

namespace fcs = frictional_contact_sim;

namespace
{
volatile std::sig_atomic_t interrupted = 0;

struct Options
{
  std::string file;
  std::string output;
  std::vector<std::string> compare;
  std::vector<std::string> solver_options;
  int nodes = 0;
};

void print(const fcs::RollingCase& study, const fcs::RollingRun& run)
{
  const fcs::FrictionalContact& contact = run.contact;
  const fcs::HertzLine hertz = fcs::hertzLine(contact.P, study.radius, run.materials.reducedModulus());
  std::cout << "friction " << run.friction << ", lower body ";
  if (run.materials.lower_is_rigid)
    std::cout << "rigid";
  else
    std::cout << "E = " << run.materials.lower.young_modulus << " Pa";
  std::cout << ", beta " << run.materials.dundursBeta() << ", " << run.gap.size() << " contact nodes\n"
            << "  P " << contact.P << " N/m   Q " << contact.Q << " N/m";
  if (run.friction > 0.0 && contact.P > 0.0)
    std::cout << "   |Q|/(mu P) " << std::abs(contact.Q) / (run.friction * contact.P);
  std::cout << "\n  approach " << run.approach << " m   shift " << run.shift << " m\n  contact width "
            << run.contactWidth() << " m (Hertz " << 2.0 * hertz.half_width << ")   stick width " << run.stickWidth()
            << " m   peak pressure " << contact.r_N.maxCoeff() << " Pa (Hertz " << hertz.peak_pressure << ")\n"
            << "  elastic energy " << run.elasticEnergy() << " J/m   |F - F'|/|F| " << run.asymmetry
            << "\n  LCP: residual " << contact.residual << "   pivots " << contact.pivots << "   CPU "
            << run.flexibility_seconds << " s flexibility, " << run.contact_seconds << " s contact"
            << (run.converged ? "\n" : "\n  NOT CONVERGED\n");
  if (contact.states.front() != fcs::NodeState::SEPARATION || contact.states.back() != fcs::NodeState::SEPARATION)
    std::cout << "  the contact reaches the edge of its zone: a wider half_width is needed\n";
  if (!run.steps.empty())
  {
    double lost = 0.0;
    for (const fcs::LoadStep& step : run.steps)
      lost += step.dissipated;
    std::cout << "  " << run.steps.size() << " loads   dissipated " << lost << " J/m\n";
  }
  if (study.motion == fcs::Motion::TRANSIENT)
    std::cout << "  " << run.history.size() << " steps of one node\n";
  if (run.curve)
    std::cout << "  creep curve: full slip at creepage " << run.curve->creepage.back() << ", free rolling at "
              << run.curve->free_creepage << ", other direction differs by " << run.curve->other_direction
              << ", worst residual " << run.curve->worst_residual << '\n';
}

/** The static answer beside those of the core's solvers on the same contact. */
fcs::SolverOptions solverOptions(const std::string& solver, const Options& options)
{
  return fcs::tools::optionsOf(solver, options.compare, options.solver_options);
}

void compare(const fcs::RollingRun& run, const Options& options)
{
  constexpr double TOLERANCE = 1e-11;
  const Eigen::Index n = run.gap.size();
  const fcs::CoreProblem core =
      fcs::poseForTheCore(run.flexibility, Eigen::VectorXd::Constant(1, run.friction), run.gap.array() - run.approach,
                          Eigen::VectorXd::Constant(n, run.shift));
  for (const std::string& solver : options.compare)
  {
    auto progress = std::make_unique<fcs::tools::ProgressBar>(0, "core's " + solver);
    const fcs::CoreComparison one =
        fcs::compareWithCore(core, run.contact, solver, TOLERANCE, solverOptions(solver, options));
    progress.reset();
    std::cout << "  core's " << one.solver << ": " << one.status << "   tractions differ by " << one.difference
              << "   iterations " << one.iterations << "   CPU " << one.seconds << " s\n";
  }
}

/** Makes the folder, before the computation: @throws std::invalid_argument when no file can be made in it. */
void checkWritable(const std::string& folder)
{
  fcs::tools::makeFolder(folder);
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw std::invalid_argument(folder + ": cannot be written, expected a folder for the results");
}

int run(const Options& options)
{
  fcs::RollingCase study = fcs::loadRollingCase(options.file);
  if (!options.compare.empty() && study.motion != fcs::Motion::STATIC)
    throw std::invalid_argument(options.file + ": key 'rolling.motion': --compare expects static");
  if (!options.compare.empty() && study.load_shares.size() > 1)
    throw std::invalid_argument(options.file + ": key 'load.tangential_share': --compare expects one value");
  if (options.nodes > 0 && study.contour)
    throw std::invalid_argument("--nodes: " + options.file + " has a contour, whose points are the mesh");
  if (options.nodes > 0)
    study.nodes = options.nodes;
  for (const std::string& solver : options.compare)
    fcs::createSolver(solver, solverOptions(solver, options));
  if (!options.output.empty())
    checkWritable(options.output);
  std::vector<fcs::RollingRun> runs;
  {
    fcs::tools::ProgressBar progress(1000);
    fcs::RunHooks hooks;
    hooks.progress = [&](double share) { progress.update(std::lround(1000.0 * share)); };
    hooks.interrupted = [] { return interrupted != 0; };
    runs = fcs::runRollingCase(study, hooks);
  }
  bool converged = interrupted == 0;
  for (const fcs::RollingRun& one : runs)
  {
    print(study, one);
    if (!options.compare.empty() && one.converged)
      compare(one, options);
    converged = converged && one.converged;
  }
  if (!options.output.empty())
    for (const std::string& path : fcs::writeRollingFiles(study, runs, options.output))
      std::cout << "wrote " << path << '\n';
  if (interrupted != 0)
    std::cerr << "rolling_contact: interrupted after " << runs.size() << " runs\n";
  return converged ? 0 : 1;
}

/** What ends a computation is not bad input: exit code 1. A folder that cannot be written is. */
int runOrReport(const Options& options)
{
  std::signal(SIGINT, [](int) { interrupted = 1; });
  try
  {
    return run(options);
  }
  catch (const std::filesystem::filesystem_error& error)
  {
    throw std::invalid_argument(options.output + ": " + error.code().message());
  }
  catch (const std::runtime_error& error)
  {
    std::cerr << "rolling_contact: " << error.what() << '\n';
    return fcs::tools::NOT_CONVERGED;
  }
}
}  // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app(
      "Solves a rolling contact case by boundary elements and Lemke's method and prints a summary. Exit 0: all "
      "runs solved, 1: one was not, 2: bad input.",
      "rolling_contact");
  app.add_option("FILE", options.file, "case (YAML, docs/rolling.md; examples in config/rolling)")->required();
  app.add_option("--output", options.output,
                 "folder for NAME_nodes.csv, NAME_runs.csv, NAME_curve_I.yaml; pictures by scripts/plot_rolling");
  app.add_option("--nodes", options.nodes, "contact nodes instead of the file's")->check(CLI::Range(1, 2000));
  app.add_option("--compare", options.compare,
                 "solvers of the core (registry names, comma between) for the same static contact")
      ->delimiter(',');
  fcs::tools::addOptionOption(app, options.solver_options,
                              "SOLVER.NAME=VALUE, or NAME=VALUE for all of --compare, repeated");
  return fcs::tools::runTool(app, argc, argv, [&] { return runOrReport(options); });
}
