/**
 * @file facet_cuts.cpp
 * @brief facet_cuts FILE.mps, facet_cuts generate: one round of split cuts on an integer program (docs/facet_cuts.md).
 * Exit 0 cuts found, or nothing to cut; 1 not; 2 bad input.
 */
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "frictional_contact_sim/separation/cut_study.h"
#include "progress_bar.h"
#include "tool_support.h"

namespace
{
using namespace frictional_contact_sim;
using Json = nlohmann::ordered_json;

struct Arguments
{
  std::string file;
  int variables = 20;
  int constraints = 0;
  std::uint64_t seed = 0;
  std::string output;
  StudyOptions study;
  bool json = false;
};

const std::vector<std::pair<std::string, Normalisation>> NORMALISATIONS = {
    {"multipliers", Normalisation::MULTIPLIERS},
    {"lift_and_project", Normalisation::LIFT_AND_PROJECT},
    {"one_norm", Normalisation::ONE_NORM},
    {"maximum_norm", Normalisation::MAXIMUM_NORM}};
const std::vector<std::pair<std::string, DecompositionStart>> STARTS = {
    {"most_violated", DecompositionStart::MOST_VIOLATED},
    {"projection", DecompositionStart::PROJECTION}};
constexpr const char* STATUS[] = {"STUDIED", "WHOLE", "INFEASIBLE", "UNBOUNDED", "FAILED"};

/** JSON has no infinity. */
Json number(double value)
{
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json toJson(const Eigen::VectorXd& x)
{
  return std::vector<double>(x.data(), x.data() + x.size());
}

Json toJson(const StudiedCut& cut)
{
  Json result = {{"row", toJson(cut.row)}, {"right_hand_side", cut.right_hand_side},
                 {"depth", cut.depth},     {"weight", cut.weight},
                 {"ray", cut.is_ray},      {"on_bound", cut.on_bound}};
  if (cut.face_dimension >= 0)
    result["face_dimension"] = cut.face_dimension;
  return result;
}

/** Per cent of the gain of the deepest cut. */
double relative(double gain, double deepest)
{
  return deepest > 0.0 ? 100.0 * gain / deepest : NAN;
}

long facetsAmong(const CutStudy& study)
{
  return std::count_if(
      study.facets.begin(), study.facets.end(),
      [&](const StudiedCut& cut)
      { return !cut.is_ray && cut.face_dimension >= 0 && cut.face_dimension + 1 == study.dimension; });
}

Json toJson(const IntegerProgram& program, const CutStudy& study, double seconds)
{
  Json result = {{"name", program.name},
                 {"variables", program.size()},
                 {"inequalities", program.inequalities.rows()},
                 {"equations", program.equations.rows()},
                 {"status", STATUS[static_cast<int>(study.status)]},
                 {"message", study.message},
                 {"seconds", seconds}};
  if (study.variable < 0 || study.status != StudyStatus::STUDIED)
    return result;
  const auto objective = [&](double cost) { return number((program.maximises ? -1.0 : 1.0) * cost + program.offset); };
  const double gain = study.with_deepest - study.relaxed;
  Json facets = Json::array();
  for (const StudiedCut& cut : study.facets)
    facets.push_back(toJson(cut));
  result["split_variable"] = program.variables[static_cast<size_t>(study.variable)];
  result["vertex"] = toJson(study.vertex);
  result["objective"] = {{"relaxation", objective(study.relaxed)},
                         {"most_violated", objective(study.with_most_violated)},
                         {"deepest", objective(study.with_deepest)},
                         {"facets", objective(study.with_facets)}};
  result["facets_gain_percent"] = number(relative(study.with_facets - study.relaxed, gain));
  result["most_violated_gain_percent"] = number(relative(study.with_most_violated - study.relaxed, gain));
  result["most_violated_depth_percent"] = 100.0 * study.most_violated.depth / study.deepest.depth;
  result["cuts"] = study.facets.size();
  result["oracle_calls"] = study.calls;
  result["bound"] = study.bound;
  result["on_bound"] = std::count_if(
      study.facets.begin(), study.facets.end(), [](const StudiedCut& cut) { return cut.on_bound; });
  result["rays"] =
      std::count_if(study.facets.begin(), study.facets.end(), [](const StudiedCut& cut) { return cut.is_ray; });
  if (study.dimension >= 0)
  {
    result["dimension"] = study.dimension;
    result["facets"] = facetsAmong(study);
  }
  result["duality_error"] = study.duality_error;
  result["most_violated"] = toJson(study.most_violated);
  result["deepest"] = toJson(study.deepest);
  result["facet_cuts"] = facets;
  return result;
}

void print(const Json& result)
{
  std::printf("%s: %d variables, %d inequalities, %d equations: %s%s%s\n", result["name"].get<std::string>().c_str(),
              result["variables"].get<int>(), result["inequalities"].get<int>(), result["equations"].get<int>(),
              result["status"].get<std::string>().c_str(), result["message"] == "" ? "" : ", ",
              result["message"].get<std::string>().c_str());
  if (!result.contains("objective"))
    return;
  const auto value = [](const Json& x) { return x.is_null() ? NAN : x.get<double>(); };
  std::printf("  split of %s, objective %.10g\n", result["split_variable"].get<std::string>().c_str(),
              value(result["objective"]["relaxation"]));
  std::printf("  %-22s %14s %12s %12s\n", "cuts", "objective", "depth", "gain [%]");
  std::printf("  %-22s %14.10g %12.5g %12.2f\n", "1 most violated", value(result["objective"]["most_violated"]),
              value(result["most_violated"]["depth"]), value(result["most_violated_gain_percent"]));
  std::printf("  %-22s %14.10g %12.5g %12.2f\n", "1 deepest", value(result["objective"]["deepest"]),
              value(result["deepest"]["depth"]), 100.0);
  std::printf("  %-22s %14.10g %12s %12.2f\n", (std::to_string(result["cuts"].get<int>()) + " facet cuts").c_str(),
              value(result["objective"]["facets"]), "", value(result["facets_gain_percent"]));
  std::printf("  %d calls of the oracle, %d of the facet cuts extreme by the bound N = %.4g, %d rays",
              result["oracle_calls"].get<int>(), result["on_bound"].get<int>(), value(result["bound"]),
              result["rays"].get<int>());
  if (result.contains("facets"))
    std::printf(", %d facets by rank", result["facets"].get<int>());
  std::printf(", %.3g s\n", value(result["seconds"]));
  for (const Json& cut : result["facet_cuts"])
    std::printf("    depth %.5g, weight %.5g%s%s\n", value(cut["depth"]), value(cut["weight"]),
                cut["on_bound"].get<bool>() ? ", on the bound" : "", cut["ray"].get<bool>() ? ", ray" : "");
}

int run(const Arguments& arguments, bool generate)
{
  const IntegerProgram program =
      generate ? randomIntegerProgram(arguments.variables,
                                      arguments.constraints > 0 ? arguments.constraints : arguments.variables,
                                      arguments.seed)
               : readMps(arguments.file);
  if (!arguments.output.empty())
    writeMps(program, arguments.output);
  std::optional<tools::ProgressBar> progress(std::in_place, 0);
  const double start = tools::threadSeconds();
  const CutStudy study = studyCuts(program, arguments.study);
  progress.reset();
  const Json result = toJson(program, study, tools::threadSeconds() - start);
  if (arguments.json)
    std::cout << result.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
  else
    print(result);
  return study.status == StudyStatus::STUDIED || study.status == StudyStatus::WHOLE ? tools::SUCCESS
                                                                                    : tools::NOT_CONVERGED;
}

void addStudyOptions(CLI::App& app, Arguments& arguments)
{
  app.add_option("--bound-factor", arguments.study.decomposition.bound_factor,
                 "N of (7.27) over that of the intersection cut; 0: no bound, rays of the reverse polar instead")
      ->check(CLI::Range(0.0, 1e12))
      ->capture_default_str();
  app.add_option(
         "--start", arguments.study.decomposition.start,
         "of algorithm 7.1: most_violated, or projection (the deepest cut first, by another way) (most_violated)")
      ->transform(CLI::CheckedTransformer(STARTS))
      ->default_str("");
  app.add_option("--normalisation", arguments.study.normalisation,
                 "of the most violated cut: multipliers (7.27), lift_and_project, one_norm, maximum_norm (multipliers)")
      ->transform(CLI::CheckedTransformer(NORMALISATIONS))
      ->default_str("");
  app.add_option("--max-calls", arguments.study.decomposition.nearest.max_calls, "of the oracle")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_flag("--check-facets", arguments.study.check_facets,
               "dimensions of the faces that the cuts expose, so which are facets: 2 n linear programs a cut");
  app.add_flag("--json", arguments.json, "one JSON object on one line");
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app(
      "One round of split cuts on an integer program: the most violated cut, the deepest one, and the facet cuts that\n"
      "it is made of, with their depths and gains (docs/facet_cuts.md). FILE is an MPS file; `facet_cuts generate`\n"
      "makes a dense random program instead (its own --help).\n"
      "Exit 0: cuts were found, or the relaxation's solution is whole; 1: not; 2: bad input.",
      "facet_cuts");
  app.add_option("FILE", arguments.file, "integer program (MPS), bounded by memory only: dense matrices");
  addStudyOptions(app, arguments);
  CLI::App* generate =
      app.add_subcommand("generate", "max c.x, A x <= b, x >= 0 whole, entries uniform among 1 .. 100");
  generate->add_option("--variables", arguments.variables, "n")->check(CLI::Range(1, 2000))->capture_default_str();
  generate->add_option("--constraints", arguments.constraints, "m beside x >= 0; 0: as many as variables")
      ->check(CLI::Range(0, 4000))
      ->capture_default_str();
  generate->add_option("--seed", arguments.seed, "of the draw")->capture_default_str();
  generate->add_option("--output", arguments.output, "the program as an MPS file");
  addStudyOptions(*generate, arguments);
  return tools::runTool(app, argc, argv,
                        [&]
                        {
                          if (arguments.file.empty() == !generate->parsed())
                            throw std::invalid_argument(
                                "FILE: found " + std::string(arguments.file.empty() ? "none" : "a file and generate") +
                                ", expected an MPS file or the command generate");
                          return run(arguments, generate->parsed());
                        });
}
