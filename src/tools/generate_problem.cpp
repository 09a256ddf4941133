/**
 * @file generate_problem.cpp
 * @brief generate_problem FAMILY OUT.hdf5: writes problems of the random and rigid families as FCLib files.
 * Their info names family, parameters and the verdict on existence (problem/existence.h). Exit 0 written, 2 bad input.
 */
#include <cstdio>
#include <filesystem>
#include <functional>
#include <sstream>

#include "frictional_contact_sim/problem/certificate/certify.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/problem/random_family.h"
#include "frictional_contact_sim/problem/rigid_families.h"
#include "frictional_contact_sim/problem/rod_family.h"
#include "tool_support.h"

namespace
{
using namespace frictional_contact_sim;

struct Arguments
{
  std::string output;
  RandomFamilyOptions random;
  RigidFamilyOptions rigid;
  RodFamilyOptions rods;
  std::optional<double> friction;  ///< both ends of the range
  int contacts = 1000;
  int width = 0;
  int levels = 5;
  int points_per_side = 2;
};

std::string describe(const RandomFamilyOptions& options)
{
  std::ostringstream text;
  text.precision(17);
  text << "velocities " << options.velocities << ", contacts " << options.contacts << ", subsystem_velocities "
       << options.subsystem_velocities << ", condition " << options.condition << ", external_velocity "
       << options.external_velocity << ", friction " << options.friction_min << " to " << options.friction_max
       << ", seed " << options.seed;
  return text.str();
}

std::string describe(const RigidFamilyOptions& options)
{
  std::ostringstream text;
  text.precision(17);
  text << "friction " << options.friction_min << " to " << options.friction_max << ", mass_ratio " << options.mass_ratio
       << ", agitation " << options.agitation << ", time_step " << options.time_step << ", tilt " << options.tilt
       << ", seed " << options.seed;
  return text.str();
}

std::string describe(const RodFamilyOptions& options)
{
  std::ostringstream text;
  text.precision(17);
  text << "rods " << options.rods << ", pieces " << options.pieces << ", contacts " << options.contacts << ", friction "
       << options.friction << ", curl " << options.curl << ", spacing " << options.spacing << ", agitation "
       << options.agitation << ", seed " << options.seed;
  return text.str();
}

/** Writes one problem with its verdict. @return one line that says so */
std::string write(const std::string& path, const IncrementalProblem& problem, const std::string& family,
                  const std::string& parameters)
{
  CertifyOptions options;
  options.conditioning = false;
  const Certificate certificate = certify(problem, options);
  char margin[64];
  std::snprintf(margin, sizeof(margin), "margin %.3g for |v| <= %.3g", certificate.margin, certificate.bound);
  const std::string verdict =
      std::string("existence ") + toString(certificate.existence) + " (" + margin + ", " + certificate.message + ")";
  writeFclib(path, problem, {family, "family " + family + ": " + parameters + "; " + verdict, ""});
  return path + ": " + std::to_string(problem.laws.size()) + " contacts, " + std::to_string(problem.velocities()) +
         " velocities, " + verdict;
}

/** One problem, then its line. */
void writeOne(const std::function<std::string()>& write_it)
{
  std::string line;
  {
    const tools::ProgressBar progress(0, "generating");
    line = write_it();
  }
  std::cout << line << '\n';
}

/** Writes a table of named problems into a folder. */
template <typename Entry, typename Generate>
void writeTable(const std::string& folder, const std::vector<Entry>& table, const Generate& generate)
{
  tools::makeFolder(folder);
  tools::ProgressBar progress(static_cast<long>(table.size()));
  long done = 0;
  for (const Entry& entry : table)
  {
    const std::string line = write((std::filesystem::path(folder) / (entry.name + ".hdf5")).string(),
                                   generate(entry.options), entry.name, describe(entry.options));
    progress.update(++done);
    const auto lock = progress.pause();
    std::cout << line << std::endl;
  }
}

/// CLI11's own check prints a bound of 309 digits.
const CLI::Validator WHOLE_NUMBER(
    [](const std::string& text)
    {
      const bool whole = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
      return whole ? std::string() : "is " + text + ", expected a whole number >= 0";
    },
    "");

void addRandomOptions(CLI::App& command, RandomFamilyOptions& options)
{
  command.add_option("--velocities", options.velocities, "m, a multiple of --subsystem")->capture_default_str();
  command.add_option("--contacts", options.contacts, "n, in 3D")->capture_default_str();
  command.add_option("--subsystem", options.subsystem_velocities, "velocities of one sub-system")
      ->capture_default_str();
  command.add_option("--condition", options.condition, "of each sub-system's mass matrix [-]")->capture_default_str();
  command
      .add_option("--external-velocity", options.external_velocity,
                  "deviation of w [m/s]; 0: nothing outside moves, always solvable")
      ->capture_default_str();
  command.add_option("--friction-min", options.friction_min, "uniform from here [-]")->capture_default_str();
  command.add_option("--friction-max", options.friction_max, "to here [-]")->capture_default_str();
  command.add_option("--seed", options.seed, "of the draw")->check(WHOLE_NUMBER)->capture_default_str();
}

void addRigidOptions(CLI::App& command, Arguments& arguments)
{
  RigidFamilyOptions& options = arguments.rigid;
  command.add_option("--friction", arguments.friction, "of all contacts [-] (default 0.3)");
  command.add_option("--mass-ratio", options.mass_ratio, "largest mass over smallest [-]")->capture_default_str();
  command.add_option("--agitation", options.agitation, "deviation of the velocities before the step [m/s, rad/s]")
      ->capture_default_str();
  command.add_option("--time-step", options.time_step, "[s]")->capture_default_str();
  command.add_option("--tilt", options.tilt, "gravity from the vertical [rad]")->capture_default_str();
  command.add_option("--seed", options.seed, "of the draw")->check(WHOLE_NUMBER)->capture_default_str();
}

void addRodOptions(CLI::App& command, RodFamilyOptions& options)
{
  command.add_option("--rods", options.rods, "m = 3 pieces rods")->capture_default_str();
  command.add_option("--pieces", options.pieces, "of a rod")->capture_default_str();
  command.add_option("--contacts", options.contacts, "n")->capture_default_str();
  command.add_option("--friction", options.friction, "of all contacts [-]")->capture_default_str();
  command.add_option("--curl", options.curl, "deviation of the curvatures and twists [1/m]")->capture_default_str();
  command.add_option("--spacing", options.spacing, "between neighbouring roots [m]")->capture_default_str();
  command.add_option("--agitation", options.agitation, "deviation of the velocities before the step [1/(m s)]")
      ->capture_default_str();
  command.add_option("--seed", options.seed, "of the draw")->check(WHOLE_NUMBER)->capture_default_str();
}

RigidFamilyOptions rigidOptions(const Arguments& arguments)
{
  RigidFamilyOptions options = arguments.rigid;
  if (arguments.friction)
    options.friction_min = options.friction_max = *arguments.friction;
  return options;
}

void writeGranular(const Arguments& arguments)
{
  const RigidFamilyOptions options = rigidOptions(arguments);
  const std::string shape =
      "contacts " + std::to_string(arguments.contacts) + ", width " + std::to_string(arguments.width) + ", ";
  writeOne(
      [&]
      {
        return write(arguments.output, granularProblem(arguments.contacts, arguments.width, options), "granular",
                     shape + describe(options));
      });
}

void writeBoxes(const Arguments& arguments)
{
  const RigidFamilyOptions options = rigidOptions(arguments);
  const std::string shape = "levels " + std::to_string(arguments.levels) + ", points_per_side " +
                            std::to_string(arguments.points_per_side) + ", ";
  writeOne(
      [&]
      {
        return write(arguments.output, boxStackProblem(arguments.levels, arguments.points_per_side, options), "boxes",
                     shape + describe(options));
      });
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  std::function<void()> action;
  CLI::App app(
      "Writes frictional contact problems of chosen families as FCLib files (global form). The file's info names the\n"
      "family, its parameters and whether a solution is certified to exist. Exit 0: written, 2: bad input.",
      "generate_problem");
  app.require_subcommand(1);
  const auto add = [&](const char* name, const char* help, const char* output, std::function<void()> run)
  {
    CLI::App* command = app.add_subcommand(name, help);
    command->add_option(output, arguments.output, "written; an existing one is replaced")->required();
    command->callback([&action, run] { action = run; });
    return command;
  };
  addRandomOptions(*add(
                       "alea", "one random problem alea-m-n of the thesis", "OUT",
                       [&]
                       {
                         writeOne(
                             [&] {
                               return write(arguments.output, randomFamilyProblem(arguments.random), "alea",
                                            describe(arguments.random));
                             });
                       }),
                   arguments.random);
  add(
      "alea-small", "the 15 problems of table 5.1 with fixed seeds", "DIR",
      [&] { writeTable(arguments.output, smallRandomFamily(), randomFamilyProblem); });
  add(
      "alea-large", "the 15 problems of table 5.2 with fixed seeds", "DIR",
      [&] { writeTable(arguments.output, largeRandomFamily(), randomFamilyProblem); });
  addRodOptions(*add(
                    "rods", "super-helices hanging from a moving support, hair-m-n of the thesis", "OUT",
                    [&]
                    {
                      writeOne(
                          [&] {
                            return write(arguments.output, rodFamilyProblem(arguments.rods), "hair",
                                         describe(arguments.rods));
                          });
                    }),
                arguments.rods);
  add(
      "rods-small", "15 problems of the sizes of table 5.3 with fixed seeds", "DIR",
      [&] { writeTable(arguments.output, smallRodFamily(), rodFamilyProblem); });
  add(
      "rods-large", "15 problems of the sizes of table 5.4 with fixed seeds", "DIR",
      [&] { writeTable(arguments.output, largeRodFamily(), rodFamilyProblem); });
  CLI::App* granular =
      add("granular", "balls on a cubic lattice under gravity", "OUT", [&] { writeGranular(arguments); });
  granular->add_option("--contacts", arguments.contacts, "n")->capture_default_str();
  granular->add_option("--width", arguments.width, "balls along x and y; 0: a cube, 1: a chain")->capture_default_str();
  addRigidOptions(*granular, arguments);
  CLI::App* boxes = add("boxes", "a stack of cubes; hyperstatic: rank H = 6 a cube, 3 p^2 rows an interface", "OUT",
                        [&] { writeBoxes(arguments); });
  boxes->add_option("--levels", arguments.levels, "cubes")->capture_default_str();
  boxes->add_option("--points-per-side", arguments.points_per_side, "p: p x p contacts an interface")
      ->capture_default_str();
  addRigidOptions(*boxes, arguments);
  return tools::runTool(app, argc, argv,
                        [&]
                        {
                          action();
                          return tools::SUCCESS;
                        });
}
