#include "frictional_contact_sim/simulation/threshold.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <stdexcept>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/simulation/root_motion.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double LAST_SHARE = 0.1;  ///< of the run, that max_speed speaks of

/** Largest velocity of any coordinate. */
double fastest(const Simulator& simulator)
{
  double speed = 0.0;
  for (int body = 0; body < simulator.bodyCount(); ++body)
    if (simulator.velocity(body).size() > 0)
      speed = std::max(speed, simulator.velocity(body).lpNorm<Eigen::Infinity>());
  return speed;
}

double tiltBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b)
{
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

void addBodies(const Simulator& simulator, const std::vector<Eigen::Isometry3d>& start, RunQuantities& quantities)
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const Eigen::Isometry3d pose = rootPose(simulator, body);
    const Vector6d velocity = rootVelocity(simulator, body);
    const double displacement = (pose.translation() - start[static_cast<size_t>(body)].translation()).norm();
    const double tilt = tiltBetween(start[static_cast<size_t>(body)], pose);
    const std::string name = simulator.bodyName(body) + ".";
    quantities[name + "x"] = pose.translation().x();
    quantities[name + "y"] = pose.translation().y();
    quantities[name + "z"] = pose.translation().z();
    quantities[name + "speed"] = velocity.head<3>().norm();
    quantities[name + "displacement"] = displacement;
    quantities[name + "tilt"] = tilt;
    quantities["max_displacement"] = std::max(quantities["max_displacement"], displacement);
    quantities["max_tilt"] = std::max(quantities["max_tilt"], tilt);
  }
}
}  // namespace

const std::vector<std::pair<std::string, std::string>>& sceneQuantities()
{
  static const std::vector<std::pair<std::string, std::string>> names = {
      {"max_speed", "largest velocity of any coordinate in the last tenth of the run [m/s, rad/s]"},
      {"peak_speed", "the same over the whole run"},
      {"max_displacement", "of a body's root link at the end, from the start [m]"},
      {"max_tilt", "rotation of a body's root link at the end, from the start [rad]"},
      {"max_penetration", "over the run [m]"},
      {"max_force", "largest force of a contact over the run [N]"},
      {"kinetic", "energy at the end [J]"},
      {"friction", "energy dissipated by friction [J]"},
      {"contacts", "at the end"},
      {"failed_steps", "steps without an answer"}};
  return names;
}

const std::vector<std::pair<std::string, std::string>>& bodyQuantities()
{
  static const std::vector<std::pair<std::string, std::string>> names = {
      {"x", "of the root link at the end [m]"},
      {"y", "[m]"},
      {"z", "[m]"},
      {"speed", "of the root link at the end [m/s]"},
      {"displacement", "at the end, from the start [m]"},
      {"tilt", "rotation at the end, from the start [rad]"}};
  return names;
}

HoldExpression::HoldExpression(const std::string& text)
{
  static const std::regex comparison(
      R"(\s*([A-Za-z_][\w.]*)\s*(<=|>=|<|>)\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*)");
  static const std::regex joint(R"(\s+and\s+|\s*&&\s*)");
  for (std::sregex_token_iterator part(text.begin(), text.end(), joint, -1), end; part != end; ++part)
  {
    const std::string one = *part;
    std::smatch match;
    if (!std::regex_match(one, match, comparison))
      throw std::invalid_argument("found '" + inOneLine(one, 80) +
                                  "', expected QUANTITY < NUMBER (or <=, >, >=), joined by 'and'");
    comparisons_.push_back({match[1], match[2], std::stod(match[3])});
  }
}

void HoldExpression::check(const RunQuantities& quantities) const
{
  std::vector<std::string> names;
  for (const auto& entry : quantities)
    names.push_back(entry.first);
  for (const Comparison& one : comparisons_)
    if (quantities.count(one.quantity) == 0)
      throw std::invalid_argument("unknown quantity '" + one.quantity + "', " + didYouMean(one.quantity, names) +
                                  "expected one of: " + joinNames(names));
}

bool HoldExpression::holds(const RunQuantities& quantities) const
{
  return std::all_of(
      comparisons_.begin(), comparisons_.end(),
      [&](const Comparison& one)
      {
        const double value = quantities.at(one.quantity);
        return one.relation == "<"    ? value < one.value
               : one.relation == "<=" ? value <= one.value
               : one.relation == ">"  ? value > one.value
                                      : value >= one.value;
      });
}

