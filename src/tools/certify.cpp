/**
 * @file certify.cpp
 * @brief certify FILE.hdf5: does the problem have a solution, how far is it from having none, and is it the only one
 * (docs/certificates.md). Exit 0 CERTIFIED or REFUTED, 1 UNDECIDED, 2 bad input.
 */
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "frictional_contact_sim/problem/certificate/certify.h"
#include "frictional_contact_sim/problem/certificate/fixed_point_check.h"
#include "frictional_contact_sim/problem/certificate/uniqueness.h"
#include "frictional_contact_sim/problem/fclib.h"
#include "frictional_contact_sim/problem/residual.h"
#include "frictional_contact_sim/solver/registry.h"
#include "progress_bar.h"
#include "tool_support.h"

namespace
{
using namespace frictional_contact_sim;
using Json = nlohmann::ordered_json;

struct Arguments
{
  std::string file;
  std::string solver;
  CertifyOptions options;
  bool proof = false;
  bool json = false;
};

/** JSON has no infinity. */
Json number(double value)
{
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json list(const Eigen::VectorXd& values)
{
  return std::vector<double>(values.data(), values.data() + values.size());
}

/** Laws of a file: its contacts, then bilateral rows of a local problem. */
Json contactsAmong(const std::vector<int>& laws, int contacts)
{
  Json result = Json::array();
  for (const int law : laws)
    if (law < contacts)
      result.push_back(law);
  return result;
}

Json bilateralsAmong(const std::vector<int>& laws, const std::vector<int>& rows, int contacts)
{
  Json result = Json::array();
  for (const int law : laws)
    if (law >= contacts)
      result.push_back(law - contacts);
  for (const int row : rows)
    result.push_back(row);
  return result;
}

Json describe(const IslandCertificate& island, const Arguments& arguments, int contacts)
{
  Json result = {{"contacts", contactsAmong(island.laws, contacts)},
                 {"existence", toString(island.existence.verdict)},
                 {"margin", number(island.margin)},
                 {"margin_below", number(island.upper_bound)},
                 {"rows", island.conditioning.rows},
                 {"rank", island.conditioning.rank},
                 {"condition", number(island.conditioning.condition)}};
  if (arguments.options.klarbring_pang)
  {
    const KlarbringPangReport& condition = island.klarbring_pang;
    result["klarbring_pang"] = {{"unconditional", condition.unconditional},
                                {"lower", number(condition.lower)},
                                {"upper", number(condition.upper)},
                                {"equilibrium_error", condition.equilibrium_error}};
  }
  return result;
}

/** Theorem 3.20 at an answer: the file's own, or that of --solver. */
Json describeAnswer(const std::string& source, const IncrementalProblem& problem, const Solution& answer, int contacts)
{
  const FixedPointReport report = checkFixedPoint(problem, answer.v);
  return {{"answer", source},
          {"verdict", report.verdict()},
          {"fixed_point", report.is_fixed_point},
          {"solution", report.is_solution},
          {"qualified", report.qualified},
          {"unqualified_contacts", contactsAmong(report.unqualified, contacts)},
          {"qualification", report.qualification},
          {"least_impulse", number(report.least_impulse)}};
}

Json theorem(const Arguments& arguments, const FclibProblem& problem)
{
  if (!arguments.solver.empty())
  {
    StoppingOptions stopping;
    stopping.stop = &tools::stop_requested;
    const std::unique_ptr<Solver> solver = createSolver(arguments.solver);
    solver->setStopping(stopping);
    const SolverResult result = solver->solve(problem.global);
    Json answer = describeAnswer(arguments.solver, problem.global, result.solution, problem.contacts);
    answer["status"] = toString(result.status);
    return answer;
  }
  return describeAnswer("file", problem.global, *problem.solution, problem.contacts);
}

Json report(const Arguments& arguments, const FclibProblem& problem)
{
  const bool local = problem.kind == FclibKind::LOCAL;
  const Certificate certificate =
      local ? certify(problem.local, arguments.options) : certify(problem.global, arguments.options);
  const UniquenessReport uniqueness = local ? checkUniqueness(problem.local) : checkUniqueness(problem.global);
  Json islands = Json::array();
  for (const IslandCertificate& island : certificate.islands)
    islands.push_back(describe(island, arguments, problem.contacts));
  Json result = {
      {"file", arguments.file},
      {"kind", local ? "local" : "global"},
      {"contacts", problem.contacts},
      {"dimension", problem.dimension},
      {"existence", toString(certificate.existence)},
      {"margin", number(certificate.margin)},
      {"bound", certificate.bound},
      {"exact", certificate.exact},
      {"blocking_contacts", contactsAmong(certificate.blocking, problem.contacts)},
      {"blocking_bilaterals", bilateralsAmong(certificate.blocking, certificate.blocking_bilaterals, problem.contacts)},
      {"limiting_contacts", contactsAmong(certificate.limiting, problem.contacts)},
      {"rows", certificate.rows},
      {"rank", certificate.rank},
      {"condition", number(certificate.condition)},
      {"uniqueness", toString(uniqueness.verdict)},
      {"uniqueness_message", uniqueness.message},
      {"message", certificate.message},
      {"islands", islands},
      {"seconds", certificate.seconds}};
  if (arguments.options.klarbring_pang)
    result["solvable_for_every_w"] = certificate.unconditional;
  const bool stored = problem.solution && problem.solution->v.size() == problem.global.velocities();
  if (!local && (stored || !arguments.solver.empty()))
    result["theorem_3_20"] = theorem(arguments, problem);
  if (arguments.proof && certificate.v.size() > 0)
    result["velocity"] = list(certificate.v);
  if (arguments.proof && certificate.multiplier.size() > 0)
    result["multiplier"] = list(certificate.multiplier);
  if (arguments.proof && certificate.bilateral_multiplier.size() > 0)
    result["bilateral_multiplier"] = list(certificate.bilateral_multiplier);
  return result;
}

std::string joined(const Json& numbers)
{
  std::string text;
  for (const Json& one : numbers)
    text += (text.empty() ? "" : ", ") + std::to_string(one.get<int>());
  return text;
}

void print(const Json& result)
{
  const auto value = [&](const char* key) { return result[key].is_null() ? INFINITY : result[key].get<double>(); };
  std::printf("%s: %s, %d contacts in %dD: %s\n", result["file"].get<std::string>().c_str(),
              result["existence"].get<std::string>().c_str(), result["contacts"].get<int>(),
              result["dimension"].get<int>(), result["message"].get<std::string>().c_str());
  if (!result["blocking_contacts"].empty() || !result["blocking_bilaterals"].empty())
    std::printf("  blocking: contacts %s; bilateral rows %s\n", joined(result["blocking_contacts"]).c_str(),
                joined(result["blocking_bilaterals"]).c_str());
  std::printf("  margin %.6g m/s for |v| <= %.3g, limited by contacts %s\n", value("margin"), value("bound"),
              joined(result["limiting_contacts"]).c_str());
  std::printf("  rank %d of %d rows, condition of W %.4g, %zu islands\n", result["rank"].get<int>(),
              result["rows"].get<int>(), value("condition"), result["islands"].size());
  std::printf("  uniqueness %s: %s\n", result["uniqueness"].get<std::string>().c_str(),
              result["uniqueness_message"].get<std::string>().c_str());
  if (result.contains("theorem_3_20"))
    std::printf("  answer of %s: %s\n", result["theorem_3_20"]["answer"].get<std::string>().c_str(),
                result["theorem_3_20"]["verdict"].get<std::string>().c_str());
  std::printf("  %.3g s\n", value("seconds"));
}

int run(const Arguments& arguments)
{
  tools::stopOnSignals();
  if (!arguments.solver.empty())
    findSolver(arguments.solver);  // throws before the work
  const FclibProblem problem = readFclib(arguments.file);
  if (!arguments.solver.empty() && problem.kind == FclibKind::LOCAL)
    throw std::invalid_argument("--solver: " + arguments.file +
                                " is a local problem, expected a global one: theorem 3.20 is about velocities");
  std::optional<tools::ProgressBar> progress(std::in_place, 0);
  const Json result = report(arguments, problem);
  progress.reset();
  if (arguments.json)
    std::cout << result.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
  else
    print(result);
  if (tools::stop_requested)
    return tools::INTERRUPTED;
  return result["existence"] == toString(Existence::UNDECIDED) ? tools::NOT_CONVERGED : tools::SUCCESS;
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app(
      "Says whether a frictional contact problem in FCLib format has a solution, with a proof that was checked:\n"
      "CERTIFIED, REFUTED (the blocking contacts are named) or UNDECIDED; how far it is from having none (margin),\n"
      "rank and condition, and whether two solutions can have different velocities (docs/certificates.md).\n"
      "Exit 0: CERTIFIED or REFUTED, 1: UNDECIDED, 2: bad input.",
      "certify");
  app.add_option("FILE", arguments.file, "FCLib file (HDF5)")->required();
  app.add_option("--bound", arguments.options.bound,
                 "R: the margin is the largest for |v| <= R [unit of v]; 0: 1e3 times what moves outside")
      ->check(CLI::Range(0.0, 1e300))
      ->capture_default_str();
  app.add_option("--gap", arguments.options.existence.gap, "of the margin from its upper bound [-]")
      ->check(CLI::Range(1e-12, 1.0))
      ->capture_default_str();
  app.add_option("--max-rounds", arguments.options.existence.max_rounds, "linear programs of one maximum at most")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--max-rows", arguments.options.max_rows, "of an island for rank and condition; -1 is said beyond")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  app.add_flag("!--no-margin", arguments.options.margin, "stop at the verdict: the margin is the first certificate's");
  app.add_flag("--klarbring-pang", arguments.options.klarbring_pang,
               "theorem 3.1 itself and (3.34): solvable whatever moves outside");
  app.add_option("--solver", arguments.solver,
                 "theorem 3.20 at the answer of this method (global files); else at the "
                 "file's own solution, where it has one");
  app.add_flag("--proof", arguments.proof, "the velocity or the multipliers that prove the verdict");
  app.add_flag("--json", arguments.json, "one JSON object on one line");
  return tools::runTool(app, argc, argv, [&] { return run(arguments); });
}
