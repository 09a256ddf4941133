/**
 * @file threshold.cpp
 * @brief threshold FILE.yaml --vary KEY --from A --to B --hold "...": for which values of one number of a scenario
 * something holds (docs/certificates.md). Exit 0 a value holds, 1 none does, 2 bad input.
 */
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "frictional_contact_sim/simulation/scenario_files.h"
#include "frictional_contact_sim/simulation/scenario_loader.h"
#include "frictional_contact_sim/simulation/threshold.h"
#include "progress_bar.h"
#include "tool_support.h"

namespace
{
namespace fcs = frictional_contact_sim;
using Json = nlohmann::ordered_json;
using fcs::tools::stop_requested;

/// Verdicts on existence of the run that certifies a value.
constexpr long MOST_VERDICTS = 200;

struct Arguments
{
  std::string file;
  std::string key;
  std::string hold;
  double duration = -1.0;
  fcs::ThresholdOptions options;
  bool certificate = true;
  bool json = false;
};

class Search
{
public:
  Search(const Arguments& arguments, const std::string& path)
    : arguments_(arguments)
    , path_(path)
    , expression_(arguments.hold)
    , expected_(expectedRuns())
    , bar_(std::in_place, 100L * expected_)
  {
  }

  bool holds(double value)
  {
    if (stop_requested)
      throw std::runtime_error("interrupted");
    const fcs::RunRecord record = run(value, 0);
    expression_.check(record.quantities);
    return record.solved && expression_.holds(record.quantities);
  }

  /** The run again, with verdicts on existence. */
  Json certify(double value)
  {
    const fcs::Scenario scenario = load(value);
    const long steps = std::lround(scenario.duration / scenario.time_step);
    const int every = static_cast<int>(std::max(1L, (steps + MOST_VERDICTS - 1) / MOST_VERDICTS));
    const fcs::RunRecord record = run(value, every);
    return {{"value", value},
            {"holds", record.solved && expression_.holds(record.quantities)},
            {"existence", record.checked > 0 && record.certified == record.checked ? "CERTIFIED"
                          : record.refuted > 0                                     ? "REFUTED"
                                                                                   : "UNDECIDED"},
            {"steps_checked", record.checked},
            {"steps_certified", record.certified},
            {"least_margin", record.least_margin}};
  }

  int runs() const { return runs_; }
  /** Before anything is printed. */
  void endBar() { bar_.reset(); }

private:
  fcs::Scenario load(double value) const
  {
    fcs::Scenario scenario = fcs::loadScenarioFile(path_, arguments_.key, value);
    if (arguments_.duration >= 0.0)
      scenario.duration = arguments_.duration;
    scenario.stopping.stop = &stop_requested;
    return scenario;
  }

  fcs::RunRecord run(double value, int certify_every)
  {
    fcs::Scenario scenario = load(value);
    scenario.certify_every = certify_every;
    const int done = runs_++;
    return fcs::recordRun(scenario,
                          [&](double share)
                          {
                            const double shown = std::min<double>(expected_, done + share);
                            bar_->update(std::lround(100.0 * shown));
                          });
  }

  int expectedRuns() const
  {
    const double width = 1.0 / (arguments_.options.samples - 1);
    return arguments_.options.samples +
           static_cast<int>(std::ceil(std::max(0.0, std::log2(width / arguments_.options.tolerance)))) + 1;
  }