RunRecord recordRun(const Scenario& scenario, const std::function<void(double)>& progress)
{
  Simulator simulator(scenario);
  RunRecord record;
  for (const auto& entry : sceneQuantities())
    record.quantities[entry.first] = 0.0;
  std::vector<Eigen::Isometry3d> start;
  for (int body = 0; body < simulator.bodyCount(); ++body)
    start.push_back(rootPose(simulator, body));
  const auto fail = [&](const std::string& when)
  {
    record.solved = false;
    record.failure = when + ": " + toString(simulator.outcome().status) + ", " + simulator.outcome().message;
    record.quantities["failed_steps"] = 1.0;
  };
  if (!simulator.outcome().converged())
    fail("the impact at the start");
  const auto steps = static_cast<long>(std::llround(scenario.duration / scenario.time_step));
  record.least_margin = std::numeric_limits<double>::infinity();
  RunQuantities& found = record.quantities;
  for (long step = 0; step < steps && record.solved; ++step)
  {
    const bool converged = simulator.step().converged();
    const StepSummary& report = simulator.report();
    if (report.certificate.checked)
    {
      ++record.checked;
      record.certified += report.certificate.existence == Existence::CERTIFIED;
      record.refuted += report.certificate.existence == Existence::REFUTED;
      if (!report.certificate.islands.empty())
        record.least_margin = std::min(record.least_margin, report.certificate.margin);
    }
    if (!converged)
      fail("step " + std::to_string(report.step));
    const double speed = fastest(simulator);
    found["peak_speed"] = std::max(found["peak_speed"], speed);
    if (static_cast<double>(step) >= (1.0 - LAST_SHARE) * static_cast<double>(steps) - 1.0)
      found["max_speed"] = std::max(found["max_speed"], speed);
    found["max_penetration"] = std::max(found["max_penetration"], report.max_penetration);
    for (const ContactState& contact : simulator.contacts())
      found["max_force"] = std::max(found["max_force"], contact.impulse.norm() / report.dt);
    if (progress && step % 64 == 0)
      progress(static_cast<double>(step) / static_cast<double>(steps));
  }
  if (!std::isfinite(record.least_margin))  // nothing touched
    record.least_margin = 0.0;
  found["kinetic"] = simulator.report().energy.kinetic;
  found["friction"] = simulator.report().energy.friction;
  found["contacts"] = static_cast<double>(simulator.contacts().size());
  addBodies(simulator, start, found);
  return record;
}

void ThresholdOptions::validate() const
{
  const auto require = [](bool condition, const std::string& text)
  {
    if (!condition)
      throw std::invalid_argument(text);
  };
  require(std::isfinite(from) && std::isfinite(to) && from < to,
          "from is " + std::to_string(from) + " and to is " + std::to_string(to) + ", expected from < to");
  require(samples >= 2, "samples is " + std::to_string(samples) + ", expected at least 2");
  require(tolerance > 0.0 && tolerance < 1.0, "tolerance is " + std::to_string(tolerance) + ", expected in (0, 1)");
}

const HoldingInterval* ThresholdResult::widest() const
{
  const auto best = std::max_element(intervals.begin(), intervals.end(),
                                     [](const HoldingInterval& a, const HoldingInterval& b)
                                     { return a.to - a.from < b.to - b.from; });
  return best == intervals.end() ? nullptr : &*best;
}

ThresholdResult findThreshold(const ThresholdOptions& options, const std::function<bool(double)>& holds)
{
  options.validate();
  ThresholdResult result;
  const auto ask = [&](double value)
  {
    const bool answer = holds(value);
    result.runs.emplace_back(value, answer);
    return answer;
  };
  for (int k = 0; k < options.samples; ++k)
  {
    const double share = static_cast<double>(k) / (options.samples - 1);
    ask(k + 1 == options.samples ? options.to : options.from + share * (options.to - options.from));
  }
  const std::vector<std::pair<double, bool>> grid = result.runs;
  // Between two of the grid that differ: the pair of neighbours in the end.
  const double width = options.tolerance * (options.to - options.from);
  for (size_t k = 1; k < grid.size(); ++k)
  {
    double low = grid[k - 1].first, high = grid[k].first;
    if (grid[k - 1].second == grid[k].second)
      continue;
    while (high - low > width)
    {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high)
        break;
      (ask(middle) == grid[k - 1].second ? low : high) = middle;
    }
  }
  std::sort(result.runs.begin(), result.runs.end());
  int changes = 0;
  for (size_t k = 0; k < result.runs.size(); ++k)
  {
    const auto& [value, held] = result.runs[k];
    const bool before = k > 0 && result.runs[k - 1].second;
    changes += k > 0 && held != before;
    if (held && !before)
    {
      result.intervals.push_back({value, value, k == 0, true, 0.0, 0.0});
      if (k > 0)
        result.intervals.back().fails_below = result.runs[k - 1].first;
    }
    if (held)
      result.intervals.back().to = value;
    if (!held && before)
    {
      result.intervals.back().open_above = false;
      result.intervals.back().fails_above = value;
    }
  }
  result.monotone = changes <= 1;
  return result;
}

}  // namespace frictional_contact_sim
