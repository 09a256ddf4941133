/**
 * @file enumerate.cpp
 * @brief enumerate FILE.hdf5: all solutions of a small problem in FCLib format, or the proof that there is none
 * (docs/enumeration.md). Exit 0 complete, 1 not complete, 2 bad input.
 */
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/solver/enumeration/enumeration.h"
#include "progress_bar.h"
#include "tool_support.h"

namespace
{
using namespace frictional_contact_sim;
using Json = nlohmann::ordered_json;

struct Arguments
{
  std::string file;
  std::vector<std::string> options;
  bool json = false;
};

Json toJson(const Eigen::VectorXd& x)
{
  return std::vector<double>(x.data(), x.data() + x.size());
}

Json toJson(const std::vector<Eigen::VectorXd>& points)
{
  Json list = Json::array();
  for (const Eigen::VectorXd& point : points)
    list.push_back(toJson(point));
  return list;
}

Json toJson(const SolutionPiece& piece)
{
  Json modes = Json::array();
  for (const LawMode mode : piece.modes)
    modes.push_back(toString(mode));
  return {{"modes", modes},
          {"dimension", piece.dimension},
          {"bounded", piece.bounded},
          {"vertices_complete", piece.vertices_complete},
          {"vertices", toJson(piece.vertices)},
          {"rays", toJson(piece.rays)}};
}

/** What moves: v of a global problem, u of a local one. */
const Eigen::VectorXd& velocityOf(const Solution& solution)
{
  return solution.v.size() > 0 ? solution.v : solution.u;
}

Json toJson(const SolutionFamily& family)
{
  Json pieces = Json::array();
  for (const SolutionPiece& piece : family.pieces)
    pieces.push_back(toJson(piece));
  return {{"dimension", family.dimension},
          {"bounded", family.bounded},
          {"unique_velocity", family.unique_velocity},
          {"proved", family.proved},
          {"velocity", toJson(velocityOf(family.representative))},
          {"relative_velocity", toJson(family.representative.u)},
          {"impulse", toJson(family.representative.r)},
          {"pieces", pieces}};
}

void report(const Arguments& arguments, const EnumerationReport& found)
{
  if (!arguments.json)
  {
    std::printf("%s: %s (%s, %s, %ld nodes, %.3g s)\n", arguments.file.c_str(), found.message.c_str(),
                found.complete ? "complete" : "not complete", toString(found.uniqueness), found.nodes, found.seconds);
    return;
  }
  Json velocities = Json::array(), families = Json::array();
  for (const SolutionFamily& family : found.families)
  {
    velocities.push_back(toJson(velocityOf(family.representative)));
    families.push_back(toJson(family));
  }
  const Json line = {{"file", arguments.file},
                     {"complete", found.complete},
                     {"solutions", found.solutions},
                     {"continua", found.continua},
                     {"velocities", velocities},
                     {"seconds", found.seconds},
                     {"uniqueness", toString(found.uniqueness)},
                     {"unique_velocity", found.unique_velocity},
                     {"unique_impulses", found.unique_impulses},
                     {"diagnosis", found.diagnosis},
                     {"jamming_contacts", found.jamming},
                     {"nodes", found.nodes},
                     {"leaves", found.leaves},
                     {"unresolved", found.unresolved},
                     {"cuts", found.cuts},
                     {"message", found.message},
                     {"families", families}};
  std::cout << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
}

int run(const Arguments& arguments)
{
  const EnumerateOptions options = EnumerateOptions::table().read("enumerate", tools::parseOptions(arguments.options));
  const FclibProblem problem = readFclib(arguments.file);
  tools::stopOnSignals();
  std::optional<tools::ProgressBar> progress(std::in_place, 0);  // nobody knows how large the tree is
  const auto asked = [] { return tools::stop_requested.load(); };
  const EnumerationReport found = problem.kind == FclibKind::LOCAL ? enumerate(problem.local, options, asked)
                                                                   : enumerate(problem.global, options, asked);
  progress.reset();
  report(arguments, found);
  if (tools::stop_requested)
    return tools::INTERRUPTED;
  return found.complete ? tools::SUCCESS : tools::NOT_CONVERGED;
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app(
      "All solutions of a small frictional contact problem in FCLib format, or the proof that there is none.\n"
      "Exit 0: complete, 1: not complete (a limit, or nodes that could not be resolved), 2: bad input, 130: ended by\n"
      "SIGINT or SIGTERM, what was found is reported.",
      "enumerate");
  app.add_option("FILE", arguments.file, "FCLib file (HDF5); never changed")->required();
  std::string names;
  for (const SolverOption& option : EnumerateOptions::table().options())
    names += "\n" + option.name + " (" + option.default_value + " " + option.unit + "): " + option.meaning;
  tools::addOptionOption(app, arguments.options, "NAME=VALUE, repeated:" + names);
  app.add_flag("--json", arguments.json, "one JSON object on one line");
  return tools::runTool(app, argc, argv, [&] { return run(arguments); });
}