  const Arguments& arguments_;
  std::string path_;
  fcs::HoldExpression expression_;
  int expected_;
  int runs_ = 0;
  std::optional<fcs::tools::ProgressBar> bar_;
};

std::string text(double value)
{
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.6g", value);
  return buffer;
}

/** "holds for KEY >= 0.312". */
std::string describe(const Arguments& arguments, const fcs::ThresholdResult& result)
{
  if (result.intervals.empty())
    return "holds for none of the values tried, " + text(arguments.options.from) + " to " + text(arguments.options.to);
  std::string sentence = "holds for ";
  for (const fcs::HoldingInterval& interval : result.intervals)
  {
    if (&interval != &result.intervals.front())
      sentence += " and for ";
    if (interval.open_below && interval.open_above)
      sentence += text(interval.from) + " <= " + arguments.key + " <= " + text(interval.to) + ", all values tried";
    else if (interval.open_above)
      sentence += arguments.key + " >= " + text(interval.from) + " (up to " + text(interval.to) + ", fails at " +
                  text(interval.fails_below) + ")";
    else if (interval.open_below)
      sentence += arguments.key + " <= " + text(interval.to) + " (down to " + text(interval.from) + ", fails at " +
                  text(interval.fails_above) + ")";
    else
      sentence += text(interval.from) + " <= " + arguments.key + " <= " + text(interval.to) + " (fails at " +
                  text(interval.fails_below) + " and " + text(interval.fails_above) + ")";
  }
  if (!result.monotone)
    sentence += "; not monotone: holding and failing alternate, and between the values tried they may again";
  return sentence;
}

int run(const Arguments& arguments)
{
  fcs::tools::stopOnSignals();
  const std::string path = fcs::findScenario(arguments.file);
  arguments.options.validate();
  Search search(arguments, path);
  const fcs::ThresholdResult result =
      fcs::findThreshold(arguments.options, [&](double value) { return search.holds(value); });
  const fcs::HoldingInterval* widest = result.widest();
  Json certificate = {{"text", describe(arguments, result)}, {"monotone", result.monotone}};
  Json intervals = Json::array();
  for (const fcs::HoldingInterval& interval : result.intervals)
    intervals.push_back({{"from", interval.from},
                         {"to", interval.to},
                         {"fails_below", interval.open_below ? Json(nullptr) : Json(interval.fails_below)},
                         {"fails_above", interval.open_above ? Json(nullptr) : Json(interval.fails_above)}});
  certificate["intervals"] = intervals;
  if (widest != nullptr && arguments.certificate)
    certificate["existence"] = search.certify(widest->open_below && !widest->open_above ? widest->to : widest->from);
  search.endBar();
  Json tried = Json::array();
  for (const auto& [value, held] : result.runs)
    tried.push_back({value, held});
  const Json object = {{"scenario", path},
                       {"vary", arguments.key},
                       {"hold", arguments.hold},
                       {"holds_from", widest != nullptr ? Json(widest->from) : Json(nullptr)},
                       {"holds_to", widest != nullptr ? Json(widest->to) : Json(nullptr)},
                       {"certificate", certificate},
                       {"runs", search.runs()},
                       {"tried", tried}};
  if (arguments.json)
    std::cout << object.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
  else
  {
    std::printf("%s, %d runs\n", certificate["text"].get<std::string>().c_str(), search.runs());
    if (certificate.contains("existence"))
      std::printf("at %.6g: %s, %d of %d verdicts on steps CERTIFIED, least margin %.3g m/s\n",
                  certificate["existence"]["value"].get<double>(),
                  certificate["existence"]["existence"].get<std::string>().c_str(),
                  certificate["existence"]["steps_certified"].get<int>(),
                  certificate["existence"]["steps_checked"].get<int>(),
                  certificate["existence"]["least_margin"].get<double>());
  }
  return widest != nullptr ? fcs::tools::SUCCESS : fcs::tools::NOT_CONVERGED;
}

std::string quantityHelp()
{
  std::string help = "what has to hold: QUANTITY < NUMBER (<=, >, >=), joined by 'and'. Quantities of the run:\n";
  for (const auto& [name, meaning] : fcs::sceneQuantities())
    help += "  " + name + ": " + meaning + "\n";
  help += "and of a body BODY.quantity:\n";
  for (const auto& [name, meaning] : fcs::bodyQuantities())
    help += "  " + name + ": " + meaning + "\n";
  return help;
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app(
      "Bisection on one number of a scenario: for which values something holds. A run with a step without an answer\n"
      "does not hold. Exit 0: some value holds, 1: none does, 2: bad input.",
      "threshold");
  app.add_option("FILE", arguments.file, "scenario (YAML), or the name of one in config/scenarios")->required();
  app.add_option("--vary", arguments.key,
                 "the number, keys with dots: materials.default.friction, bodies.box.pose.xyz.2")
      ->required();
  app.add_option("--from", arguments.options.from, "least value")->required();
  app.add_option("--to", arguments.options.to, "largest value")->required();
  app.add_option("--hold", arguments.hold, quantityHelp())->required();
  app.add_option("--samples", arguments.options.samples, "values of the first look, ends included")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  app.add_option("--tolerance", arguments.options.tolerance, "of a threshold, relative to the range")
      ->check(CLI::Range(1e-12, 0.5))
      ->capture_default_str();
  app.add_option("--duration", arguments.duration, "instead of the file's [s]")->check(CLI::Range(0.0, 1e9));
  app.add_flag("!--no-certificate", arguments.certificate,
               "without the last run, which asks for verdicts on existence at the threshold");
  app.add_flag("--json", arguments.json, "one JSON object on one line");
  return fcs::tools::runTool(app, argc, argv, [&] { return run(arguments); });
}
